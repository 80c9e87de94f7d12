"""A case with a periodic cell from a file is the case with the tyre that the file was made of."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from outside import inp, number_of, outside

from tyrefrf.case import Case, load_case, parse_case
from tyrefrf.errors import CaseError
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.study.model import Model, build_model
from tyrefrf.study.run import run_case

ROUND_OFF = 1e-9
N_CELLS = 15
UNITS = {"m": 1.0, "mm": 1e-3, "in": 0.0254}
TURNED = 0.3  # [rad] of the file's frame about the axle: the cell begins there

STUFF = """
[materials.rubber]
E = "20 MPa"
nu = 0.45
rho = 1100.0
eta = 0.1
[materials.cords]
kind = "ply"
cord = { E = "2 GPa", nu = 0.3, rho = 1400.0 }
rubber = { E = "20 MPa", nu = 0.45, rho = 1100.0, eta = 0.1 }
volume_fraction = 0.3
angles = [ANGLE]
[inflation]
pressure = "0.5 bar"
[frequency]
values = [0.0, 60.0, 400.0]
"""
BUILT_IN = """
[geometry]
elements_along = 8
elements_through = 2
material = "rubber"
[geometry.belt]
material = "cords"
"""
FROM_FILE = """
[mesh]
kind = "cell"
file = "sector.inp"
unit = "UNIT"
axis = "AXIS"
rim = "RIM"
[mesh.materials]
rubber = "rubber"
cords = { material = "cords", angle = 25.0 }
"""


def cell_table(element: str, more: str = "") -> str:
    return f'[cell]\nsector_angle = 24.0\nelement = "{element}"\n{more}\n'


def places(*entries: tuple[str, str, float, str]) -> str:
    """Two loads by node, and a probe, each (table, place, angle in degrees, direction)."""
    return "\n".join(
        f'[[{table}]]\nname = "p{k}"\nkind = "node"\n{place}\nangle = {angle!r}\n'
        f'direction = "{direction}"'
        for k, (table, place, angle, direction) in enumerate(entries)
    )


def built_in(element: str, around: int, entries: str) -> Case:
    text = BUILT_IN + STUFF.replace("ANGLE", "25.0")
    text += cell_table(element, f"elements_around = {around}") + entries
    return parse_case(text, "built_in.toml", "built_in")


def from_file(folder: Path, cell: CellMesh, element: str, entries: str, **how: str) -> Case:
    """The case of a cell written as a deck, beside it."""
    unit, axis = how.get("unit", "mm"), how.get("axis", "z")
    mesh = outside(cell, 1, TURNED)
    (folder / "sector.inp").write_text(inp(mesh, UNITS[unit], axis))
    text = FROM_FILE.replace("UNIT", unit).replace("AXIS", axis)
    text += STUFF.replace("ANGLE", "70.0")  # not the set's own angle
    (folder / "cell.toml").write_text(text + cell_table(element) + entries)
    return load_case(folder / "cell.toml")


def file_number(cell: CellMesh, node: int) -> int:
    """The number in the deck of a cell's node: `outside` shuffles alike with one seed."""
    return number_of(outside(cell, 1, TURNED), cell, node, TURNED)


def on_cell(cell: CellMesh, entries: list[tuple[str, int, float, str]]) -> str:
    """Entries with a section's node and an angle as the deck numbers and turns them."""
    turned = np.rad2deg(TURNED)
    return places(
        *(
            (table, f"node = {file_number(cell, node)}", angle + float(turned), direction)
            for table, node, angle, direction in entries
        )
    )


ENTRIES = [("loads", 13, 0.0, "r"), ("loads", 19, 72.0, "theta"), ("probes", 7, 192.0, "y")]
PLAIN = places(*((t, f"node = {node}", angle, d) for t, node, angle, d in ENTRIES))
HUB = '\n[[probes]]\nname = "hub"\nkind = "hub"\n'


@pytest.mark.parametrize(
    ("element", "around", "unit", "axis"),
    [
        ("hex8i", 1, "mm", "z"),
        ("hex8i", 3, "m", "x"),
        ("hex8i", 3, "in", "y"),
        ("hex20r", 1, "mm", "x"),
    ],
)
def test_the_file_gives_the_same_responses(tmp_path, element, around, unit, axis):
    """Inflated, with cords at the set's own angle; forces on the rim turn with the frame."""
    case = built_in(element, around, PLAIN + HUB)
    cell = build_model(case).mesh
    entries = on_cell(cell, ENTRIES) + HUB

    found = run_case(from_file(tmp_path, cell, element, entries, unit=unit, axis=axis), jobs=1)

    expected = run_case(case, jobs=1)
    scale = np.linalg.norm(expected.receptance, axis=(0, 1))
    error = np.linalg.norm(found.receptance - expected.receptance, axis=(0, 1)) / scale
    assert error.max() < ROUND_OFF
    axial = abs(found.blocked_force[:, 1] - expected.blocked_force[:, 1]).max()
    assert axial < ROUND_OFF * abs(expected.blocked_force).max()
    assert [p.s for p in found.loads] == pytest.approx([p.s for p in expected.loads], nan_ok=True)


@pytest.fixture(scope="module")
def cell() -> CellMesh:
    return build_model(built_in("hex8i", 3, PLAIN)).mesh


def model_with(folder: Path, cell: CellMesh, entries: str) -> Model:
    return build_model(from_file(folder, cell, "hex8i", entries, unit="m", axis="y"))


@pytest.mark.parametrize("angle", [0.0, 13.0, 359.0])
@pytest.mark.parametrize("where", ["left", "inside", "right"])
def test_a_node_is_taken_in_the_cell_where_it_is_nearest_to_the_angle(tmp_path, cell, where, angle):
    node = {"left": 14, "inside": cell.n_face + 14, "right": cell.n_own + 14}[where]
    entry = ("loads", f"node = {file_number(cell, node)}", angle, "r")
    model = model_with(tmp_path, cell, places(entry))
    (place,) = model.loads
    assert place.surface == ("" if where == "inside" else "outer")
    assert (place.r, place.y) == pytest.approx(tuple(cell.points[node, :2]))
    off = (np.rad2deg(place.angle) - angle + 180.0) % 360.0 - 180.0
    assert abs(off) <= 12.0 + 1e-9
    own = (np.rad2deg(place.angle - TURNED - cell.points[node, 2])) % 24.0
    assert min(own, 24.0 - own) < 1e-9
    (row,) = model.problem.loads.indices
    at, number = divmod(row // 3, model.mesh.n_own)
    theta = model.mesh.points[number, 2] + at * model.mesh.sector_angle
    assert np.cos(theta - place.angle) == pytest.approx(1.0)


def test_s_is_the_nearest_node_of_the_left_section(tmp_path, cell):
    model = model_with(tmp_path, cell, places(("loads", "s = 0.52", 30.0, "r")))
    (place,) = model.loads
    assert (place.surface, place.s) == ("outer", pytest.approx(0.5))
    assert np.rad2deg(place.angle) == pytest.approx(np.rad2deg(TURNED) + 24.0)


@pytest.mark.parametrize("kind", ["patch", "point"])
def test_places_between_nodes_are_refused_with_the_node_nearby(tmp_path, cell, kind):
    entry = places(("loads", f"node = {file_number(cell, 13)}", 0.0, "r"))
    probe = f'\n[[probes]]\nname = "p"\nkind = "{kind}"\ns = 0.5\ndirection = "r"\n'
    with pytest.raises(CaseError, match="'p' is a place between nodes") as caught:
        model_with(tmp_path, cell, entry + probe)
    assert caught.value.problems[0].key == ("probes", 0, "s")
    (near,) = build_model(from_file(tmp_path, cell, "hex8i", entry, unit="m", axis="y")).loads
    crown = places(("loads", "s = 0.5", 0.0, "r"))
    assert near.r < model_with(tmp_path, cell, crown).loads[0].r


def test_an_unknown_node_is_refused(tmp_path, cell):
    with pytest.raises(CaseError, match=r"no brick has a node 77777; .* from 1") as caught:
        model_with(tmp_path, cell, places(("loads", "node = 77777", 0.0, "r")))
    assert caught.value.problems[0].key == ("loads", 0, "node")


def test_the_element_must_have_the_files_nodes(tmp_path, cell):
    entry = places(("loads", "s = 0.5", 0.0, "r"))
    case = from_file(tmp_path, cell, "hex20", entry)
    with pytest.raises(CaseError, match="use hex8i or hex8") as caught:
        build_model(case)
    assert caught.value.problems[0].key == ("cell", "element")


def test_sets_that_are_not_there_are_named(tmp_path, cell):
    entry = places(("loads", "s = 0.5", 0.0, "r"))
    from_file(tmp_path, cell, "hex8i", entry)
    text = (tmp_path / "cell.toml").read_text()
    (tmp_path / "cell.toml").write_text(text.replace('"RIM"', '"RIM"\nleft = "LEFTT"'))
    with pytest.raises(CaseError, match="did you mean 'LEFT'") as caught:
        build_model(load_case(tmp_path / "cell.toml"))
    assert caught.value.problems[0].key == ("mesh", "left")
