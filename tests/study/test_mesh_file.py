"""The built-in tyre written to a mesh file and read back is the same tyre.

Its section is written as Abaqus, Gmsh and Ansys would write it, shuffled, in other units and along
other axes: the same matrices, node by node, and the same responses.
"""

from __future__ import annotations

import pickle
import sys

import numpy as np
import pytest
from small import TEXT, case_with
from written import as_drawn, cdb_text, inp_text, msh_text, shuffled, write

from tyrefrf.case import Case, SectionFile, case_hash, load_case, make_grid
from tyrefrf.errors import CaseError
from tyrefrf.fem.assembly import CellAssembly
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.mesh.cell import revolve
from tyrefrf.mesh.outside_section import outside_section
from tyrefrf.mesh.reader import read_mesh
from tyrefrf.study.certify import plan_certificate
from tyrefrf.study.estimate import estimate
from tyrefrf.study.model import build_mesh, build_model
from tyrefrf.study.run import run_case

SAME = 1e-9  # of the largest response: a solve whose condition is some 1e6, in another order
ROUND_OFF = 1e-12  # of the largest entry
GEOMETRY = '[geometry]\nelements_along = 8\nmaterial = "rubber"\n'
LAYERS = """\
[geometry]
elements_along = 16
elements_through = 3
material = "carcass"
tread = { material = "rubber" }
belt = { material = "belt" }
bead = { material = "core" }
[materials.carcass]
kind = "ply"
cord = { E = "3 GPa", nu = 0.3, rho = 1100.0 }
rubber = { E = "10 MPa", nu = 0.48, rho = 1100.0, eta = 0.1 }
volume_fraction = 0.3
angles = [80.0]
[materials.belt]
kind = "transverse"
E_1 = "20 GPa"
E_2 = "30 MPa"
nu_12 = 0.4
nu_23 = 0.5
G_12 = "8 MPa"
rho = 2000.0
angle = 22.0
[materials.core]
E = "200 GPa"
nu = 0.3
rho = 7850.0
"""


def mesh_text(element="hex8i", file="section.inp", unit="mm", axis="y", more="") -> str:
    """The small tyre's case with its section from a file."""
    table = f'[mesh]\nfile = "{file}"\nkind = "section"\nunit = "{unit}"\naxis = "{axis}"\n'
    table += f'rim = "RIM"\n{more}[mesh.materials]\nRUBBER = "rubber"\n'
    return TEXT.replace(GEOMETRY, table).replace('"hex8i"', f'"{element}"')


def mesh_case(folder, text, mesh, file="section.inp") -> Case:
    write(folder, file, mesh)
    return load_case(write(folder, "mesh.toml", text))


def small_section(element="hex8i"):
    return build_mesh(case_with(('"hex8i"', f'"{element}"'))).section


@pytest.mark.parametrize(
    ("file", "written", "unit", "axis", "element"),
    [
        ("section.inp", inp_text, "mm", "y", "hex8i"),
        ("section.inp", inp_text, "in", "x", "hex20r"),
        ("section.inp", inp_text, "m", "z", "hex8"),
        ("section.msh", msh_text, "mm", "x", "hex8i"),
        ("section.msh", msh_text, "mm", "y", "hex20"),
    ],
)
def test_the_same_tyre_from_a_file_has_the_same_responses(
    tmp_path, file, written, unit, axis, element
):
    text = mesh_text(element, file, unit, axis, 'inner = "LINER"\n')
    drawn = shuffled(small_section(element), 1, unit, axis)
    outside = run_case(mesh_case(tmp_path, text, written(drawn), file), jobs=1)
    built_in = run_case(case_with(('"hex8i"', f'"{element}"')), jobs=1)
    for name in ("receptance", "blocked_force"):
        expected = getattr(built_in, name)
        assert np.abs(getattr(outside, name) - expected).max() < SAME * np.abs(expected).max()


@pytest.mark.parametrize(("element", "kind"), [("hex8i", "linear"), ("hex20r", "nonlinear")])
def test_the_same_inflated_tyre_from_a_file(tmp_path, element, kind):
    pressure = f'[inflation]\npressure = "1 bar"\nkind = "{kind}"\n[frequency]'
    text = mesh_text(element).replace("[frequency]", pressure)
    outside = run_case(mesh_case(tmp_path, text, inp_text(shuffled(small_section(element), 2))))
    built_in = run_case(case_with(('"hex8i"', f'"{element}"'), ("[frequency]", pressure)), jobs=1)
    expected = built_in.receptance
    assert np.abs(outside.receptance - expected).max() < SAME * np.abs(expected).max()
    assert outside.inflation.resultant == pytest.approx(built_in.inflation.resultant, rel=1e-10)


def layered_case(element: str) -> Case:
    return case_with((GEOMETRY, LAYERS), ('"hex8i"', f'"{element}"'))


def matrices(section, case, materials):
    """K of every material and M of a cell, (n, n) each."""
    mesh = revolve(section, np.deg2rad(case.cell.sector_angle), 1)
    cell = CellAssembly(mesh, ELEMENTS[case.cell.element]).cell(materials, case.damping)
    return mesh, {**{name: cell.sparse(K) for name, K in cell.K.items()}, "M": cell.sparse(cell.M)}


def in_the_order_of(section, mesh, numbers):
    """Dofs of a cell read from a file, in the order of the built-in cell's nodes."""
    place = np.argsort(mesh.section.numbers)[np.argsort(np.argsort(numbers))]
    built_in = revolve(section, mesh.sector_angle, 1)
    node = np.empty(mesh.n_nodes, dtype=np.int64)
    there = built_in.planes >= 0
    node[built_in.planes[there]] = mesh.planes[:, place][there]
    return (3 * node[:, None] + np.arange(3)).ravel()


@pytest.mark.parametrize("axis", ["x", "y", "z"])
@pytest.mark.parametrize("element", ["hex8i", "hex20r"])
def test_layers_and_cords_lie_as_they_did_before_the_file(tmp_path, element, axis):
    case = layered_case(element)
    section = build_mesh(case).section
    drawn = shuffled(section, 3, "mm", axis)
    source = SectionFile(
        file="s.inp",
        kind="section",
        unit="mm",
        axis=axis,
        rim="RIM",
        inner="LINER",
        materials={name.upper(): name for name in section.materials},
    )
    outside = read_mesh(write(tmp_path, "s.inp", inp_text(drawn)), source)
    read = outside_section(outside, source, ["carcass", "belt"])
    _, expected = matrices(section, case, case.materials)
    mesh, found = matrices(read, case, case.materials)
    order = in_the_order_of(section, mesh, drawn.numbers)
    for name, K in expected.items():
        difference = abs(found[name][order][:, order] - K).max()
        assert difference < ROUND_OFF * abs(K).max(), name


def test_an_angle_of_a_set_is_that_of_a_material(tmp_path):
    section = build_mesh(layered_case("hex8i")).section
    sets = ", ".join(f'{name.upper()} = "{name}"' for name in section.materials if name != "belt")
    laid = f"materials = {{ {sets}, BELT = {{ material = 'belt', angle = 22.0 }} }}\n"
    head = '[mesh]\nfile = "section.inp"\nkind = "section"\nunit = "mm"\nrim = "RIM"\n'
    materials = LAYERS[LAYERS.index("[materials.carcass]") :]
    text = TEXT.replace(GEOMETRY, head + laid + materials)
    case = mesh_case(
        tmp_path, text.replace("angle = 22.0\n", "angle = -50.0\n"), inp_text(shuffled(section, 4))
    )
    assert case.laid_materials["belt at 22 deg"].angle == 22.0
    swept = make_grid(case, {"angle_BELT": (22.0, "30 deg")}).cases
    assert [grid.mesh.regions["BELT"].angle for grid in swept] == [22.0, 30.0]
    expected = run_case(layered_case("hex8i"), jobs=1).receptance
    found = run_case(case, jobs=1).receptance
    assert np.abs(found - expected).max() < SAME * np.abs(expected).max()


def test_ansys_materials_and_components_are_sets(tmp_path):
    section = small_section("hex20")
    text = mesh_text("hex20", "section.cdb").replace("RUBBER =", '"MAT 1" =')
    drawn = shuffled(section, 5)
    case = mesh_case(tmp_path, text, cdb_text(drawn), "section.cdb")
    read = build_mesh(case).section
    assert sorted(read.numbers) == sorted(drawn.numbers)
    ours = np.array([int(np.flatnonzero(read.numbers == n)[0]) for n in drawn.numbers])
    assert read.points[ours] == pytest.approx(section.points, abs=1e-15)
    assert set(read.rim) == set(ours[section.rim])


def test_a_node_is_the_one_that_the_file_numbers_so(tmp_path):
    drawn = shuffled(small_section(), 6)
    number = int(drawn.numbers[4])
    text = mesh_text().replace("s = 0.5", f"node = {number}")
    model = build_model(mesh_case(tmp_path, text, inp_text(drawn)))
    r, y = drawn.section.points[4]
    assert (model.loads[0].r, model.loads[0].y) == pytest.approx((r, y), abs=1e-15)
    lost = mesh_text().replace("s = 0.5", f"node = {number + 1}")
    with pytest.raises(CaseError, match=rf"node {number + 1} is not in the section"):
        build_model(mesh_case(tmp_path, lost, inp_text(drawn)))


def test_the_content_of_the_file_counts_not_its_place(tmp_path):
    text, mesh = mesh_text(), inp_text(as_drawn(small_section()))
    folders = [tmp_path / name for name in ("a", "b", "c")]
    for folder in folders:
        folder.mkdir()
    a, b = (mesh_case(folder, text, mesh) for folder in folders[:2])
    changed = mesh_case(folders[2], text, mesh + "** more\n")
    assert case_hash(a) == case_hash(b) != case_hash(changed)


def test_the_content_of_included_files_counts(tmp_path):
    head, _, rest = inp_text(as_drawn(small_section())).partition("*Element")
    nodes = write(tmp_path, "nodes.txt", head)
    case = mesh_case(tmp_path, mesh_text(), f"*INCLUDE, INPUT=nodes.txt\n*Element{rest}")
    whole, before = build_mesh(case), case_hash(case)
    assert whole.n_face == small_section().n_nodes
    nodes.write_text(head.replace("\n", "\n** more\n", 1))
    assert case_hash(case) != before
    nodes.unlink()
    with pytest.raises(CaseError, match=r"mesh.file: .*nodes.txt cannot be read"):
        build_model(case)


def test_the_files_place_goes_along(tmp_path):
    case = mesh_case(tmp_path, mesh_text(), inp_text(as_drawn(small_section())))
    swept = make_grid(case, {"E_rubber": (50e6, 60e6)}).cases[1]
    for other in (pickle.loads(pickle.dumps(case)), case.model_copy(), swept):
        assert other.directory == tmp_path
        assert build_mesh(other).n_nodes == build_mesh(case).n_nodes
    refined = plan_certificate(case, run_case(case, jobs=1)).refined
    assert refined.problem.n_cells == 2 * case.cell.n_cells


def test_sizes_of_a_file_cannot_be_swept(tmp_path):
    case = mesh_case(tmp_path, mesh_text(), inp_text(as_drawn(small_section())))
    with pytest.raises(CaseError, match=r"'crown' in this case: its section has no \[geometry\]"):
        make_grid(case, {"crown": (0.01, 0.02)})


@pytest.mark.parametrize(
    ("element", "fit"), [("hex20", "hex8i or hex8"), ("hex8", "hex20 or hex20r")]
)
def test_the_element_has_to_fit_the_file(tmp_path, element, fit):
    other = {"hex20": "hex8i", "hex8": "hex20"}[element]
    case = mesh_case(tmp_path, mesh_text(element), inp_text(as_drawn(small_section(other))))
    with pytest.raises(CaseError, match=rf"cell.element: {element} does not fit .* use {fit}"):
        build_model(case)


def test_a_file_that_is_not_there_is_said_at_the_key(tmp_path):
    case = load_case(write(tmp_path, "mesh.toml", mesh_text()))
    with pytest.raises(CaseError, match=r"mesh.file: .*section.inp cannot be read: No such file"):
        build_model(case)


def test_a_check_tells_what_was_read(tmp_path):
    case = mesh_case(tmp_path, mesh_text(), inp_text(as_drawn(small_section())))
    assert estimate(case, 1).mesh_file == (
        "section.inp: 18 nodes, 8 quad; r 168 to 278 mm, y -83.47 to 83.47 mm",
        "sets of elements: EALL 8, RUBBER 8 (rubber)",
        "sets of nodes: RIM 4",
        "surfaces: LINER 8",
    )


def test_waves_are_meshed_as_finely_as_in_the_built_in_tyre(tmp_path):
    case = mesh_case(tmp_path, mesh_text(), inp_text(shuffled(small_section(), 7)))
    (found,) = estimate(case, 1).resolution
    (expected,) = estimate(case_with(), 1).resolution
    for name in ("shear", "bending", "thickness", "size"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-9)


def test_without_the_library_the_message_says_what_brings_it(tmp_path, monkeypatch):
    for module, file, extra in (
        ("meshlane", "section.msh", "mesh"),
        ("mapdl_archive", "section.cdb", "ansys"),
    ):
        monkeypatch.setitem(sys.modules, module, None)
        case = mesh_case(tmp_path, mesh_text(file=file), "", file)
        with pytest.raises(CaseError, match=rf'pip install "tyrefrf\[{extra}\]"'):
            build_model(case)
