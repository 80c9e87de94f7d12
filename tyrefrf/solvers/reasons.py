"""Why a line has no trustworthy answer, found by counting; asked where a line has failed."""

from __future__ import annotations

import numpy as np

from tyrefrf.solvers.digits import MANY, rounding_moves, too_few_digits
from tyrefrf.solvers.modes import Pencils
from tyrefrf.solvers.problem import RingProblem, loss_factor

NEAR = 1e-6
"""Relative distance from the line within which a natural frequency is to blame for its failure."""
STILL = 1e-14
"""omega^2 up to which a motion costs nothing, relative to the largest diagonal of K over M."""
UNDAMPED = 1e-3
"""Loss factor below which a resonance that leaves no answer is called undamped."""
NO_DIGIT = 0.1
"""Share of the answer that rounding moves, above which a motion's stiffness may be none."""
MOST = 200_000
"""Dofs of all orders together up to which they are counted: about a second of work."""


def reason(problem: RingProblem, omega: float) -> str:
    """What is wrong with a line, and what may help; omega [rad/s].

    A mechanism, an undamped resonance on the line with its orders, or else too few digits for the
    tyre and its mesh.
    """
    if problem.n_cells // 2 * int(problem.free.sum()) <= MOST:
        guilty = _mechanism(problem) if omega == 0.0 else _resonance(problem, omega)
        if guilty:
            return f"{guilty}; add a loss factor, fix the rim, or move the line"
    few = too_few_digits(problem)
    if few:
        return f"too few digits are left: {few[0]}"
    return (
        "is a resonance without damping on this line? add a loss factor, fix the rim, or move the "
        "line"
    )


def loose(problem: RingProblem) -> tuple[str, ...]:
    """What an engineer should know of a tyre that is not held: it has no answer at 0 Hz."""
    if problem.rigid.count:
        what = f"nothing holds the tyre: {problem.rigid.words} cost nothing"
    else:
        what = _mechanism(problem)
    return (f"{what}; a line at 0 Hz has no answer",) if what else ()


def _mechanism(problem: RingProblem) -> str:
    """Motions that cost nothing at 0 Hz although the rim is held; "" without.

    Nor where they are told from nothing, if by few digits: a belt of steel in very soft rubber.
    """
    if MANY < rounding_moves(problem) < NO_DIGIT:
        return ""
    pencils = Pencils(problem.cell, problem.n_cells)
    still = np.sqrt(STILL * pencils.of(0).scale)
    counts = {pencil.order: pencil.count_below(still) for pencil in pencils}
    found = ", ".join(f"{h} ({count})" for h, count in counts.items() if count)
    return f"the tyre is a mechanism: motions of order {found} cost nothing" if found else ""


def _resonance(problem: RingProblem, omega: float) -> str:
    """Natural frequencies on the line, by the modes below it and just above; "" without."""
    pencils = Pencils(problem.cell, problem.n_cells, omega)
    found = [
        str(pencil.order)
        for pencil in pencils
        if pencil.count_below(omega * (1.0 + NEAR)) > pencil.count_below(omega * (1.0 - NEAR))
    ]
    if not found:
        return ""
    orders = f"order{'s' if len(found) > 1 else ''} {', '.join(found)}"
    loss = loss_factor(problem, problem.cell.dynamic_stiffness(omega))
    kind = "an undamped" if loss < UNDAMPED else "a very soft"
    return f"{kind} resonance of circumferential {orders} lies on this line"
