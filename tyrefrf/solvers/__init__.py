"""Solvers of the ring: all answer the same question, so each checks the others."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from tyrefrf.solvers.cyclic import Cyclic
from tyrefrf.solvers.direct import Direct, check_library
from tyrefrf.solvers.lines import answer, field_of, solve_field, solve_line
from tyrefrf.solvers.memory import check_memory
from tyrefrf.solvers.modal import Modal
from tyrefrf.solvers.problem import (
    Field,
    Line,
    RingProblem,
    Solver,
    no_answer,
    responses,
)
from tyrefrf.solvers.recursive import Recursive
from tyrefrf.solvers.sensors import Sensors
from tyrefrf.solvers.timed import TimedLine

if TYPE_CHECKING:
    from tyrefrf import case

SOLVERS: dict[str, Callable[[RingProblem], Solver]] = {
    "recursive": Recursive,
    "cyclic": Cyclic,
    "direct": Direct,
}
"""The exact solvers, which need nothing but the problem, by the names that case files use."""

Maker = Callable[[], Solver]
"""Makes a solver in the process that calls it; may be sent there."""


def prepare(problem: RingProblem, choice: case.Solver, jobs: int = 1) -> Maker:
    """What is done once for all processes; what is returned makes the solver in each of them.

    Raises SolveError where no line could be solved: too little memory for `jobs` processes, a
    library that is missing, modes that are not to be had.
    """
    if choice.name == "direct":
        library = check_library(choice.library)
        check_memory(problem, library, jobs)
        return partial(Direct, problem, library)
    if choice.name == "modal":
        return partial(_itself, Modal.prepare(problem, choice))
    _ = problem.softness  # known here, it need not be found in each process
    return partial(SOLVERS[choice.name], problem)


def _itself(solver: Solver) -> Solver:
    return solver


__all__ = [
    "SOLVERS",
    "Cyclic",
    "Direct",
    "Field",
    "Line",
    "Maker",
    "Modal",
    "Recursive",
    "RingProblem",
    "Sensors",
    "Solver",
    "TimedLine",
    "answer",
    "field_of",
    "no_answer",
    "prepare",
    "responses",
    "solve_field",
    "solve_line",
]
