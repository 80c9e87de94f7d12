"""Which solver takes the least time, where a case leaves it open (`solver.name = "auto"`)."""

from __future__ import annotations

from dataclasses import replace

from tyrefrf.case import Case, Solver
from tyrefrf.solvers import RingProblem
from tyrefrf.study.cost import line_seconds
from tyrefrf.study.model import Model

CANDIDATES = ("recursive", "cyclic")
"""The exact solvers whose time a line's operations tell; `direct` is never the faster."""


def with_solver(case: Case, name: str) -> Case:
    """The case with another solver; its own keeps its options."""
    if name == case.solver.name:
        return case
    return case.model_copy(update={"solver": Solver.model_validate({"name": name})})


def decided(case: Case, problem: RingProblem) -> tuple[Case, dict[str, float]]:
    """The case with the solver expected to be the fastest, and the seconds per line of each.

    A case that names its solver comes back as it is, with nothing expected.
    """
    if case.solver.name != "auto":
        return case, {}
    seconds = {name: line_seconds(name, problem) for name in CANDIDATES}
    fastest = min(seconds, key=seconds.__getitem__)
    return with_solver(case, fastest), {f"expected_{name}": s for name, s in seconds.items()}


def decided_model(model: Model) -> tuple[Model, dict[str, float]]:
    """The model of the decided case."""
    case, expected = decided(model.case, model.problem)
    return replace(model, case=case), expected
