"""Loads and probes against what rigid motions and statics say of them.

A column of weights w at a place x with direction e must give, under every displacement field that
the elements represent exactly, the field's value there: w . q = e . u(x). Translations and
rotations are such fields (Cartesian coordinates are interpolated by the same functions), so they
check weights, axes, numbering around the ring and the place that is stored.
"""

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small import case_with

from tyrefrf.fem.columns import surface_column
from tyrefrf.fem.frames import axes
from tyrefrf.mesh.surface import Surface
from tyrefrf.study.model import build_mesh, build_model

ROUND_OFF = 1e-12  # of fields of order one
STATICS = 1e-9  # of a unit force, through a solve whose condition is some 1e6
ELEMENTS = ("hex8i", "hex20")


@cache
def mesh_of(element, elements_around=1):
    return build_mesh(
        case_with(
            ('element = "hex8i"', f'element = "{element}"\nelements_around = {elements_around}')
        )
    )


def ring_points(mesh):
    """Own nodes of all cells: Cartesian coordinates (n, 3) and angles (n,)."""
    n_cells = round(2 * np.pi / mesh.sector_angle)
    r, y, theta = mesh.points[: mesh.n_own].T
    angle = (np.arange(n_cells)[:, None] * mesh.sector_angle + theta).ravel()
    r, y = np.tile(r, n_cells), np.tile(y, n_cells)
    return np.stack([r * np.cos(angle), y, r * np.sin(angle)], axis=1), angle


def in_ring_dofs(u, angle):
    """Cartesian displacements (n, 3) as the ring's cylindrical dofs (3 n,)."""
    return np.einsum("nij,nj->ni", axes(angle), u).ravel()


@pytest.mark.parametrize("elements_around", [1, 2])
@pytest.mark.parametrize("element", ELEMENTS)
@given(
    s=st.floats(0.0, 1.0),
    angle=st.integers(0, 35_999).map(lambda n: n / 100),  # off the planes by more than ON_PLANE
    surface=st.sampled_from(["outer", "inner"]),
    direction=st.sampled_from(["r", "y", "theta"]),
)
def test_point_column_reads_rigid_motions_exactly(
    element, elements_around, s, angle, surface, direction
):
    mesh = mesh_of(element, elements_around)
    angle = np.deg2rad(angle)
    spots = Surface(mesh, surface).spots(np.array([s]), np.array([angle]))
    column = surface_column(mesh, spots, np.ones(1), direction, angle)
    x_nodes, theta = ring_points(mesh)
    x = np.array(
        [spots.r[0] * np.cos(angle), spots.y[0], spots.r[0] * np.sin(angle)]
    )  # the place as stored
    e = axes(np.array(angle))[("r", "y", "theta").index(direction)]
    for v, spin in zip(np.eye(3), np.eye(3), strict=True):
        q = in_ring_dofs(v + np.cross(spin, x_nodes), theta)
        assert (column.T @ q)[0] == pytest.approx(e @ (v + np.cross(spin, x)), abs=ROUND_OFF)


@pytest.mark.parametrize("element", ELEMENTS)
def test_stored_angle_is_the_mesh_place_s(element):
    mesh = mesh_of(element)
    angle = np.linspace(0.0, 2 * np.pi, 50, endpoint=False)
    spots = Surface(mesh, "outer").spots(np.linspace(0, 1, 50), angle)
    np.testing.assert_allclose(np.unwrap(spots.angle), angle, atol=1e-12)


def test_arc_length_fraction_is_measured_along_the_surface():
    mesh = mesh_of("hex8i")
    outer = Surface(mesh, "outer")
    fine = outer.spots(np.linspace(0.0, 1.0, 20_001), np.zeros(20_001))
    lengths = np.hypot(np.diff(fine.r), np.diff(fine.y))
    assert lengths.sum() == pytest.approx(outer.length, rel=1e-4)  # chords cut the corners
    np.testing.assert_allclose(np.cumsum(lengths)[4999], 0.25 * outer.length, rtol=1e-4)


@pytest.mark.parametrize("element", ELEMENTS)
def test_disc_has_its_area_and_centre(element):
    mesh = mesh_of(element)
    outer = Surface(mesh, "outer")
    spots, share = outer.disc(0.5, 1.0, 0.02)
    assert share.sum() == pytest.approx(1.0, abs=ROUND_OFF)
    around = 0.278 * (spots.angle - 1.0)
    assert share @ around == pytest.approx(0.0, abs=1e-5)
    assert share @ spots.y == pytest.approx(0.0, abs=ROUND_OFF)
    # second moment of a disc about a diameter over its area: d^2/16
    assert share @ around**2 == pytest.approx(0.02**2 / 16, rel=0.02)
    assert share @ spots.y**2 == pytest.approx(0.02**2 / 16, rel=0.02)


def point_of_action(mesh, place):
    """Where the resultant of a load acts, in Cartesian coordinates."""
    if place.kind == "node":
        R = axes(np.array(place.angle))
        return place.r * R[0] + place.y * R[1]
    spots, share = Surface(mesh, place.surface).disc(place.s, place.angle, place.diameter)
    r, angle = spots.r, spots.angle
    return share @ np.stack([r * np.cos(angle), spots.y, r * np.sin(angle)], axis=1)


@pytest.mark.parametrize("element", ELEMENTS)
def test_rim_carries_every_load_at_rest(element):
    """At 0 Hz the force and moment on the hub are those of the load about the wheel's centre."""
    from tyrefrf.solvers import Recursive, solve_line

    model = build_model(
        case_with(
            ('element = "hex8i"', f'element = "{element}"'),
            (
                '[[probes]]\nname = "sidewall"',
                '[[loads]]\nname = "inner"\nkind = "patch"\nsurface = "inner"\ns = 0.9\n'
                'angle = 305.0\ndirection = "y"\n\n[[probes]]\nname = "sidewall"',
            ),
        )
    )
    line = solve_line(model.problem, Recursive(model.problem), 0.0)
    hub = line.receptance[len(model.probes) :]
    for number, place in enumerate(model.loads):
        force = axes(np.array(place.angle))[("r", "y", "theta").index(place.direction)]
        np.testing.assert_allclose(hub[:3, number], force, atol=STATICS)
        moment = np.cross(point_of_action(model.mesh, place), force)
        np.testing.assert_allclose(hub[3:, number], moment, atol=STATICS)


def test_node_load_snaps_to_the_nearest_node_and_says_so():
    model = build_model(case_with(("s = 0.5\n", "s = 0.52\nangle = 13.0\n")))
    place = model.loads[0]
    assert (place.kind, place.surface) == ("node", "outer")
    assert place.s == pytest.approx(0.5, abs=1e-12)
    assert np.rad2deg(place.angle) == pytest.approx(24.0)
    assert place.r == pytest.approx(0.278)


def test_point_on_a_node_is_that_node():
    at_node = build_model(case_with()).problem.loads[:, [0]]
    point = build_model(
        case_with(
            (
                'name = "sidewall"\ns = 0.8\nangle = 31.0\ndirection = "y"',
                'name = "sidewall"\ns = 0.5\nangle = 0.0\ndirection = "r"',
            )
        )
    ).problem.probes[:, [2]]
    np.testing.assert_allclose(point.toarray(), at_node.toarray(), atol=ROUND_OFF)


def test_driving_point_has_the_load_s_own_weights():
    problem = build_model(case_with()).problem
    np.testing.assert_array_equal(problem.probes[:, [0, 1]].toarray(), problem.loads.toarray())
