"""Grooves in the tread: bricks are missing where the case says, and nowhere else.

A groove's walls are planes through the axle, w / R apart: bricks with straight sides between two
sections at an angle a enclose sin(a) times the integral of r over the section (their points are
r(xi) c(zeta) with c on the chord, and |c x c'| = sin a), which is the closed form for its volume.
"""

from __future__ import annotations

import numpy as np
import pytest

from tyrefrf.arrays import FloatArray
from tyrefrf.case import Belt, Cell, Geometry, Tread
from tyrefrf.case.geometry import Grooves
from tyrefrf.errors import CaseError
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.fem.quadrature import gauss
from tyrefrf.mesh.cell import CellMesh, revolve, revolve_between
from tyrefrf.mesh.grooves import cut_elements, groove_layers
from tyrefrf.mesh.profile import tyre_section
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.mesh.shapes import QUAD4, QUAD8, shape

R = 0.278  # outer radius [m]
EXACT = 1e-13  # rounding of sizes below one
SERENDIPITY = 2e-5  # volume: quadratic bricks follow a circle of 4 degrees to this

both = pytest.mark.parametrize("quadratic", [False, True], ids=["linear", "quadratic"])


def geometry(through: int = 2, **sizes: object) -> Geometry:
    """A coarse section with a belt and a grooved tread; sizes: of the grooves."""
    grooves = Grooves(**({"width": 0.010, "depth": 0.006} | sizes))
    tread = Tread(
        material="tread", elements_along=6, elements_through=through, edge_thickness=0.007,
        grooves=grooves,
    )  # fmt: skip
    belt = Belt(material="belt")
    return Geometry(
        material="rubber", elements_along=10, elements_through=2, tread=tread, belt=belt
    )


def cell(around: int = 6, sector_angle: float = 12.0) -> Cell:
    return Cell(sector_angle=sector_angle, elements_around=around)


def grooved(quadratic: bool, through: int = 2, of: Cell | None = None, **sizes: object) -> CellMesh:
    tyre = geometry(through, **sizes)
    layers = groove_layers(tyre.tread.grooves, R, of or cell())
    present = ~np.outer(layers.grooved, cut_elements(tyre))
    return revolve_between(tyre_section(tyre, quadratic), layers.theta, present)


def moments(section: SectionMesh) -> FloatArray:
    """Integrals (e,) of r over the quadrilaterals [m3], by Gauss's rule of 4 x 4 points."""
    xi, w = gauss(4, 2)
    N, dN = shape(QUAD4 if section.quads.shape[1] == 4 else QUAD8, xi)
    X = section.points[section.quads]
    r = np.einsum("ga,ea->eg", N, X[..., 0])
    return np.linalg.det(np.einsum("gak,eai->egki", dN, X)) * r @ w


def volumes(mesh: CellMesh) -> FloatArray:
    element = ELEMENTS["hex20" if mesh.bricks.shape[1] == 20 else "hex8i"]
    X = mesh.cartesian[mesh.bricks]
    return element.mass(X, 1.0)[:, 1::3, 1::3].sum(axis=(1, 2))


@pytest.mark.parametrize("through", [2, 3, 5])
def test_the_groove_is_as_wide_and_as_deep_as_the_case_says(through):
    mesh = grooved(quadratic=False, through=through)
    (empty,) = np.nonzero(~mesh.present.all(axis=1))
    walls = mesh.plane_angles[[empty[0], empty[-1] + 1]]
    assert np.diff(walls) * R == pytest.approx(0.010, abs=EXACT)
    assert walls.mean() == pytest.approx(np.deg2rad(6.0), abs=EXACT)
    floor = mesh.section.without(~mesh.present[empty[0]])
    outer = floor.points[floor.outer.ravel()]
    assert outer[np.argmin(abs(outer[:, 1])), 0] == pytest.approx(R - 0.006, abs=EXACT)


def test_the_volume_is_that_of_the_plain_tyre_without_its_grooves():
    mesh = grooved(quadratic=False)
    cut = moments(mesh.section)[cut_elements(geometry())].sum()
    angles = np.diff(mesh.plane_angles)
    whole = moments(mesh.section).sum() * np.sin(angles).sum()
    groove = cut * np.sin(0.010 / R / 2.0) * 2.0  # two layers of bricks across
    assert volumes(mesh).sum() == pytest.approx(whole - groove, rel=EXACT)
    assert groove / whole == pytest.approx(0.041, abs=0.001)


def test_quadratic_bricks_have_the_volume_of_pappus():
    mesh = grooved(quadratic=True)
    cut = moments(mesh.section)[cut_elements(geometry())].sum()
    whole = moments(mesh.section).sum() * np.deg2rad(12.0)
    assert volumes(mesh).sum() == pytest.approx(whole - cut * 0.010 / R, rel=SERENDIPITY)


@both
def test_without_missing_bricks_layers_of_equal_angle_are_the_plain_cell(quadratic):
    tyre = geometry()
    section = tyre_section(tyre, quadratic)
    plain = revolve(section, np.deg2rad(12.0), 6)
    planes = np.linspace(0.0, np.deg2rad(12.0), 7)
    filled = revolve_between(section, planes, np.ones((6, section.n_elements), dtype=bool))
    for name in ("bricks", "material", "planes", "rim", "inside", "quads"):
        assert np.array_equal(getattr(filled, name), getattr(plain, name)), name
    assert filled.points == pytest.approx(plain.points, abs=1e-15)


def test_a_width_of_a_third_of_the_pitch_makes_equal_layers():
    layers = groove_layers(Grooves(width=R * np.deg2rad(4.0), depth=0.006), R, cell())
    assert layers.theta == pytest.approx(np.deg2rad(np.arange(7) * 2.0), abs=EXACT)
    assert layers.grooved.tolist() == [False, False, True, True, False, False]


@both
@pytest.mark.parametrize("offset", [0.0, 6.0, 4.9])
def test_every_node_has_a_brick_and_both_sections_have_the_same(quadratic, offset):
    mesh = grooved(quadratic, offset=offset)
    assert np.array_equal(np.unique(mesh.bricks), np.arange(mesh.n_nodes))
    left, right = mesh.points[: mesh.n_face], mesh.points[-mesh.n_face :]
    assert np.array_equal(left[:, :2], right[:, :2])
    assert np.array_equal(left[:, :2], mesh.left.points)
    assert np.all(left[:, 2] == 0.0)
    assert np.all(right[:, 2] == mesh.sector_angle)
    assert volumes(mesh).min() > 0.0


@both
@pytest.mark.parametrize(("offset", "whole"), [(0.0, True), (6.0, False)])
def test_the_left_section_is_that_of_its_bricks(quadratic, offset, whole):
    mesh = grooved(quadratic, offset=offset)
    corners = mesh.bricks[mesh.left_bricks][:, :4]
    assert (mesh.left is mesh.section) == whole
    assert np.array_equal(corners, mesh.left.quads[:, :4])
    assert np.array_equal(mesh.material[mesh.left_bricks], mesh.left.material)


@both
def test_where_the_cut_meets_a_wall_the_left_section_is_a_block_s(quadratic):
    """The groove begins at the cut: the block's end belongs to the cell before."""
    mesh = grooved(quadratic, offset=6.0 + np.rad2deg(0.005 / R))
    assert mesh.left is mesh.section
    assert not mesh.present[0].all()
    there = mesh.bricks[mesh.left_bricks][:, 4:8] - mesh.n_own  # of the right section, for those
    cut = ~mesh.present[0]
    assert np.array_equal(there[cut], mesh.section.quads[cut, :4])


@both
def test_the_outline_of_a_section_is_found_without_its_grid(quadratic):
    section = tyre_section(geometry(), quadratic)
    again = section.without(np.zeros(section.n_elements, dtype=bool))
    assert np.array_equal(again.outer, section.outer)
    floor = section.without(cut_elements(geometry()))
    assert np.array_equal(floor.outer[1:, 0], floor.outer[:-1, 1])
    assert floor.points[floor.outer[[0, -1], [0, 1]], 1] == pytest.approx(
        section.points[section.outer[[0, -1], [0, 1]], 1], abs=EXACT
    )


@both
def test_a_rib_stays_whole_and_is_as_wide_as_the_case_says(quadratic):
    tyre = geometry(rib=0.030)
    section = tyre_section(tyre, quadratic)
    floor = section.without(cut_elements(tyre))
    top = floor.points[np.unique(floor.outer)]
    on_crown = abs(top[:, 0] - (R - 0.4 + np.sqrt(0.4**2 - top[:, 1] ** 2))) < 1e-6
    assert np.ptp(top[on_crown, 1]) == pytest.approx(0.030, abs=EXACT)


@pytest.mark.parametrize(("sides", "sign"), [("y<0", -1.0), ("y>0", 1.0)])
def test_grooves_on_one_side_leave_the_other_whole(sides, sign):
    tyre = geometry(sides=sides)
    section = tyre_section(tyre, quadratic=False)
    y = section.points[section.quads, 1].mean(axis=1)
    cut = cut_elements(tyre)
    assert np.array_equal(cut, cut_elements(geometry()) & (sign * y > 0.0))
    assert cut.any()


def test_several_grooves_share_the_cell_evenly():
    one = groove_layers(Grooves(width=0.01, depth=0.006), R, cell())
    two = groove_layers(Grooves(width=0.01, depth=0.006, number=2), R, cell(12, 24.0))
    expected = np.append(one.theta[:-1], one.theta + np.deg2rad(12.0))
    assert two.theta == pytest.approx(expected, abs=EXACT)
    assert two.grooved.tolist() == [*one.grooved, *one.grooved]


@pytest.mark.parametrize(
    ("around", "across"), [(2, 1), (3, 1), (4, 2), (5, 1), (6, 2), (8, 2), (12, 2), (24, 6)]
)
def test_the_groove_has_its_share_of_elements_and_the_block_an_even_rest(around, across):
    """The groove takes 0.24 of the pitch; one wall is on the cut, so that two layers do."""
    offset = 6.0 + np.rad2deg(0.007 / R)
    grooves = Grooves(width=0.014, depth=0.006, offset=offset)
    layers = groove_layers(grooves, R, cell(around))
    assert layers.grooved.sum() == across


@pytest.mark.parametrize(
    ("sizes", "of", "key", "message"),
    [
        ({"width": 0.06}, cell(), "geometry.tread.grooves.width", "must be below 0.0582242 m"),
        ({"width": 0.06, "number": 2}, cell(), "width", "each of its 2 parts in the cell"),
        ({}, cell(1), "cell.elements_around", "at least 3, one in every groove and one to"),
        ({}, cell(2), "cell.elements_around", "must be at least 3"),
        ({"number": 4}, cell(), "cell.elements_around", "nearest: 12"),
        ({"elements_across": 6}, cell(), "elements_across", "must be below 6"),
        ({"elements_across": 5}, cell(), "cell.elements_around", "must be at least 7"),
    ],
)
def test_grooves_that_do_not_fit_the_cell_are_refused(sizes, of, key, message):
    with pytest.raises(CaseError) as refused:
        grooved(False, of=of, **sizes)
    assert key in str(refused.value)
    assert message in str(refused.value)
