"""The cell: the section revolved, with the paper's counts and bricks of positive volume.

The paper's homogeneous tyre (section 3.2): 8 degree cells of 116 nodes and 348 dofs, 45 of them
make a ring of 2610 nodes and 7830 dofs.
"""

from __future__ import annotations

from dataclasses import replace
from math import radians

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tyrefrf.arrays import FloatArray
from tyrefrf.case.geometry import Geometry, Thickness
from tyrefrf.errors import MeshError
from tyrefrf.fem.elements import ELEMENTS, jacobian
from tyrefrf.fem.quadrature import gauss
from tyrefrf.mesh.cell import CellMesh, revolve
from tyrefrf.mesh.profile import tyre_section
from tyrefrf.mesh.shapes import HEX8, HEX20, shape

SECTOR_ANGLE = radians(8.0)
N_CELLS = 45
EXACT = 1e-15

both = pytest.mark.parametrize("quadratic", [False, True], ids=["linear", "quadratic"])
layers = pytest.mark.parametrize("elements_around", [1, 3])


def cell(quadratic: bool = False, elements_around: int = 1, **sizes: object) -> CellMesh:
    section = tyre_section(Geometry(material="rubber", **sizes), quadratic)
    return revolve(section, SECTOR_ANGLE, elements_around)


def determinants(mesh: CellMesh) -> FloatArray:
    """Jacobian determinants (e, g) at 3 x 3 x 3 Gauss points."""
    nodes = HEX8 if mesh.bricks.shape[1] == 8 else HEX20
    return np.linalg.det(jacobian(mesh.cartesian[mesh.bricks], shape(nodes, gauss(3, 3)[0])[1]))


def test_the_papers_cell_has_116_nodes_and_its_ring_2610():
    mesh = cell()
    assert (mesh.n_nodes, 3 * mesh.n_nodes, len(mesh.bricks)) == (116, 348, 28)
    assert (N_CELLS * mesh.n_own, 3 * N_CELLS * mesh.n_own) == (2610, 7830)


@pytest.mark.parametrize(
    ("quadratic", "elements_around", "nodes", "own"),
    [(False, 1, 116, 58), (False, 3, 232, 174), (True, 1, 344, 201), (True, 3, 746, 603)],
)
def test_counts_of_other_cells(quadratic, elements_around, nodes, own):
    mesh = cell(quadratic, elements_around)
    assert (mesh.n_nodes, mesh.n_own) == (nodes, own)
    assert len(mesh.bricks) == 28 * elements_around


@both
@layers
def test_left_and_right_sections_stand_first_and_last_in_the_same_order(quadratic, elements_around):
    mesh = cell(quadratic, elements_around)
    left, right = mesh.points[: mesh.n_face], mesh.points[-mesh.n_face :]
    assert np.array_equal(left[:, :2], mesh.section.points)
    assert np.array_equal(right[:, :2], mesh.section.points)
    assert np.all(left[:, 2] == 0.0)
    assert np.all(right[:, 2] == SECTOR_ANGLE)


@both
@layers
def test_interior_nodes_stand_strictly_between(quadratic, elements_around):
    mesh = cell(quadratic, elements_around)
    theta = mesh.points[mesh.n_face : mesh.n_own, 2]
    assert np.all((theta > 0.0) & (theta < SECTOR_ANGLE))


@both
@layers
def test_every_node_belongs_to_a_brick_and_no_two_stand_together(quadratic, elements_around):
    mesh = cell(quadratic, elements_around)
    assert np.array_equal(np.unique(mesh.bricks), np.arange(mesh.n_nodes))
    assert len(np.unique(mesh.points.round(12), axis=0)) == mesh.n_nodes


@both
@layers
def test_bricks_turn_no_inside_out(quadratic, elements_around):
    assert determinants(cell(quadratic, elements_around)).min() > 0.0


@both
def test_every_layer_has_the_materials_of_the_section(quadratic):
    section = replace(
        tyre_section(Geometry(material="rubber"), quadratic),
        material=np.arange(28) % 2,
        materials=("rubber", "tread"),
    )
    mesh = revolve(section, SECTOR_ANGLE, 3)
    low = mesh.points[mesh.bricks[:, :4], :2]
    quad = [np.argmin(np.abs(section.points[section.quads[:, :4]] - q).sum((1, 2))) for q in low]
    assert np.array_equal(mesh.material, section.material[quad])
    assert mesh.materials == section.materials


@both
@layers
def test_natural_axes_run_along_r_y_and_theta(quadratic, elements_around):
    mesh = cell(quadratic, elements_around)
    theta = mesh.points[mesh.bricks[:, :8], 2]
    assert np.all(np.ptp(theta[:, :4], axis=1) == 0.0)
    assert np.ptp(theta[:, 4:] - theta[:, :4]) < EXACT
    assert theta[0, 4] - theta[0, 0] == pytest.approx(SECTOR_ANGLE / elements_around, abs=EXACT)


@layers
def test_mid_sides_around_lie_on_the_circle_half_way(elements_around):
    mesh = cell(quadratic=True, elements_around=elements_around)
    low, high, mid = (
        mesh.points[mesh.bricks[:, k]] for k in (slice(4), slice(4, 8), slice(16, 20))
    )
    assert np.array_equal(mid[..., :2], low[..., :2])
    assert mid[..., 2] == pytest.approx((low[..., 2] + high[..., 2]) / 2.0, abs=EXACT)


@both
@layers
def test_planes_find_the_nodes_over_a_section_node(quadratic, elements_around):
    mesh = cell(quadratic, elements_around)
    plane, k = np.nonzero(mesh.planes >= 0)
    there = mesh.points[mesh.planes[plane, k]]
    step = SECTOR_ANGLE / (len(mesh.planes) - 1)
    assert np.array_equal(there[:, :2], mesh.section.points[k])
    assert there[:, 2] == pytest.approx(step * plane, abs=EXACT)


@both
@layers
def test_rim_is_held_in_every_plane_and_nothing_else_is(quadratic, elements_around):
    mesh = cell(quadratic, elements_around)
    on_rim = np.flatnonzero(mesh.points[:, 0] <= 0.168 + EXACT)
    assert np.array_equal(np.sort(mesh.rim), on_rim)


def test_cartesian_coordinates_have_z_along_plus_theta():
    mesh = cell()
    x, y, z = mesh.cartesian.T
    assert np.hypot(x, z) == pytest.approx(mesh.points[:, 0])
    assert np.arctan2(z, x) == pytest.approx(mesh.points[:, 2], abs=EXACT)
    assert np.array_equal(y, mesh.points[:, 1])


@st.composite
def geometries(draw: st.DrawFn) -> Geometry:
    """Tyres that a case file may describe, from a kart's to an earthmover's, some too thick."""
    outer = draw(st.floats(0.1, 2.0))
    inner = outer * draw(st.floats(0.3, 0.85))
    width = outer * draw(st.floats(0.1, 1.2))
    height = outer - inner
    widest = inner + height * draw(st.floats(0.2, 0.8))
    tread = width * draw(st.floats(0.3, 0.95))
    room = min(outer - widest, width / 4.0)
    thick = st.floats(0.02, 0.98).map(lambda share: share * room)
    crown_radius = tread * draw(st.floats(0.55, 10.0))
    thickness = {region: draw(thick) for region in ("crown", "shoulder", "sidewall", "bead")}
    rim = width * draw(st.floats(0.55, 0.95))
    assume(thickness["bead"] < rim / 2.0)
    return Geometry(
        outer_radius=outer,
        inner_radius=inner,
        section_width=width,
        rim_width=rim,
        widest_radius=widest,
        tread_width=tread,
        crown_radius=crown_radius,
        thickness=Thickness(**thickness),
        elements_along=draw(st.sampled_from([8, 28, 60])),
        elements_through=draw(st.sampled_from([1, 2])),
        material="rubber",
    )


@given(geometries())
@settings(max_examples=100, deadline=None)
def test_any_geometry_has_positive_jacobians_or_is_refused(geometry):
    try:
        section = tyre_section(geometry, quadratic=False)
    except MeshError:
        return
    assert determinants(revolve(section, SECTOR_ANGLE, 1)).min() > 0.0


@given(geometries())
@settings(max_examples=100, deadline=None)
def test_any_quadratic_geometry_has_positive_mass_or_is_refused(geometry):
    # One in some thousands passes as a section and is refused as bricks: serendipity bricks
    # do not follow a section's curved side and the circle at once.
    try:
        mesh = revolve(tyre_section(geometry, quadratic=True), SECTOR_ANGLE, 1)
        M = ELEMENTS["hex20"].mass(mesh.cartesian[mesh.bricks], rho=1.0)
    except MeshError:
        return
    assert M.sum(axis=(1, 2)).min() > 0.0
    assert determinants(mesh).min() > 0.0
