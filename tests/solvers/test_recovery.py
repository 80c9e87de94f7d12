"""What was eliminated comes back: inner faces of a chain, the inside of a cell."""

from __future__ import annotations

import numpy as np
import pytest
from rings import lopsided, omegas, open_chain, tyre

from tyrefrf.solvers.condense import Condenser
from tyrefrf.solvers.ring import chain_of

ROUND_OFF = 1e-9
OMEGA = omegas(640.0)[0]


@pytest.fixture(scope="module")
def ring():
    return lopsided(tyre(n_cells=20, elements_along=4, elements_around=2))


@pytest.fixture(scope="module")
def ends():
    """Displacements of both end faces' free dofs, two columns."""
    rng = np.random.default_rng(3)
    return rng.normal(size=(2, 18, 2)) + 1j * rng.normal(size=(2, 18, 2))


def dense_chain(ring, n_cells, q_L, q_R, f=None):
    """Free dofs between the end faces, and the forces on these, from the assembled open chain."""
    cell = ring.cell
    free = ~np.concatenate([np.tile(cell.fixed[: cell.n_own], n_cells), cell.fixed[: cell.n_face]])
    D = open_chain(cell, cell.dynamic_stiffness(OMEGA), n_cells)[np.ix_(free, free)]
    n = len(q_L)
    q_ends = np.concatenate([q_L, q_R])
    end, between = np.r_[0:n, len(D) - n : len(D)], np.arange(n, len(D) - n)
    load = -D[np.ix_(between, end)] @ q_ends + (0.0 if f is None else f)
    q = np.linalg.solve(D[np.ix_(between, between)], load)
    return q, D[np.ix_(end, end)] @ q_ends + D[np.ix_(end, between)] @ q


@pytest.mark.parametrize("n_cells", [1, 2, 3, 4, 7, 8, 13])
def test_inner_faces_and_end_forces_of_a_chain(ring, ends, n_cells):
    q_L, q_R = ends
    n = len(q_L)
    cell, interior = Condenser(ring.cell)(ring.cell.dynamic_stiffness(OMEGA))
    between, forces = dense_chain(ring, n_cells, q_L, q_R)

    chain = chain_of(cell, n_cells)
    faces = chain.inner_faces(q_L, q_R)
    F = np.concatenate([chain.LL @ q_L + chain.LR @ q_R, chain.LR.T @ q_L + chain.RR @ q_R])
    left, right = np.concatenate([q_L[None], faces]), np.concatenate([faces, q_R[None]])
    inner = -(interior.X_L @ left + interior.X_R @ right)

    n_inner = inner.shape[1]
    expected = np.concatenate([between, q_R]).reshape(n_cells, n_inner + n, -1)
    assert faces.shape == (n_cells - 1, n, 2)
    np.testing.assert_allclose(forces, F, atol=ROUND_OFF * np.abs(F).max())
    np.testing.assert_allclose(inner, expected[:, :n_inner], atol=ROUND_OFF * np.abs(ends).max())
    np.testing.assert_allclose(faces, expected[:-1, n_inner:], atol=ROUND_OFF * np.abs(ends).max())


def test_a_load_inside_a_cell(ring, ends):
    """[3] with f_I: q_I = D_II^-1 f_I - X_L q_L - X_R q_R, and -D_.I D_II^-1 f_I on both faces."""
    q_L, q_R = ends
    cell, interior = Condenser(ring.cell)(ring.cell.dynamic_stiffness(OMEGA))
    f = 1e6 * np.random.default_rng(4).normal(size=(len(interior.X_L), 2)) + 0j
    expected, forces = dense_chain(ring, 1, q_L, q_R, f)

    x = interior.factor.solve(f)
    q_I = x - interior.X_L @ q_L - interior.X_R @ q_R
    F_L = cell.LL @ q_L + cell.LR @ q_R + interior.D_LI @ x
    F_R = cell.LR.T @ q_L + cell.RR @ q_R + interior.D_RI @ x

    np.testing.assert_allclose(q_I, expected, atol=ROUND_OFF * np.abs(expected).max())
    np.testing.assert_allclose([*F_L, *F_R], forces, atol=ROUND_OFF * np.abs(forces).max())
