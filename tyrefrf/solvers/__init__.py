"""Solvers of the ring: all answer the same question, so each checks the others."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from tyrefrf.solvers.cyclic import Cyclic
from tyrefrf.solvers.direct import Direct
from tyrefrf.solvers.problem import Field, Line, RingProblem, Solver, solve_line
from tyrefrf.solvers.recursive import Recursive

if TYPE_CHECKING:
    from tyrefrf import case

SOLVERS: dict[str, Callable[[RingProblem], Solver]] = {
    "recursive": Recursive,
    "cyclic": Cyclic,
    "direct": Direct,
}
"""The solvers that need nothing but the problem, by the names that case files use."""

Maker = Callable[[], Solver]
"""Makes a solver in the process that calls it; may be sent there."""


def prepare(problem: RingProblem, choice: case.Solver, jobs: int = 1) -> Maker:
    """What is done once for all processes; what is returned makes the solver in each of them."""
    return partial(SOLVERS[choice.name], problem)


__all__ = [
    "SOLVERS",
    "Cyclic",
    "Direct",
    "Field",
    "Line",
    "Maker",
    "Recursive",
    "RingProblem",
    "Solver",
    "prepare",
    "solve_line",
]
