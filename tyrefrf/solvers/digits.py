"""How many digits rounding leaves, known before a line is solved.

Stiffnesses of steel and rubber, or across and along a thin element, add up to entries of K that
cancel in soft motions: their rounding, 1e-16 of |K|, stays. It grows as 1/theta^2 as cells are
made thinner, as 1/t^2 with the thickness of walls, and with the ratio of moduli.
Source: Higham, Accuracy and Stability of Numerical Algorithms (2002), 7.2 (componentwise
perturbation).
"""

from __future__ import annotations

import math

import numpy as np

from tyrefrf.errors import SingularError
from tyrefrf.solvers.modes import Pencils
from tyrefrf.solvers.orders import Orders
from tyrefrf.solvers.problem import RingProblem
from tyrefrf.solvers.sparse import solve_sparse

MOST_ORDERS = 4
"""Orders from 0 on that are looked at: the softest motions are theirs."""
MANY = 1e-7
"""Share of the answer that rounding may move before that is worth a word: lines then come near the
residual above which they do not pass."""


def rounding_moves(problem: RingProblem) -> float:
    """What rounding of K's entries moves the static answer by, as a share of it.

    The largest over the first orders, under random loads and random signs of the rounding: 3 to 90
    times the error of a driven section at 0 Hz (tests/solvers/test_digits.py). NaN for a tyre that
    nothing holds; infinite where no digit is left.
    """
    if problem.rigid.count:
        return float("nan")
    pencils, orders = Pencils(problem.cell, problem.n_cells), Orders(problem.cell)
    rng = np.random.default_rng(0)
    size = orders.matrix(orders.folded(np.abs(problem.cell.static)).at(0.0).real)
    moved = 0.0
    for h in range(min(MOST_ORDERS, 1 + problem.n_cells // 2)):
        A = pencils.of(h).K.astype(complex)
        try:
            x = solve_sparse(A, rng.normal(size=(orders.n, 1)).astype(complex))
            rounding = np.finfo(float).eps * (size @ np.abs(x)) * rng.choice([-1.0, 1.0], x.shape)
            e = solve_sparse(A, rounding.astype(complex))
        except SingularError:
            return math.inf
        moved = max(moved, float(np.linalg.norm(e) / np.linalg.norm(x)))
    return moved


def too_few_digits(problem: RingProblem) -> tuple[str, ...]:
    """A warning where rounding alone moves the static answer; what would help."""
    moved = rounding_moves(problem)
    if not MANY < moved < math.inf:
        return ()
    radius = float(problem.cell.points[:, 0].max())
    width = 1e3 * radius * 2.0 * np.pi / problem.n_cells
    return (
        f"rounding alone may move the answer at 0 Hz by {moved:.0e} of it: cells ({width:.3g} "
        "mm around the tread) or walls are too thin, or materials too unlike; a wider "
        "cell.sector_angle, thicker layers, or moduli closer to one another lose fewer digits",
    )
