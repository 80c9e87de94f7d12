"""The ring by circumferential orders: one small sparse system for each, nothing condensed.

Shares with the recursion nothing but the cell's matrices.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from tyrefrf.arrays import ComplexArray
from tyrefrf.errors import SingularError
from tyrefrf.solvers.orders import Orders
from tyrefrf.solvers.problem import Field, RingProblem

PIVOT_RESIDUAL = 1e-10
"""Relative residual up to which diagonal pivots are trusted; damped tyres stay below it."""


class Cyclic:
    """One SuperLU factorisation per circumferential order h = 0 .. N - 1."""

    exact = True

    def __init__(self, problem: RingProblem) -> None:
        self.problem = problem
        self._orders = Orders(problem.cell)

    def field(self, omega: float) -> Field:
        """Solve one line; omega [rad/s]. Raises SingularError if an order resonates undamped."""
        problem, N = self.problem, self.problem.n_cells
        D = self._orders.folded(problem.cell.dynamic_stiffness(omega))
        f = problem.loads.toarray().reshape(N, problem.cell.n_own, -1)[:, problem.free]
        f_h = np.fft.fft(f, axis=0)
        x_h = np.empty(f_h.shape, complex)
        for h in range(N):
            A_h = self._orders.matrix(D.at(2.0 * np.pi * h / N))
            x_h[h] = solve_sparse(A_h, f_h[h])
        q = np.zeros((N, problem.cell.n_own, problem.n_loads), complex)
        q[:, problem.free] = np.fft.ifft(x_h, axis=0)
        return Field.checked(problem, omega, q)


def solve_sparse(A: csc_array, f: ComplexArray) -> ComplexArray:
    """A^-1 f (n, m) by SuperLU, for a structurally symmetric A.

    The diagonal is kept as pivots, which fills least. Without damping that can lose every digit
    (a part of the tyre that resonates on its own is a singular leading block), so where the
    residual tells of it, the matrix is factorised once more with pivots from off the diagonal.
    Raises SingularError where a pivot is exactly zero even then; else the line's residual tells.
    """
    for threshold in (0.0, 0.1):
        try:
            x = splu(
                A,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=threshold,
                options={"SymmetricMode": True},
            ).solve(f)
        except RuntimeError as error:
            if threshold:
                raise SingularError(
                    "exactly singular: the tyre resonates undamped on this line"
                ) from error
            continue
        if np.all(np.linalg.norm(A @ x - f, axis=0) <= PIVOT_RESIDUAL * np.linalg.norm(f, axis=0)):
            break
    return x
