"""The ring's mesh and its axes: what a rigid tyre does is known at every point.

A translation by 1 along x is (cos t, 0, -sin t) along r, y and theta. A turn by 1 rad about the
axle, from z to x, is r along -theta.
"""

from __future__ import annotations

import numpy as np
import pytest
from rings import tyre

from tyrefrf.results.ring_mesh import RingMesh

ROUND_OFF = 1e-14


@pytest.fixture(params=[("hex8i", 7, 1), ("hex8", 5, 3), ("hex20", 5, 2)], ids=str)
def ring(request):
    element, n_cells, around = request.param
    return tyre(element, n_cells, elements_along=6, elements_around=around)


@pytest.fixture
def mesh(ring):
    return RingMesh.of(ring.mesh, ring.n_cells)


def test_a_translation_is_uniform(mesh):
    c, s, zero = np.cos(mesh.theta), np.sin(mesh.theta), 0.0 * mesh.theta
    along_x, along_z = np.stack([c, zero, -s], axis=1), np.stack([s, zero, c], axis=1)
    np.testing.assert_allclose(mesh.cartesian(along_x) - [1.0, 0.0, 0.0], 0.0, atol=ROUND_OFF)
    np.testing.assert_allclose(mesh.cartesian(along_z) - [0.0, 0.0, 1.0], 0.0, atol=ROUND_OFF)
    along_y = np.stack([zero, 0.0 * zero + 1.0, zero], axis=1)
    np.testing.assert_array_equal(mesh.cartesian(along_y), along_y)


def test_a_turn_about_the_axle_is_along_theta(mesh):
    x, y, z = mesh.points.T
    turned = np.stack([z, 0.0 * y, -x], axis=1)  # e_y cross the place
    r = np.hypot(x, z)
    u = np.stack([0.0 * r, 0.0 * r, -r], axis=1)
    np.testing.assert_allclose(mesh.cartesian(u), turned, atol=ROUND_OFF)


def test_vectors_turn_as_the_referee_s_do(ring, mesh):
    rng = np.random.default_rng(1)
    u = rng.normal(size=(len(mesh.points), 3)) + 1j * rng.normal(size=(len(mesh.points), 3))
    expected = (ring.to_cartesian @ u.ravel()).reshape(-1, 3)
    np.testing.assert_allclose(mesh.cartesian(u), expected, atol=ROUND_OFF * 10)


def test_every_point_belongs_to_a_brick_and_no_two_share_a_place(mesh):
    np.testing.assert_array_equal(np.unique(mesh.bricks), np.arange(len(mesh.points)))
    apart = np.unique(np.round(mesh.points, 9), axis=0)
    assert len(apart) == len(mesh.points)


def test_bricks_are_the_cell_s_turned_around_the_axle(ring, mesh):
    per_cell = len(ring.mesh.bricks)
    angle = mesh.cell * ring.mesh.sector_angle
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x, y, z = np.moveaxis(
        np.tile(ring.mesh.cartesian[ring.mesh.bricks], (ring.n_cells, 1, 1)), 2, 0
    )
    expected = np.stack([x * c - z * s, y, x * s + z * c], axis=2)
    np.testing.assert_allclose(mesh.points[mesh.bricks], expected, atol=ROUND_OFF)
    assert np.bincount(mesh.cell).tolist() == [per_cell] * ring.n_cells


def test_the_outer_surface_is_closed_around_and_faces_outwards(ring, mesh):
    """Its edges are shared but for the two circles at the rim; at the crown it looks away."""
    edges = np.sort(np.stack([mesh.outer, np.roll(mesh.outer, -1, axis=1)], axis=2), axis=2)
    _, shared = np.unique(edges.reshape(-1, 2), axis=0, return_counts=True)
    per_circle = ring.n_cells * (len(mesh.outer) // len(ring.mesh.section.outer) // ring.n_cells)
    assert np.sum(shared == 1) == 2 * per_circle
    assert shared.max() == 2
    X = mesh.points[mesh.outer]
    normal = np.cross(X[:, 2] - X[:, 0], X[:, 3] - X[:, 1])
    middle = X.mean(axis=1)
    radius = np.hypot(middle[:, 0], middle[:, 2])
    crown = radius > 0.9 * radius.max()
    assert crown.any()
    assert np.all(np.einsum("fi,fi->f", normal, middle * [1.0, 0.0, 1.0])[crown] > 0.0)


def test_its_arrays_are_read_only(mesh):
    with pytest.raises(ValueError, match="read-only"):
        mesh.points[0] = 0.0
