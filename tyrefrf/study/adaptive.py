"""Adaptive lines: some are solved, a rational fit gives the others, and its error is stated.

Sampling cannot promise that no narrow resonance stands between the lines it solves. So the natural
frequencies below the last line, which are all there as their number is held against a count by
inertia, say where resonances are too narrow to be left to chance; the lines there are solved. The
lines that are solved do not depend on the workers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.errors import SolveError
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.solvers import RingProblem
from tyrefrf.solvers.modal_loss import modal_loss
from tyrefrf.solvers.modes import OrderModes, Pencils, modes_below, storage_stiffness
from tyrefrf.solvers.own_moduli import RelaxingOrders, own_modes_below
from tyrefrf.study.executor import Executor, Task, Workers, executor_of, map_unordered
from tyrefrf.study.sampling import START, Sampling
from tyrefrf.study.spectrum import (
    UNRECORDED,
    Fit,
    Gathered,
    Progress,
    Record,
    Spectrum,
    solve_lines,
    solve_spectra,
)

if TYPE_CHECKING:
    from tyrefrf.case import Case, Solver

NARROW = 4.0
"""Half-power bandwidth, in spacings of the lines, below which a resonance counts as narrow: fewer
than so many lines stand in it."""
SHARES_PER_JOB = 3
"""Shares of the orders whose modes a process finds at a time: orders are not alike in work."""
FEW = 2 * START
"""Up to so many lines are all solved: a fit would save nothing."""


def solve_case(
    problems: Sequence[RingProblem],
    case: Case,
    workers: Workers,
    progress: Progress = lambda n_lines: None,
    record: Record = UNRECORDED,
) -> list[Spectrum]:
    """Problems at the lines and by the solver of a case, all of them solved or adaptively.

    record: where lines are kept; those that it knows are not solved again.
    """
    frequency = np.array(case.frequency.lines())
    if not case.frequency.adaptive:
        return solve_spectra(problems, case.solver, frequency, workers, progress, record)
    tolerance = case.frequency.tolerance
    return solve_adaptively(problems, case.solver, frequency, tolerance, workers, progress, record)


def solve_adaptively(
    problems: Sequence[RingProblem],
    solver: Solver,
    frequency: FloatArray,
    tolerance: float,
    workers: Workers,
    progress: Progress = lambda n_lines: None,
    record: Record = UNRECORDED,
) -> list[Spectrum]:
    """As `solve_spectra`, but with lines [Hz] fitted where that can be trusted.

    Each problem by itself: its lines are those of a run of it alone. Its first probes have to be
    the driving points of its loads, in their order, whose peaks are what the tolerance is of.
    """
    executor = executor_of(workers, len(frequency) * len(problems))
    gathered = [Gathered.prepared(problem, solver, frequency, executor) for problem in problems]
    samplings = [_sampling(problem, frequency, tolerance, executor) for problem in problems]
    while True:
        wanted = [sampling.next_lines() for sampling in samplings]
        if not any(map(len, wanted)):
            break
        solve_lines(gathered, [lines.tolist() for lines in wanted], executor, progress, record)
        for found, sampling, lines in zip(gathered, samplings, wanted, strict=True):
            if len(lines):
                sampling.add(lines, found.receptance[..., lines])
    progress(sum(int(np.sum(~one.solved)) for one in samplings))
    return [_spectrum(*pair) for pair in zip(gathered, samplings, strict=True)]


def _sampling(
    problem: RingProblem, frequency: FloatArray, tolerance: float, executor: Executor
) -> Sampling:
    """No line yet, but what is known of the problem before the first."""
    first = narrow_lines(problem, frequency, executor) if len(frequency) > FEW else None
    if first is None:
        first = np.arange(len(frequency))
    return Sampling(2.0 * np.pi * frequency, rim_arms(problem), tolerance, first)


def _spectrum(found: Gathered, sampling: Sampling) -> Spectrum:
    """All lines, with the fit where they are not solved."""
    left = np.flatnonzero(~sampling.solved)
    if len(left):
        found.receptance[..., left] = sampling.fitted(left)
    fit = Fit(
        tolerance=sampling.tolerance,
        n_solved=int(np.sum(sampling.solved)),
        n_narrow=len(sampling.first),
        error=sampling.held_back_error,
    )
    return replace(found.spectrum(), fit=fit)


def rim_arms(problem: RingProblem) -> FloatArray:
    """(p,) 0 for a probe of displacements; 1 for the rim's force, the arm [m] for a moment."""
    moves = np.tile(problem.free, problem.n_cells).astype(float)
    sizes = abs(problem.probes[:, : problem.shape[0]])
    largest = sizes.max(axis=0).toarray().ravel()
    return np.where(sizes.T @ moves > 0.0, 0.0, largest)


def narrow_lines(
    problem: RingProblem, frequency: FloatArray, workers: Workers = 1
) -> IntArray | None:
    """Numbers of the lines [Hz] on either side of each narrow resonance.

    Natural frequencies and loss factors are those of the moduli at each mode's own frequency, and
    of the tyre without sensors, whose masses move them little.
    None where they cannot be had, as of a tyre that has buckled.
    """
    executor = executor_of(workers)
    resonances = Resonances(problem.cell, problem.n_cells, 2.0 * np.pi * frequency[-1])
    shares = min(SHARES_PER_JOB * executor.jobs, problem.n_cells // 2 + 1)
    orders: Sequence[int] = range(problem.n_cells // 2 + 1)
    tasks = [Task(resonances, orders[k::shares]) for k in range(shares)]
    found = list(map_unordered(tasks, executor, _unknown))
    if any(part is None for part in found):
        return None
    natural, width = np.hstack([part for part in found if part is not None]) / (2.0 * np.pi)
    after = np.searchsorted(frequency, natural)
    within = (after > 0) & (after < len(frequency)) & (natural > 0.0)
    after, width = after[within], width[within]
    narrow = after[width < NARROW * (frequency[after] - frequency[after - 1])]
    return np.union1d(narrow - 1, narrow)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Resonances:
    """All natural modes of a ring with a frequency below omega [rad/s], some orders at a time."""

    cell: CellMatrices
    n_cells: int
    omega: float

    def __call__(self) -> Callable[[Sequence[int]], FloatArray | None]:
        """What finds those of some orders: omega and half-power bandwidth (2, m) [rad/s].

        None where they cannot be had.
        """
        cell, N, top = self.cell, self.n_cells, self.omega
        if np.array_equal(storage_stiffness(cell, 0.0), storage_stiffness(cell, top)):
            pencils = Pencils(cell, N)
            return partial(self._found, lambda h: modes_below(pencils.of(h), top))
        relaxing = RelaxingOrders(cell, N)
        return partial(self._found, lambda h: own_modes_below(relaxing, h, top))

    def _found(self, find: Callable[[int], OrderModes], orders: Sequence[int]) -> FloatArray | None:
        try:
            modes = [find(h) for h in orders]
        except SolveError:
            return None
        loss = modal_loss(self.cell, self.n_cells, modes, None)
        omega = np.concatenate([order.omega for order in modes])
        return np.stack([omega, omega * np.concatenate([each.loss_factor for each in loss])])


def _unknown(task: Task[Sequence[int], FloatArray | None], reason: str) -> FloatArray | None:
    """What stands for orders whose process dies: nothing."""
    return None
