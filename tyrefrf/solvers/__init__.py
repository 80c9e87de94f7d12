"""Solvers of the ring: all answer the same question, so each checks the others."""

from collections.abc import Callable

from tyrefrf.solvers.cyclic import Cyclic
from tyrefrf.solvers.direct import Direct
from tyrefrf.solvers.problem import Field, Line, RingProblem, Solver, solve_line
from tyrefrf.solvers.recursive import Recursive

SOLVERS: dict[str, Callable[[RingProblem], Solver]] = {
    "recursive": Recursive,
    "cyclic": Cyclic,
    "direct": Direct,
}
"""The solvers by the names that case files use."""

__all__ = [
    "SOLVERS",
    "Cyclic",
    "Direct",
    "Field",
    "Line",
    "Recursive",
    "RingProblem",
    "Solver",
    "solve_line",
]
