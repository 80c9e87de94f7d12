"""Mesh files in every format give the same mesh, in metres with the axle along y, or an error."""

from __future__ import annotations

import numpy as np
import pytest
from small import case_with
from written import as_drawn, cdb_text, inp_text, msh_text, shuffled, write

from tyrefrf.case import SectionFile
from tyrefrf.errors import MeshError
from tyrefrf.mesh.reader import read_mesh
from tyrefrf.study.model import build_mesh

ROUND_OFF = 1e-15  # [m]
TEXTS = {"inp": inp_text, "msh": msh_text, "cdb": cdb_text}


@pytest.fixture(scope="module", params=["hex8i", "hex20"])
def section(request):
    return build_mesh(case_with(('"hex8i"', f'"{request.param}"'))).section


def source(file="s.inp", **more) -> SectionFile:
    table = {"file": file, "kind": "section", "unit": "mm", "rim": "RIM", "materials": {"A": "a"}}
    return SectionFile.model_validate(table | more)


@pytest.mark.parametrize("unit", ["m", "mm", "in"])
@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_points_are_in_metres_with_the_axle_along_y(tmp_path, section, unit, axis):
    drawn = shuffled(section, 1, unit, axis)
    path = write(tmp_path, "s.inp", inp_text(drawn))
    mesh = read_mesh(path, source(unit=unit, axis=axis))
    place = {number: i for i, number in enumerate(mesh.numbers.tolist())}
    points = mesh.points[[place[number] for number in drawn.numbers.tolist()]]
    assert np.hypot(points[:, 0], points[:, 2]) == pytest.approx(
        section.points[:, 0], abs=ROUND_OFF
    )
    assert points[:, 1] == pytest.approx(section.points[:, 1], abs=ROUND_OFF)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_axes_are_turned_and_not_mirrored(tmp_path, axis):
    units = np.eye(3) * 300.0
    nodes = "".join(f"{i + 1}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(units.tolist()))
    text = f"*NODE\n{nodes}4, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n"
    mesh = read_mesh(write(tmp_path, "s.inp", text), source(axis=axis))
    assert np.linalg.det(mesh.points[:3]) == pytest.approx(0.3**3)
    assert mesh.points["xyz".index(axis)] == pytest.approx([0.0, 0.3, 0.0])


@pytest.mark.parametrize("name", ["msh", "cdb"])
def test_other_formats_hold_the_same_mesh(tmp_path, section, name):
    drawn = shuffled(section, 2)
    inp = read_mesh(write(tmp_path, "s.inp", inp_text(drawn)), source())
    other = read_mesh(write(tmp_path, f"s.{name}", TEXTS[name](drawn)), source())
    places = [{n: i for i, n in enumerate(mesh.numbers.tolist())} for mesh in (inp, other)]
    order = [places[1][n] for n in inp.numbers.tolist()]
    assert other.points[order] == pytest.approx(inp.points, abs=ROUND_OFF)
    quads = [
        {tuple(mesh.numbers[row]) for b in mesh.elements if b.kind[:4] == "quad" for row in b.nodes}
        for mesh in (inp, other)
    ]
    assert quads[0] == quads[1]
    rims = [set(mesh.numbers[mesh.node_sets["RIM"]].tolist()) for mesh in (inp, other)]
    assert rims[0] == rims[1]


@pytest.mark.parametrize("binary", [False, True])
def test_older_gmsh_files_are_read_too(tmp_path, binary):
    meshlane = pytest.importorskip("meshlane")
    section = build_mesh(case_with()).section
    drawn = as_drawn(section)
    ends = np.array([[0, 1], section.rim[2:]])
    mesh = meshlane.Mesh(
        drawn.points,
        [("line", ends), ("quad", drawn.quads)],
        cell_data={
            "gmsh:physical": [np.array([7, 7]), np.full(len(drawn.quads), 7)],
            "gmsh:geometrical": [np.array([1, 2]), np.full(len(drawn.quads), 1)],
        },
        field_data={"RIM": np.array([7, 1])},
    )
    path = tmp_path / "s.msh"
    mesh.write(path, file_format="gmsh22", binary=binary)
    read = read_mesh(path, source())
    assert read.points[:, :2] == pytest.approx(section.points, abs=ROUND_OFF)
    assert set(read.node_sets["RIM"]) == set(section.rim)
    assert len(read.element_sets["7"]) == section.n_elements  # a group without a name


def test_gmsh_numbers_are_kept(tmp_path, section):
    drawn = shuffled(section, 3)
    mesh = read_mesh(write(tmp_path, "s.msh", msh_text(drawn)), source())
    assert mesh.numbers.tolist() == drawn.numbers[drawn.nodes_first].tolist()
    assert min(block.numbers.min() for block in mesh.elements) == 101


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8, 0.98])
@pytest.mark.parametrize("name", ["msh", "cdb"])
def test_a_truncated_file_is_refused(tmp_path, section, name, share):
    text = TEXTS[name](shuffled(section, 4))
    cut = text[: int(share * len(text))]
    if name == "cdb":  # its end is sets, which are looked for by their names
        cut = text[: int(share * text.index("CMBLOCK") * 0.98)]
    with pytest.raises(MeshError, match=rf"s\.{name}: "):
        read_mesh(write(tmp_path, f"s.{name}", cut), source())


def test_a_file_without_its_last_line_is_refused(tmp_path, section):
    text, _, _ = msh_text(shuffled(section, 4)).rpartition("$EndElements")
    with pytest.raises(MeshError, match=r"does not read all of it: .*not closed"):
        read_mesh(write(tmp_path, "s.msh", text), source())


@pytest.mark.parametrize("name", ["s.msh", "s.vtu", "s.med", "s.bdf", "s.cdb", "s.xyz", "s"])
def test_what_is_no_mesh_is_refused_without_an_exit(tmp_path, capfd, name):
    path = write(tmp_path, name, "this is no mesh\n")
    with pytest.raises(MeshError, match=str(path)):
        read_mesh(path, source())
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("unit", "words"),
    [
        ("m", r"largest radius is 278 m \(with mesh.unit = 'm'.*is the unit mm\?"),
        ("in", r"largest radius is 7.061 m .*is the unit mm\?"),
    ],
)
def test_millimetres_taken_for_something_else_are_noticed(tmp_path, unit, words):
    drawn = as_drawn(build_mesh(case_with()).section, "mm")
    with pytest.raises(MeshError, match=words):
        read_mesh(write(tmp_path, "s.inp", inp_text(drawn)), source(unit=unit))


def test_metres_taken_for_millimetres_are_noticed(tmp_path):
    drawn = as_drawn(build_mesh(case_with()).section, "m")
    with pytest.raises(MeshError, match=r"is 0.000278 m .*is the unit m\?"):
        read_mesh(write(tmp_path, "s.inp", inp_text(drawn)), source())


def test_no_file_and_a_directory_are_refused(tmp_path):
    with pytest.raises(MeshError, match="there is no such file"):
        read_mesh(tmp_path / "s.inp", source())
    with pytest.raises(MeshError, match="is no file"):
        read_mesh(tmp_path, source())
