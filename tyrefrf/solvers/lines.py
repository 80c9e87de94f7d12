"""One frequency line by any solver: asked, checked, and named where it has no answer."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from tyrefrf.errors import SingularError, SolveError, short_of_memory
from tyrefrf.solvers.adrift import balanced, parted
from tyrefrf.solvers.problem import (
    RESIDUAL_MAX,
    Field,
    Line,
    RingProblem,
    Solver,
    no_answer,
    responses,
)
from tyrefrf.solvers.reasons import reason

RESIDUAL_TRUSTED = 1e-8
"""Residual up to which a solver's own answer for a tyre that nothing holds stands."""


def field_of(problem: RingProblem, solver: Solver, omega: float) -> Field:
    """What a solver answers on a line; omega [rad/s].

    The rigid motions of a tyre that nothing holds are put right by the balance of momentum.
    Raises SingularError as the solver does, and SolveError for such a tyre at 0 Hz.
    """
    if not problem.rigid.count:
        return solver.field(omega)
    if omega == 0.0:
        raise SolveError(
            f"nothing holds the tyre: {problem.rigid.words} cost nothing; fix the rim, or leave "
            "this line out"
        )
    if not solver.exact:
        return balanced(problem, solver.field(omega), omega)
    with suppress(SingularError):
        field = solver.field(omega)
        if field.residual <= RESIDUAL_TRUSTED:
            return balanced(problem, field, omega)
    return parted(problem, omega)


def solve_field(problem: RingProblem, solver: Solver, omega: float) -> Field:
    """Solve one line for the whole ring and check it against the ring's own equations.

    omega: [rad/s]. Raises SolveError, which names the frequency and the reason, where there is no
    answer.
    """
    line = f"{omega / (2.0 * np.pi):.6g} Hz"
    try:
        field = field_of(problem, solver, omega)
    except SingularError as error:
        why = f"; {reason(problem, omega)}" if solver.exact else ""
        raise SolveError(f"{line}: {error}{why}") from error
    except SolveError as error:
        raise SolveError(f"{line}: {error}") from error
    except MemoryError as error:
        raise SolveError(f"{line}: {short_of_memory(error)}") from error
    if solver.exact and not field.residual <= RESIDUAL_MAX:  # NaN too
        why = f"no trustworthy solution (residual {field.residual:.1e})"
        raise SolveError(f"{line}: {why}; {reason(problem, omega)}")
    return field


def solve_line(problem: RingProblem, solver: Solver, omega: float) -> Line:
    """What the probes see of one line. Raises SolveError as `solve_field`."""
    field = solve_field(problem, solver, omega)
    try:
        return Line(responses(problem, field, omega), field.residual, field.remark)
    except SolveError as error:
        raise SolveError(f"{omega / (2.0 * np.pi):.6g} Hz: {error}") from error
    except MemoryError as error:
        why = short_of_memory(error)
        raise SolveError(f"{omega / (2.0 * np.pi):.6g} Hz: {why}") from error


def answer(problem: RingProblem, solver: Solver, omega: float) -> Line:
    """One line as `solve_line`; where that has no answer, NaN and the reason."""
    try:
        return solve_line(problem, solver, omega)
    except SolveError as error:
        return no_answer(problem, str(error))
