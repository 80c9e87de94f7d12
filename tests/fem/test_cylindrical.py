"""Cylindrical dofs: every cell of the ring has the same matrices, and they are the ring's own.

Turning a body about the axle does not change its matrices in (r, y, theta) at each node: q^P = T
q^C with T orthogonal, A^P = T A^C T^T (the paper's [6], [7], [12], [13]). So N times one cell,
chained and closed, is exactly the ring that is assembled brick by brick in Cartesian
coordinates and then turned node by node.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fem.blocks import Block, cell_of, crooked_section, revolve
from scipy.sparse import block_diag, coo_array, csr_array

from tyrefrf.arrays import FloatArray
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.fem.elasticity import isotropic
from tyrefrf.fem.elements import ELEMENTS, Element
from tyrefrf.fem.frames import rotations
from tyrefrf.mesh.cell import CellMesh

E, NU, RHO = 28e6, 0.45, 1100.0
ROUND_OFF = 1e-12  # of the largest entry
N_CELLS = 12

all_elements = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS.keys())
layers = pytest.mark.parametrize("elements_around", [1, 2])


def cell_and_matrices(
    element: Element, elements_around: int = 1, start: float = 0.0
) -> tuple[CellMesh, CellMatrices]:
    """One of N_CELLS cells, its left section at angle `start` [rad]."""
    mesh = revolve(crooked_section(element), 2.0 * np.pi / N_CELLS, elements_around)
    mesh = replace(mesh, points=mesh.points + np.array([0.0, 0.0, start]))
    return mesh, cell_of(mesh, element, E, NU, RHO)


def chained(A: csr_array, n_own: int) -> csr_array:
    """N_CELLS times a cell's matrix, each one's right section the next one's left one."""
    A = A.tocoo()
    n = N_CELLS * n_own
    first = np.arange(N_CELLS)[:, None] * n_own
    rows, columns = (first + A.row) % n, (first + A.col) % n
    values = np.tile(A.data, N_CELLS)
    return coo_array((values, (rows.ravel(), columns.ravel())), shape=(n, n)).tocsr()


def whole_ring(mesh: CellMesh) -> tuple[Block, FloatArray]:
    """The ring's bricks among its own nodes in x, y, z, and the nodes' angles."""
    start = 2.0 * np.pi / N_CELLS * np.arange(N_CELLS)
    r, y, theta = np.tile(mesh.points[: mesh.n_own], (N_CELLS, 1)).T
    theta = theta + np.repeat(start, mesh.n_own)
    bricks = mesh.bricks + (np.arange(N_CELLS) * mesh.n_own)[:, None, None]
    points = np.stack([r * np.cos(theta), y, r * np.sin(theta)], axis=1)
    n_nodes = mesh.bricks.shape[1]
    return Block(points, bricks.reshape(-1, n_nodes) % len(points)), theta


def largest(A: csr_array) -> float:
    """The largest entry."""
    return float(np.abs(A.data).max())


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 2, 4.0])
def test_transformation_is_a_rotation(angle):
    (T,) = rotations(np.array([[angle, -angle]]))
    assert np.abs(T @ T.T - np.eye(6)).max() <= 1e-15
    assert np.linalg.det(T) == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 2, 4.0])
def test_transformation_reads_radial_axial_and_tangential(angle):
    e_r, e_y = [np.cos(angle), 0.0, np.sin(angle)], [0.0, 1.0, 0.0]
    (T,) = rotations(np.array([[angle]]))
    assert np.allclose(T, [e_r, e_y, np.cross(e_r, e_y)], rtol=0.0, atol=1e-15)


@all_elements
@layers
@pytest.mark.parametrize("start", [0.1, 2.0, -np.pi / 3])
@pytest.mark.parametrize("which", ["K", "M"])
def test_matrices_do_not_depend_on_where_the_cell_stands(element, elements_around, start, which):
    _, here = cell_and_matrices(element, elements_around)
    _, there = cell_and_matrices(element, elements_around, start)
    a, b = (cell.K["rubber"] if which == "K" else cell.M for cell in (here, there))
    assert np.abs(a - b).max() <= ROUND_OFF * np.abs(a).max()


@all_elements
@layers
@pytest.mark.parametrize("which", ["K", "M"])
def test_cells_chained_are_the_ring_assembled_in_cartesian_coordinates(
    element, elements_around, which
):
    mesh, cell = cell_and_matrices(element, elements_around)
    block, theta = whole_ring(mesh)
    bricks = (
        element.stiffness(block.X, isotropic(E, NU)) if which == "K" else element.mass(block.X, RHO)
    )
    T = block_diag([csr_array(rotations(angle[None, None])[0]) for angle in theta], format="csr")
    ring = T @ block.assembled(bricks) @ T.T
    chain = chained(cell.sparse(cell.K["rubber"] if which == "K" else cell.M), cell.n_own)
    assert largest(csr_array(ring - chain)) <= ROUND_OFF * largest(ring)


def test_pattern_is_shared_and_sums_twice_visited_entries():
    mesh, cell = cell_and_matrices(ELEMENTS["hex8"])
    dofs = (3 * mesh.bricks[:, :, None] + np.arange(3)).reshape(len(mesh.bricks), -1)
    touched = {(i, j) for row in dofs for i in row for j in row}
    assert set(zip(cell.rows.tolist(), cell.indices.tolist(), strict=True)) == touched
