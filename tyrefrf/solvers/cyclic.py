"""The ring by circumferential orders: one small sparse system for each, nothing condensed.

Shares with the recursion nothing but the cell's matrices.
"""

from __future__ import annotations

import numpy as np

from tyrefrf.solvers.orders import Orders
from tyrefrf.solvers.problem import Field, RingProblem
from tyrefrf.solvers.sparse import solve_sparse


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
