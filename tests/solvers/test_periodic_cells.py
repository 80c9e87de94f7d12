"""Tyres whose cell came from a file, solved.

The same tyre is described in several ways: revolved here or read back from a shuffled mesh; cut
through a groove or beside it; as one cell or as two in one. Displacements in (r, y, theta) are the
same node by node wherever the cell begins.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from outside import outside, read_back, ring_nodes, same_nodes
from rings import PAPER, UNDAMPED, Ring, omegas, skewed, tyre

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from tyrefrf.case import Geometry, Isotropic, Ply
from tyrefrf.case.geometry import Tread
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.mesh.cell import CellMesh, revolve
from tyrefrf.mesh.outside import Elements, OutsideMesh
from tyrefrf.mesh.profile import tyre_section
from tyrefrf.solvers import SOLVERS

ROUND_OFF = 1e-9
LINES = omegas(60.0, 900.0)
N_CELLS = 15

CORDS = Ply.model_validate(
    {
        "kind": "ply",
        "cord": {"E": 2e9, "nu": 0.3, "rho": 1400.0},
        "rubber": {"E": 20e6, "nu": 0.45, "rho": 1100.0, "eta": 0.1},
        "volume_fraction": 0.3,
        "angles": [25.0],
    }
)
LONG = pytest.param("hex20r", marks=pytest.mark.long)


def other_way(ply: Ply) -> Ply:
    return ply.model_copy(update={"angles": tuple(-angle for angle in ply.angles)})


def with_plies(ring: Ring, ply: Ply = CORDS) -> Ring:
    """The same tyre with cords in every brick under the tread but those on one side."""
    r, y = ring.mesh.points[ring.mesh.bricks, :2].mean(axis=1).T
    belt = (r > 0.24) & (y < 0.03)
    mesh = replace(ring.mesh, material=belt.astype(np.int64), materials=("rubber", "belt"))
    return replace(ring, mesh=mesh, materials={"rubber": PAPER, "belt": ply}, damping=UNDAMPED)


def solved(ring: Ring, nodes: IntArray, solver: str = "recursive") -> ComplexArray:
    """Fields (line, ring node, 3, load) of unit forces on nodes, along r, y, theta by turns."""
    places = [divmod(int(node), ring.mesh.n_own) for node in nodes]
    loads = ring.point_loads(*((*place, k % 3) for k, place in enumerate(places)))
    made = SOLVERS[solver](ring.problem(loads))
    return np.array([made.field(w).q.reshape(-1, 3, len(nodes)) for w in LINES])


def difference(q: ComplexArray, expected: ComplexArray) -> float:
    """Largest norm of a line's difference under a load, relative to that of the line."""
    norm = np.linalg.norm(expected, axis=(1, 2))
    return float((np.linalg.norm(q - expected, axis=(1, 2)) / norm).max())


def loaded_nodes(ring: Ring) -> IntArray:
    """Three ring nodes: on the crown, on a sidewall four cells on, the last free one of a cell."""
    nodes, n = ring_nodes(ring.mesh), ring.mesh.n_own
    side = 4 * n + int(np.argmin(nodes[: ring.mesh.n_face, 1]))
    last = 7 * n + int(np.setdiff1d(np.arange(n), ring.mesh.rim)[-1])
    return np.array([int(np.argmax(nodes[:n, 0])), side, last])


@pytest.mark.parametrize("names", [{}, {"left": "RIGHT", "right": "LEFT"}], ids=["found", "named"])
@pytest.mark.parametrize(("element", "around"), [("hex8i", 1), ("hex8i", 3), ("hex20r", 1)])
def test_a_tyre_read_back_is_the_same_tyre(element, around, names):
    """Angled cords lie as they did, though every brick was turned anyhow."""
    ring = with_plies(tyre(element, N_CELLS, 8, around))
    mesh = read_back(outside(ring.mesh, 1, angle=1.0), ring.mesh.sector_angle, **names)
    nodes = same_nodes(mesh, ring_nodes(ring.mesh), 1.0)
    at = loaded_nodes(ring)

    q = solved(replace(ring, mesh=mesh), nodes[at])[:, nodes]

    assert difference(q, solved(ring, at)) < ROUND_OFF


def flipped(mesh: OutsideMesh, flip: FloatArray) -> OutsideMesh:
    """A mesh in another frame; bricks keep their volume where the frame is mirrored, too."""
    (block,) = mesh.elements
    nodes = block.nodes
    if np.prod(flip) < 0.0:
        nodes = nodes[:, [3, 2, 1, 0, 7, 6, 5, 4]]
    block = Elements(block.kind, nodes, block.numbers)
    return replace(mesh, points=mesh.points * flip, elements=(block,))


HALF_TURN, MIRROR = np.array([1.0, -1.0, -1.0]), np.array([1.0, -1.0, 1.0])


def in_other_frame(flip: FloatArray, ply: Ply) -> float:
    """How a lopsided tyre with cords differs from itself read in a flipped frame."""
    ring = with_plies(skewed(tyre("hex8i", N_CELLS, 8, 2)))
    seen = replace(ring, materials={**ring.materials, "belt": ply})
    mesh = read_back(flipped(outside(ring.mesh, 2), flip), ring.mesh.sector_angle)
    places = ring_nodes(ring.mesh) * np.array([1.0, flip[1], flip[2]])
    nodes = same_nodes(mesh, places)
    at = loaded_nodes(ring)
    way = np.array([1.0, flip[1], flip[2]])  # of e_r, e_y, e_theta at every node

    q = solved(replace(seen, mesh=mesh), nodes[at])[:, nodes]
    q = q * way[:, None] * way[np.arange(3)]

    return difference(q, solved(ring, at))


def test_cords_keep_their_angle_in_any_right_handed_frame():
    assert in_other_frame(HALF_TURN, CORDS) < ROUND_OFF


def test_a_mirrored_frame_mirrors_the_cords():
    assert in_other_frame(MIRROR, other_way(CORDS)) < ROUND_OFF
    assert in_other_frame(MIRROR, CORDS) > 0.01


LAYERS = 4  # of bricks around in a cell; the groove takes the tread of two of them
SECTOR = 2.0 * np.pi / 16


def grooved(element: str, removed: list[int], layers: int = LAYERS) -> tuple[CellMesh, BoolArray]:
    """A cell with a tread, and which of its bricks remain when some layers are cut out of it."""
    geometry = Geometry(
        elements_along=6, tread=Tread(material="tread", elements_through=1), material="rubber"
    )
    section = tyre_section(geometry, element.startswith("hex20"))
    mesh = revolve(section, SECTOR * layers / LAYERS, layers)
    tread = mesh.material == mesh.materials.index("tread")
    gone = tread & (mesh.points[mesh.bricks, 1].mean(axis=1) > -0.02)
    layer = np.repeat(np.arange(layers), section.n_elements)
    return mesh, ~(gone & np.isin(layer, removed))


def grooved_ring(element: str, removed: list[int], shift: int = 0, layers: int = LAYERS) -> Ring:
    """The tyre of a grooved cell that begins `shift` layers on."""
    mesh, kept = grooved(element, removed, layers)
    written = outside(mesh, 3, shift * SECTOR / LAYERS, kept)
    stuff = {"rubber": PAPER, "tread": Isotropic(E=20e6, nu=0.45, rho=1100.0, eta=0.2)}
    cell = read_back(written, mesh.sector_angle)
    return Ring(cell, stuff, ELEMENTS[element], 16 * LAYERS // layers, UNDAMPED)


CUTS = {
    "through the groove": ([0, 3], 2, 4),
    "beside the groove": ([0, 1], 1, 4),
    "beside it on the other side": ([2, 3], 3, 4),
    "two cells in one": ([1, 2, 5, 6], 0, 8),
    "two in one, through the groove": ([0, 3, 4, 7], 2, 8),
}


@pytest.fixture(scope="module", params=["hex8i", LONG])
def uncut(request):
    """A tyre whose cell holds its groove, where it is loaded, and its field."""
    ring = grooved_ring(request.param, [1, 2])
    at = loaded_nodes(ring)
    return request.param, ring, at, solved(ring, at, "cyclic")


@pytest.mark.parametrize("cut", CUTS)
def test_a_grooved_tyre_does_not_depend_on_the_cut(uncut, cut):
    element, ring, at, expected = uncut
    other = grooved_ring(element, *CUTS[cut])
    nodes = same_nodes(other.mesh, ring_nodes(ring.mesh))

    q = solved(other, nodes[at], "cyclic")[:, nodes]

    assert len(nodes) == len(set(nodes)) == q.shape[1]
    assert difference(q, expected) < ROUND_OFF


def test_a_cell_may_be_cut_along_a_staircase(uncut):
    """Bricks at y > 0 are taken one layer on: the step's faces go along the ring, not across it."""
    element, ring, at, expected = uncut
    mesh, kept = grooved(element, [1, 2, 5, 6], 2 * LAYERS)
    layer = np.repeat(np.arange(2 * LAYERS), mesh.section.n_elements)
    first = np.where(mesh.points[mesh.bricks, 1].mean(axis=1) > 0.0, 1, 0)
    kept &= (first <= layer) & (layer < first + LAYERS)
    cell = read_back(outside(mesh, 4, kept=kept), SECTOR)
    assert np.ptp(cell.points[: cell.n_face, 2]) == pytest.approx(SECTOR / LAYERS)
    nodes = same_nodes(cell, ring_nodes(ring.mesh))

    q = solved(replace(ring, mesh=cell), nodes[at], "cyclic")[:, nodes]

    assert difference(q, expected) < ROUND_OFF


@pytest.mark.parametrize("solver", ["recursive", "direct"])
@pytest.mark.parametrize("cut", ["in the cell", "through the groove"])
def test_every_solver_takes_a_grooved_cell(uncut, cut, solver):
    element, ring, at, expected = uncut
    if cut in CUTS:
        ring = grooved_ring(element, *CUTS[cut])
        nodes = same_nodes(ring.mesh, ring_nodes(uncut[1].mesh))
        assert difference(solved(ring, nodes[at], solver)[:, nodes], expected) < ROUND_OFF
    else:
        assert difference(solved(ring, at, solver), expected) < ROUND_OFF


def test_the_groove_matters(uncut):
    element, ring, at, expected = uncut
    mesh, _ = grooved(element, [])
    smooth = replace(ring, mesh=read_back(outside(mesh, 3), mesh.sector_angle))
    nodes = same_nodes(smooth.mesh, ring_nodes(ring.mesh))
    assert difference(solved(smooth, nodes[at], "cyclic")[:, nodes], expected) > 0.01
