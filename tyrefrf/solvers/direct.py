"""The whole ring assembled, one sparse complex factorisation per line: the truth."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array

from tyrefrf.solvers.cyclic import solve_sparse
from tyrefrf.solvers.problem import Field, RingProblem


class Direct:
    """SuperLU of the ring's dynamic stiffness."""

    exact = True

    def __init__(self, problem: RingProblem) -> None:
        self.problem = problem
        cell = problem.cell
        n_ring = problem.n_ring_dofs
        start = np.arange(problem.n_cells)[:, None] * cell.n_own
        self._keep = ~(cell.fixed[cell.rows] | cell.fixed[cell.indices])
        number = np.cumsum(np.tile(problem.free, problem.n_cells)) - 1
        self._n = int(number[-1]) + 1
        self._rows = number[(start + cell.rows[self._keep]) % n_ring].ravel()
        self._columns = number[(start + cell.indices[self._keep]) % n_ring].ravel()

    def field(self, omega: float) -> Field:
        """Solve one line; omega [rad/s]. Raises SingularError if the ring resonates undamped."""
        problem = self.problem
        D = problem.cell.dynamic_stiffness(omega)[self._keep]
        entries = np.tile(D, problem.n_cells)
        A = csc_array((entries, (self._rows, self._columns)), shape=(self._n, self._n))
        free = np.tile(problem.free, problem.n_cells)
        q = np.zeros((problem.n_ring_dofs, problem.n_loads), complex)
        q[free] = solve_sparse(A, problem.loads.toarray()[free].astype(complex))
        return Field.checked(problem, omega, q.reshape(problem.n_cells, problem.cell.n_own, -1))
