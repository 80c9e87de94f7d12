"""What a line by the recursion consists of, so that each part can be timed by itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchmarks.tyres import OMEGA
from tyrefrf.solvers import Field, Recursive, RingProblem
from tyrefrf.solvers.condense import Condenser
from tyrefrf.solvers.recursive import share_of
from tyrefrf.solvers.ring import MOST_CHAINS, chain_of, closed, n_chains
from tyrefrf.solvers.symmetry import UNTOUCHED, shares

CELL, JOINS, CHECK, LINE = "D and its cell", "joins and closing", "residual", "line"


def parts_of(problem: RingProblem) -> dict[str, Callable[[], object]]:
    """The whole line, and what of it can be done alone: the cell, the joins, the check.

    What the line takes beyond these is the recovery of all sections. The load has to act on the
    first section alone.
    """
    cell, solver = problem.cell, Recursive(problem)
    condense = Condenser(cell)
    D = cell.dynamic_stiffness(OMEGA)
    face, _ = condense(D)
    F = problem.load_cells()[0][: cell.n_face][problem.free[: cell.n_face]]
    q = solver.field(OMEGA).q
    excited = [
        (share, f)
        for share in shares(cell)
        if np.linalg.norm(f := share.Q.T @ F) > UNTOUCHED * np.linalg.norm(F)
    ]

    def joins() -> None:
        for share, f in excited:
            part = share_of(face, share)
            k = n_chains(problem.n_cells, part.DOUBLE, part.JOIN, MOST_CHAINS)
            closed(chain_of(part, problem.n_cells // k), k, f)

    return {
        LINE: lambda: solver.field(OMEGA),
        CELL: lambda: condense(cell.dynamic_stiffness(OMEGA)),
        JOINS: joins,
        CHECK: lambda: Field.checked(problem, D, q),
    }


def recovery(seconds: dict[str, float]) -> float:
    """What a line takes beyond its other parts [s]."""
    return max(seconds[LINE] - seconds[CELL] - seconds[JOINS] - seconds[CHECK], 0.0)
