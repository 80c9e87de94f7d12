"""The built-in tyre's section has the sizes that the case gives, and the paper's counts.

The paper's homogeneous tyre (section 3.2) has 28 elements and 58 nodes in a section; its outer and
inner radii are 0.278 and 0.168 m. What is a size in the case must be found again on the mesh: at
the crown and the rim at any number of elements, for nodes stand there; at the widest place and the
tread's edge within what stations, even in arc length, miss.
"""

from __future__ import annotations

import numpy as np
import pytest

from tyrefrf.arrays import FloatArray
from tyrefrf.case.geometry import Geometry, Thickness
from tyrefrf.errors import MeshError
from tyrefrf.mesh.profile import tyre_section
from tyrefrf.mesh.section import SectionMesh

EXACT = 1e-15  # [m], a rounding of sizes below one
MISSED = 1e-4  # of the section width, by 28 elements: (length/2)^2 / (8 bend), bend about 30 mm
FINE = 2000  # elements, 0.2 mm long: as many as a case may ask for
FINE_MISSED = 2e-5  # [m] at such a mesh, along a side that leans a fifth

both = pytest.mark.parametrize("quadratic", [False, True], ids=["four nodes", "eight nodes"])


def section(quadratic: bool = False, **sizes: object) -> SectionMesh:
    return tyre_section(Geometry(material="rubber", **sizes), quadratic)


def lines(n_along: int) -> tuple[FloatArray, FloatArray]:
    """Inner and outer surface (n_along + 1, 2) of a section with one element through."""
    grid = section(elements_along=n_along).points.reshape(-1, 2, 2)
    return grid[:, 0], grid[:, 1]


def areas(mesh: SectionMesh) -> FloatArray:
    """Signed areas of the quadrilaterals between corners, positive if counter-clockwise."""
    r, y = np.moveaxis(mesh.points[mesh.quads[:, :4]], 2, 0)
    return 0.5 * np.sum(r * np.roll(y, -1, axis=1) - y * np.roll(r, -1, axis=1), axis=1)


def test_the_papers_section_has_58_nodes_and_28_elements():
    mesh = section()
    assert (mesh.n_nodes, mesh.n_elements) == (58, 28)


def test_its_quadratic_section_has_143_nodes():
    mesh = section(quadratic=True)
    assert (mesh.n_nodes, mesh.n_elements) == (29 * 3 + 28 * 2, 28)


def test_elements_through_the_thickness():
    mesh = section(elements_through=3, elements_along=10)
    assert (mesh.n_nodes, mesh.n_elements) == (11 * 4, 30)


@both
def test_radii_are_the_given_ones(quadratic):
    r = section(quadratic).points[:, 0]
    assert r.max() == pytest.approx(0.278, abs=EXACT)
    assert r.min() == pytest.approx(0.168, abs=EXACT)


@both
def test_outer_radius_is_at_the_crown(quadratic):
    mesh = section(quadratic)
    r, y = mesh.points[np.argmax(mesh.points[:, 0])]
    assert (r, y) == (pytest.approx(0.278, abs=EXACT), 0.0)


@both
def test_rim_width_and_bead_are_the_given_ones(quadratic):
    mesh = section(quadratic)
    rim = mesh.points[mesh.rim]
    assert np.ptp(rim[:, 1]) == pytest.approx(0.127, abs=EXACT)
    assert rim[:, 0] == pytest.approx(0.168, abs=EXACT)
    assert np.ptp(rim[rim[:, 1] < 0.0, 1]) == pytest.approx(0.012, abs=EXACT)


@both
def test_section_width_is_the_given_one_as_far_as_nodes_stand_there(quadratic):
    assert np.ptp(section(quadratic).points[:, 1]) == pytest.approx(0.170, rel=3 * MISSED)


def test_section_width_converges_to_the_given_one():
    # The thickening sidewall bulges past the widest radius by another 0.7 um on either side.
    _, outer = lines(FINE)
    assert np.ptp(outer[:, 1]) == pytest.approx(0.170, abs=2e-6)
    assert np.ptp(outer[:, 1]) > 0.170


def test_section_is_as_wide_as_given_at_the_widest_radius():
    _, outer = lines(FINE)
    half = outer[: FINE // 2]
    y = np.interp(0.225, half[:, 0], half[:, 1])
    assert -2.0 * y == pytest.approx(0.170, abs=1e-7)


@pytest.mark.parametrize(
    ("region", "coordinate", "place", "expected"),
    [
        ("bead", 0, 0.168, 0.012),
        ("sidewall", 0, 0.225, 0.006),
        ("shoulder", 1, -0.0625, 0.016),
        ("crown", 1, 0.0, 0.014),
    ],
)
def test_thickness_by_region_is_the_given_one(region, coordinate, place, expected):
    inner, outer = (line[: FINE // 2 + 1] for line in lines(FINE))
    station = np.argmin(np.abs(outer[:, coordinate] - place))
    thickness = np.linalg.norm(outer[station] - inner[station])
    assert thickness == pytest.approx(expected, abs=FINE_MISSED), region


def test_tread_edge_lies_on_the_crowns_circle():
    _, outer = lines(FINE)
    half = outer[: FINE // 2 + 1]
    r = np.interp(-0.0625, half[:, 1], half[:, 0])
    assert np.hypot(r - (0.278 - 0.4), 0.0625) == pytest.approx(0.4, abs=1e-6)


@both
@pytest.mark.parametrize("through", [1, 2])
def test_section_is_its_own_mirror_image(quadratic, through):
    points = section(quadratic, elements_through=through).points
    image = points * [1.0, -1.0]
    assert np.array_equal(in_order(points), in_order(image))


def in_order(points: FloatArray) -> FloatArray:
    """Points sorted by r, then y; minus zero is zero."""
    return points[np.lexsort((points + 0.0).T)] + 0.0


@pytest.mark.parametrize("surface", [0, 1], ids=["inner", "outer"])
def test_surfaces_have_no_corner(surface):
    def sharpest_turn(n_along: int) -> float:
        step = np.diff(lines(n_along)[surface], axis=0)
        return float(np.ptp(np.diff(np.unwrap(np.arctan2(step[:, 1], step[:, 0])))))

    assert sharpest_turn(1600) < 0.6 * sharpest_turn(800)  # a corner's turn would stay


@both
@pytest.mark.parametrize("through", [1, 3])
def test_quadrilaterals_turn_counter_clockwise(quadratic, through):
    assert areas(section(quadratic, elements_through=through)).min() > 0.0


def test_mid_sides_lie_between_their_corners():
    mesh = section(quadratic=True)
    corners = mesh.points[mesh.quads[:, :4]]
    mids = mesh.points[mesh.quads[:, 4:]]
    middle = (corners + np.roll(corners, -1, axis=1)) / 2.0
    length = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    assert np.all(np.linalg.norm(mids - middle, axis=2) < 0.1 * length)


def test_nodes_are_numbered_along_the_profile_and_from_the_inside_out():
    grid = section(elements_through=2).points.reshape(29, 3, 2)
    inside, outside = grid[:, 0], grid[:, -1]
    hub = np.array([0.225, 0.0])  # inside the section's hollow
    assert np.all(np.linalg.norm(outside - hub, axis=1) > np.linalg.norm(inside - hub, axis=1))
    assert grid[0, :, 1].max() < 0.0 < grid[-1, :, 1].min()
    assert np.all(np.diff(grid[:, 1, 1])[5:-5] > 0.0)


@both
def test_surfaces_run_from_rim_to_rim(quadratic):
    mesh = section(quadratic)
    ends = mesh.points[[mesh.outer[0, 0], mesh.outer[-1, 1], mesh.inner[0, 0], mesh.inner[-1, 1]]]
    assert np.all(mesh.outer[1:, 0] == mesh.outer[:-1, 1])
    assert np.all(mesh.inner[1:, 0] == mesh.inner[:-1, 1])
    assert ends[:, 1] == pytest.approx([-0.0635, 0.0635, -0.0515, 0.0515], abs=EXACT)


@both
def test_a_wall_thicker_than_its_bends_is_refused(quadratic):
    thick = Thickness(crown=0.05, shoulder=0.05, sidewall=0.05, bead=0.05)
    with pytest.raises(MeshError, match=r"folds over itself.*geometry\.thickness"):
        section(quadratic, thickness=thick)
