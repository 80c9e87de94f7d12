"""The whole ring assembled, one sparse complex-symmetric factorisation per line: the truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

import numpy as np

from tyrefrf.arrays import ComplexArray, IntArray
from tyrefrf.errors import SolveError
from tyrefrf.solvers import mkl
from tyrefrf.solvers.pardiso import PardisoSystem
from tyrefrf.solvers.problem import Field, RingProblem, watched
from tyrefrf.solvers.sparse import Scattered, SuperLU


class System(Protocol):
    """Systems of one pattern; built once, solved for new values on every line."""

    def solve(self, values: ComplexArray, f: ComplexArray) -> tuple[ComplexArray, str]:
        """A^-1 f (n, m) and a remark. Raises SingularError where a pivot is zero."""
        ...


LIBRARIES: dict[str, Callable[[Scattered], System]] = {
    "pardiso": PardisoSystem,
    "superlu": SuperLU,
}
"""What factorises, by the names that case files use, the fastest first."""


class Direct:
    """The ring's D q = f, factorised on every line.

    library: a name in `LIBRARIES`, or "auto" for the fastest that is installed.

    On every line one load more is solved for, that finds undamped resonances: see `watched`.
    """

    exact = True

    def __init__(self, problem: RingProblem, library: str = "auto") -> None:
        self.problem = problem
        self._watched = watched(problem)
        self._free = np.tile(problem.free, problem.n_cells)
        self._f = self._watched.loads.toarray()[self._free].astype(complex)
        self._system = LIBRARIES[check_library(library)](ring_matrix(problem))

    def field(self, omega: float) -> Field:
        """Solve one line; omega [rad/s]. Raises SingularError if the ring resonates undamped."""
        cell, watched = self.problem.cell, self._watched
        q = np.zeros((watched.n_ring_dofs, watched.n_loads), complex)
        D = cell.dynamic_stiffness(omega)
        q[self._free], remark = self._system.solve(D, self._f)
        field = Field.checked(watched, D, q.reshape(watched.n_cells, cell.n_own, -1))
        return replace(field.without_last(), remark=remark)


def check_library(name: str) -> str:
    """The library that this name stands for; "auto" is the fastest that is installed.

    Raises SolveError where it is not installed.
    """
    if name == "auto":
        return "pardiso" if mkl.installed() else "superlu"
    if name == "pardiso" and not mkl.installed():
        raise SolveError(
            "library 'pardiso': MKL is not installed here; `pip install 'tyrefrf[mkl]'` (or "
            "`pip install mkl`) brings it, 'auto' and 'superlu' do without it"
        )
    return name


def ring_matrix(problem: RingProblem) -> Scattered:
    """The ring's matrices on the dofs that move, as sums of the entries of one cell's."""
    cell, N, n_ring = problem.cell, problem.n_cells, problem.n_ring_dofs
    kept = _kept(problem)
    number = np.cumsum(np.tile(problem.free, N)) - 1
    start = np.arange(N)[:, None] * cell.n_own
    rows, columns = (
        number[(start + dofs[kept]) % n_ring].ravel() for dofs in (cell.rows, cell.indices)
    )
    return Scattered(int(number[-1]) + 1, rows, columns, np.tile(kept, N))


def n_entries(problem: RingProblem) -> int:
    """How many entries of cells `ring_matrix` sums."""
    return problem.n_cells * len(_kept(problem))


def _kept(problem: RingProblem) -> IntArray:
    """The entries of a cell's matrices between dofs that move."""
    cell = problem.cell
    return np.flatnonzero(~(cell.fixed[cell.rows] | cell.fixed[cell.indices]))
