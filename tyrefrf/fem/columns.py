"""Loads and probes as columns over the ring's dofs: one builder, so that reciprocity is exact."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, hstack

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.fem.frames import axes
from tyrefrf.mesh.place import Nodes
from tyrefrf.mesh.surface import Spots

NEGLIGIBLE = 1e-14  # of a column's largest weight: rounding of sines and cosines


def surface_column(
    mesh: Nodes, spots: Spots, share: FloatArray, direction: str, angle: float
) -> csc_array:
    """A unit traction resultant on spots (m,) with shares (m,), or the mean motion of them.

    direction: "r", "y" or "theta" at `angle` [rad]; the same vector at every spot. As a load:
    f = sum of share N^T e. As a probe: the displacement along e with the same weights.
    """
    e = axes(np.asarray(angle))[("r", "y", "theta").index(direction)]
    theta = spots.cell[:, None] * mesh.sector_angle + mesh.points[spots.nodes, 2]
    weights = (share[:, None] * spots.weights)[..., None] * (axes(theta) @ e)
    nodes = spots.cell[:, None] * mesh.n_own + spots.nodes
    return _column(mesh, nodes, weights)


def node_column(mesh: Nodes, cell: int, node: int, direction: str) -> csc_array:
    """A unit force on, or the displacement of, one node (its number in the cell)."""
    weights = np.zeros((1, 3))
    weights[0, ("r", "y", "theta").index(direction)] = 1.0
    return _column(mesh, cell * mesh.n_own + np.array([node]), weights)


def hub_columns(mesh: Nodes) -> csc_array:
    """Forces and moments on the rim, six columns in the order of `mesh.place.HUB`.

    Cartesian axes of the wheel, moments about its centre; they collect the forces that the tyre
    exerts on the rim's fixed nodes.
    """
    n_cells = _n_cells(mesh)
    rim = mesh.rim[mesh.rim < mesh.n_own]
    cells = np.repeat(np.arange(n_cells), len(rim))
    nodes = np.tile(rim, n_cells)
    r, y, theta = mesh.points[nodes].T
    R = axes(cells * mesh.sector_angle + theta)  # (m, local, Cartesian)
    x = r[:, None] * R[:, 0] + y[:, None] * R[:, 1]
    force = list(np.moveaxis(R, 2, 0))
    moment = list(np.moveaxis(np.cross(x[:, None], R), 2, 0))
    ring_nodes = cells * mesh.n_own + nodes
    return hstack([_column(mesh, ring_nodes, w) for w in force + moment], format="csc")


def _n_cells(mesh: Nodes) -> int:
    """Cells around the axle."""
    return round(2.0 * np.pi / mesh.sector_angle)


def _column(mesh: Nodes, ring_nodes: IntArray, weights: FloatArray) -> csc_array:
    """One sparse column from ring nodes (...) and their (r, y, theta) weights (..., 3).

    A ring node is cell * n_own + node: the right section's nodes follow the own ones in a cell as
    the next cell's left section's do in the ring, so that the sum serves them too.
    """
    n_rows = 3 * mesh.n_own * _n_cells(mesh)
    rows = (3 * ring_nodes[..., None] + np.arange(3)).ravel() % n_rows
    values = weights.ravel()
    column = csc_array((values, (rows, np.zeros_like(rows))), shape=(n_rows, 1))
    column.sum_duplicates()
    column.data[abs(column.data) < NEGLIGIBLE * abs(column.data).max()] = 0.0
    column.eliminate_zeros()
    return column
