"""The ring by circumferential orders: one small sparse system for each, nothing condensed.

With q_{j+1} = q_j exp(i mu), mu = 2 pi h / N, the ring's equations fall apart into
A_h = P_h^H D P_h with P_h = [own dofs; right face = left face exp(i mu)]. Shares with the
recursion nothing but the cell's matrices.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu

from tyrefrf.arrays import BoolArray, ComplexArray, IntArray
from tyrefrf.errors import SingularError
from tyrefrf.solvers.problem import Field, RingProblem


class Cyclic:
    """One SuperLU factorisation per circumferential order h = 0 .. N - 1."""

    def __init__(self, problem: RingProblem) -> None:
        self.problem = problem
        cell = problem.cell
        n_own = cell.n_own
        self._keep = ~(cell.fixed[cell.rows] | cell.fixed[cell.indices])
        rows, columns = cell.rows[self._keep], cell.indices[self._keep]
        turns = (columns >= n_own).astype(int) - (rows >= n_own)  # entry times exp(i mu turns)
        number = np.cumsum(problem.free) - 1
        folded = [number[np.where(d >= n_own, d - n_own, d)] for d in (rows, columns)]
        n = int(problem.free.sum())
        keys, slot = np.unique(folded[1] * n + folded[0], return_inverse=True)
        self._indices = keys % n
        self._indptr = np.searchsorted(keys, np.arange(n + 1) * n)
        self._fold = {turn: _collector(slot, turns == turn, len(keys)) for turn in (-1, 0, 1)}

    def field(self, omega: float) -> Field:
        """Solve one line; omega [rad/s]. Raises SingularError if an order resonates undamped."""
        problem, N = self.problem, self.problem.n_cells
        D = problem.cell.dynamic_stiffness(omega)[self._keep]
        back, straight, on = (self._fold[turn] @ D for turn in (-1, 0, 1))
        f = problem.loads.toarray().reshape(N, problem.cell.n_own, -1)[:, problem.free]
        f_h = np.fft.fft(f, axis=0)
        x_h = np.empty(f_h.shape, complex)
        for h in range(N):
            turn = np.exp(2j * np.pi * h / N)
            x_h[h] = self._solve(straight + turn * on + back / turn, f_h[h])
        q = np.zeros((N, problem.cell.n_own, problem.n_loads), complex)
        q[:, problem.free] = np.fft.ifft(x_h, axis=0)
        return Field(q)

    def _solve(self, A: ComplexArray, f: ComplexArray) -> ComplexArray:
        """A_h^-1 f for one order's entries."""
        n = len(f)
        return factorise_sparse(csc_array((A, self._indices, self._indptr), shape=(n, n))).solve(f)


def _collector(slot: IntArray, here: BoolArray, n_slots: int) -> csr_array:
    """Sums the cell's entries that are `here` into the folded pattern."""
    entries = np.flatnonzero(here)
    return csr_array((np.ones(len(entries)), (slot[entries], entries)), shape=(n_slots, len(slot)))


def factorise_sparse(A: csc_array):  # type: ignore[no-untyped-def]  # SuperLU has no public type
    """SuperLU of a structurally symmetric matrix, its diagonal kept as pivots where it can be.

    Raises SingularError where a pivot is exactly zero; near that the line's residual tells.
    """
    try:
        return splu(
            A,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError as error:
        raise SingularError("exactly singular: the tyre resonates undamped on this line") from error
