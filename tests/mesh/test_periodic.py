"""A cell written as another program would write it is read back as it was.

Nodes and elements are numbered anyhow, every brick begins at any corner and has its axes any way
that keeps it right-handed, the frame is turned, and one node has no brick.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from outside import bricks_of, outside, read_back, ring_nodes, same_nodes, sets_of
from rings import skewed, tyre

from tyrefrf.case import Geometry
from tyrefrf.case.geometry import Tread
from tyrefrf.fem.pressure import pressure_forces
from tyrefrf.mesh.brick_faces import BrickFaces
from tyrefrf.mesh.cell import CellMesh, revolve
from tyrefrf.mesh.free_surface import Surface
from tyrefrf.mesh.periodic import periodic_cell
from tyrefrf.mesh.profile import tyre_section
from tyrefrf.mesh.turning import turned_bricks

N_CELLS = 20
SECTOR = 2.0 * np.pi / N_CELLS
ANGLE = 3.0  # [rad] of the file's frame: the cell straddles half a turn
EXACT = 1e-12

kinds = pytest.mark.parametrize(
    ("element", "around"), [("hex8i", 1), ("hex8i", 3), ("hex20", 1), ("hex20", 2)]
)
named = pytest.mark.parametrize(
    "names",
    [{}, {"left": "LEFT", "right": "RIGHT", "inner": "INNER"}, {"left": "RIGHT", "right": "LEFT"}],
    ids=["found", "named", "swapped"],
)


def written(element: str, around: int) -> CellMesh:
    return tyre(element, N_CELLS, 8, around).mesh


def layered(element: str = "hex8i", around: int = 4) -> CellMesh:
    """A cell with a tread of two elements upon a body of two."""
    geometry = Geometry(
        elements_along=12, elements_through=2, tread=Tread(material="rubber"), material="rubber"
    )
    return revolve(tyre_section(geometry, element.startswith("hex20")), SECTOR, around)


def on_tread(mesh: CellMesh, layers: list[int], around: int = 4) -> np.ndarray:
    """The outermost bricks (e,) about mid-tread in some layers of bricks."""
    section = mesh.section
    outer = {frozenset(edge) for edge in section.outer[:, :2].tolist()}
    top = [frozenset((q[1], q[2])) in outer for q in section.quads.tolist()]
    top &= abs(section.points[section.quads[:, :4], 1].mean(axis=1)) < 0.03
    return np.tile(top, around) & np.isin(np.repeat(np.arange(around), section.n_elements), layers)


def places(mesh: CellMesh, angle: float = 0.0) -> np.ndarray:
    """x, y, z (n, 3) of the cell's nodes, in a frame turned by an angle."""
    return replace(mesh, points=mesh.points + np.array([0.0, 0.0, angle])).cartesian


def node_map(mesh: CellMesh, back: CellMesh) -> np.ndarray:
    """The node read back for every node that was written."""
    distance = np.linalg.norm(places(back)[None] - places(mesh, ANGLE)[:, None], axis=2)
    assert np.max(distance.min(axis=1)) < EXACT
    return np.argmin(distance, axis=1)


def ordered(rows: np.ndarray) -> np.ndarray:
    return rows[np.lexsort(rows.T)]


@named
@kinds
def test_nodes_and_bricks_are_those_written(element, around, names):
    """Every brick has the axes again that it had before it was turned."""
    mesh = written(element, around)
    back = read_back(outside(mesh, 1, ANGLE), SECTOR, **names)
    there = node_map(mesh, back)
    assert back.n_nodes == mesh.n_nodes
    assert np.array_equal(ordered(there[mesh.bricks]), ordered(back.bricks))
    assert set(there[mesh.rim]) == set(back.rim)
    assert np.ptp(back.points[:, 2]) == pytest.approx(SECTOR)


@named
@kinds
def test_sections_are_partners_and_come_first_and_last(element, around, names):
    mesh = written(element, around)
    back = read_back(outside(mesh, 2, ANGLE), SECTOR, **names)
    left, right = back.points[: back.n_face], back.points[back.n_own :]
    np.testing.assert_array_equal(right - left, np.tile([0.0, 0.0, SECTOR], (back.n_face, 1)))
    there = node_map(mesh, back)
    assert set(there[: mesh.n_face]) == set(range(back.n_face))
    assert np.array_equal(back.planes[0], np.arange(back.n_face))
    assert np.array_equal(back.planes[1], np.arange(back.n_own, back.n_nodes))


@named
@kinds
def test_section_has_its_surfaces_from_rim_to_rim(element, around, names):
    section = written(element, around).section
    back = read_back(outside(written(element, around), 3, ANGLE), SECTOR, **names).section
    for name in ("outer", "inner"):
        ours, theirs = back.points[getattr(back, name)], section.points[getattr(section, name)]
        np.testing.assert_allclose(ours, theirs, atol=EXACT)
    quads, theirs = back.points[back.quads], section.points[section.quads]
    np.testing.assert_allclose(
        ordered(quads.reshape(len(quads), -1).round(9)),
        ordered(theirs.reshape(len(quads), -1).round(9)),
        atol=EXACT,
    )


def test_section_elements_are_the_first_bricks():
    back = read_back(outside(layered(), 4, ANGLE), SECTOR)
    first = back.bricks[: back.section.n_elements, :4]
    assert np.array_equal(first, back.section.quads)


def pressed(mesh: CellMesh, angle: float) -> np.ndarray:
    """Nodal forces (n, 3) of unit pressure, in x, y, z of a frame turned by an angle."""
    forces = np.zeros((mesh.n_nodes, 3))
    of_faces = pressure_forces(places(mesh, angle)[mesh.inside])
    np.add.at(forces, mesh.inside, of_faces.reshape(*mesh.inside.shape, 3))
    return forces


@named
@kinds
def test_pressure_acts_on_the_same_faces_the_same_way(element, around, names):
    mesh = written(element, around)
    back = read_back(outside(mesh, 5, ANGLE), SECTOR, **names)
    expected = pressed(mesh, ANGLE)
    error = abs(pressed(back, 0.0)[node_map(mesh, back)] - expected).max()
    assert error < EXACT * abs(expected).max()


def by_elements(mesh, back: CellMesh, element_face: int = 0) -> Surface:
    """The inner surface by the elements that have it: all their free faces, or one."""
    inner = set(back.numbers[back.inside[:, :4].ravel()])
    (block,) = mesh.elements
    at = np.isin(mesh.numbers[block.nodes[:, :8]], list(inner)).sum(axis=1) == 4
    return Surface(np.stack([block.numbers[at], np.full(at.sum(), element_face)], axis=1), "INNER")


def test_inner_surface_may_be_named_by_elements():
    mesh = outside(layered(), 6, ANGLE)
    back = read_back(mesh, SECTOR)
    sets = replace(sets_of(mesh), inner=by_elements(mesh, back))
    again = periodic_cell(mesh, bricks_of(mesh), sets, SECTOR)
    assert np.array_equal(ordered(np.sort(again.inside)), ordered(np.sort(back.inside)))


@pytest.mark.parametrize("element", ["hex8i", "hex20"])
@pytest.mark.parametrize("sets", [{}, {"left": "LEFT"}, {"right": "LEFT"}], ids=str)
def test_faces_need_be_no_planes(element, sets):
    """The left section's nodes stand at random angles, and the right one's alike."""
    mesh = skewed(tyre(element, N_CELLS, 8, 2)).mesh
    back = read_back(outside(mesh, 7, ANGLE), SECTOR, **sets)
    assert back.n_face == mesh.n_face
    assert np.ptp(back.points[: back.n_face, 2]) > 0.01
    assert len(node_map(mesh, back)) == mesh.n_nodes


@pytest.mark.parametrize(
    "removed", [[1, 2], [0, 3], [0, 1]], ids=["inside", "through the cut", "beside the cut"]
)
def test_a_groove_is_no_part_of_the_faces(removed):
    """Bricks of the tread are missing; where the groove lies on the cut, its walls stay free."""
    mesh = layered()
    kept = ~on_tread(mesh, removed)
    back = read_back(outside(mesh, 8, ANGLE, kept), SECTOR)
    assert len(back.bricks) == kept.sum()
    n_cut = mesh.section.n_elements - (0 in removed) * on_tread(mesh, [0]).sum()
    assert back.section.n_elements == n_cut
    assert len(same_nodes(back, ring_nodes(back))) == len(ring_nodes(back))
    assert len(back.inside) == 4 * len(mesh.section.inner)


def test_a_section_cut_along_a_staircase_shows_each_element_once():
    """The step's own faces, edge on in (r, y), are on the section but none of its elements."""
    mesh = revolve(layered().section, 2.0 * SECTOR, 8)
    layer = np.repeat(np.arange(8), mesh.section.n_elements)
    first = np.where(mesh.points[mesh.bricks, 1].mean(axis=1) > 0.0, 1, 0)
    back = read_back(outside(mesh, 9, kept=(first <= layer) & (layer < first + 4)), SECTOR)
    section = back.section
    assert section.n_elements == mesh.section.n_elements
    assert section.n_nodes == mesh.section.n_nodes + 5  # the crown's five stand on both steps
    assert np.array_equal(back.bricks[: section.n_elements, :4], section.quads)
    for edges in (section.outer, section.inner):
        length = np.linalg.norm(np.diff(section.points[edges], axis=1), axis=2)
        assert (length == 0.0).sum() == 1
        assert set(section.rim) >= {edges[0, 0], edges[-1, 1]}


def test_bricks_that_no_column_reaches_lie_as_their_neighbours():
    """Across a slit under the tread the way outwards is told from the sides."""
    mesh = layered()
    slit = np.zeros(len(mesh.bricks), dtype=bool)
    slit[np.flatnonzero(on_tread(mesh, [1, 2])) - 1] = True  # the lower of the tread's two rows
    back = read_back(
        outside(mesh, 9, ANGLE, ~slit), SECTOR, left="LEFT", right="RIGHT", inner="INNER"
    )
    there = node_map(mesh, back) if back.n_nodes == mesh.n_nodes else None
    used = np.unique(mesh.bricks[~slit])
    assert there is not None or back.n_nodes == len(used)
    X = places(mesh, ANGLE)[mesh.bricks[~slit]].reshape((~slit).sum(), -1)
    Y = places(back)[back.bricks].reshape((~slit).sum(), -1)
    np.testing.assert_allclose(ordered(Y.round(9)), ordered(X.round(9)), atol=EXACT)


def test_the_rim_may_be_a_line_of_nodes_at_each_bead():
    """No face is on the rim then, and only the edges that are divide the surface."""
    cell = layered()
    toes = cell.planes[:, cell.section.inner[[0, -1], [0, 1]]]
    mesh = outside(replace(cell, rim=toes.ravel()), 6, ANGLE)
    back, full = read_back(mesh, SECTOR), read_back(outside(cell, 6, ANGLE), SECTOR)
    assert len(back.rim) < len(full.rim)
    assert np.array_equal(ordered(np.sort(back.inside)), ordered(np.sort(full.inside)))


def test_one_row_of_known_bricks_turns_all_others():
    """Neighbours stand upon each other, inwards and outwards, or beside each other."""
    cell = layered()
    mesh = outside(cell, 11)
    bricks = bricks_of(mesh)
    faces = BrickFaces.of(bricks.nodes, bricks.numbers, "")
    X = mesh.points[bricks.nodes].mean(axis=1)
    crown = (abs(X[:, 1]) < 0.02) & (abs(np.hypot(X[:, 0], X[:, 2]) - 0.27) < 0.003)
    assert 4 <= crown.sum() < len(crown) / 6
    through = crown[:, None] * np.array([1.0, 0.0])
    turned = turned_bricks(bricks.nodes, mesh.points, faces, np.empty(0, np.int64), through)
    rows = mesh.points[turned].reshape(len(turned), -1)
    expected = cell.cartesian[cell.bricks].reshape(len(turned), -1)
    np.testing.assert_allclose(ordered(rows.round(9)), ordered(expected.round(9)), atol=EXACT)


def test_coordinates_of_seven_digits_match():
    mesh = outside(written("hex20", 2), 10, ANGLE)
    printed = np.array([float(f"{x:.7g}") for x in 1e3 * mesh.points.ravel()]) / 1e3  # in mm
    mesh = replace(mesh, points=printed.reshape(-1, 3))
    back = read_back(mesh, SECTOR)
    right = places(back)[back.n_own :]
    moved = right - mesh.points[np.argsort(mesh.numbers)][back.numbers[back.n_own :] - 1001]
    assert 1e-9 < abs(moved).max() < 1e-6
    assert back.n_face == written("hex20", 2).n_face
