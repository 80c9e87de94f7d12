"""Adaptive lines: some are solved, a rational fit gives the others, and its error is stated.

Sampling cannot promise that no narrow resonance stands between the lines it solves. So the natural
frequencies below the last line, which are all there as their number is held against a count by
inertia, say where resonances are too narrow to be left to chance; the lines there are solved. The
lines that are solved do not depend on the workers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.errors import SolveError
from tyrefrf.solvers import RingProblem
from tyrefrf.solvers.modal_loss import modal_loss
from tyrefrf.solvers.modes import OrderModes, ring_modes, storage_stiffness
from tyrefrf.solvers.own_moduli import own_ring_modes
from tyrefrf.study.executor import Workers, executor_of
from tyrefrf.study.sampling import START, Sampling
from tyrefrf.study.spectrum import Fit, Gathered, Progress, Spectrum, solve_lines, solve_spectra

if TYPE_CHECKING:
    from tyrefrf.case import Case, Solver

NARROW = 4.0
"""Half-power bandwidth, in spacings of the lines, below which a resonance counts as narrow: fewer
than so many lines stand in it."""
FEW = 2 * START
"""Up to so many lines are all solved: a fit would save nothing."""


def solve_case(
    problems: Sequence[RingProblem],
    case: Case,
    workers: Workers,
    progress: Progress = lambda n_lines: None,
) -> list[Spectrum]:
    """Problems at the lines and by the solver of a case, all of them solved or adaptively."""
    frequency = np.array(case.frequency.lines())
    if not case.frequency.adaptive:
        return solve_spectra(problems, case.solver, frequency, workers, progress)
    tolerance = case.frequency.tolerance
    return solve_adaptively(problems, case.solver, frequency, tolerance, workers, progress)


def solve_adaptively(
    problems: Sequence[RingProblem],
    solver: Solver,
    frequency: FloatArray,
    tolerance: float,
    workers: Workers,
    progress: Progress = lambda n_lines: None,
) -> list[Spectrum]:
    """As `solve_spectra`, but with lines [Hz] fitted where that can be trusted.

    Each problem by itself: its lines are those of a run of it alone. Its first probes have to be
    the driving points of its loads, in their order, whose peaks are what the tolerance is of.
    """
    executor = executor_of(workers, len(frequency) * len(problems))
    gathered = [Gathered.prepared(problem, solver, frequency, executor) for problem in problems]
    samplings = [_sampling(problem, frequency, tolerance) for problem in problems]
    while True:
        wanted = [sampling.next_lines() for sampling in samplings]
        longest = max(map(len, wanted))
        if not longest:
            break
        length = -(-longest // executor.jobs)
        solve_lines(gathered, [lines.tolist() for lines in wanted], length, executor, progress)
        for found, sampling, lines in zip(gathered, samplings, wanted, strict=True):
            if len(lines):
                sampling.add(lines, found.receptance[..., lines])
    progress(sum(int(np.sum(~one.solved)) for one in samplings))
    return [_spectrum(*pair) for pair in zip(gathered, samplings, strict=True)]


def _sampling(problem: RingProblem, frequency: FloatArray, tolerance: float) -> Sampling:
    """No line yet, but what is known of the problem before the first."""
    first = narrow_lines(problem, frequency) if len(frequency) > FEW else None
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


def narrow_lines(problem: RingProblem, frequency: FloatArray) -> IntArray | None:
    """Numbers of the lines [Hz] on either side of each narrow resonance.

    Natural frequencies and loss factors are those of the moduli at each mode's own frequency, and
    of the tyre without sensors, whose masses move them little.
    None where they cannot be had, as of a tyre that has buckled.
    """
    try:
        modes = _modes_below(problem, 2.0 * np.pi * frequency[-1])
    except SolveError:
        return None
    loss = modal_loss(problem.cell, problem.n_cells, modes, None)
    natural = np.concatenate([order.omega for order in modes]) / (2.0 * np.pi)
    width = natural * np.concatenate([order.loss_factor for order in loss])
    after = np.searchsorted(frequency, natural)
    within = (after > 0) & (after < len(frequency)) & (natural > 0.0)
    after, width = after[within], width[within]
    narrow = after[width < NARROW * (frequency[after] - frequency[after - 1])]
    return np.union1d(narrow - 1, narrow)


def _modes_below(problem: RingProblem, omega: float) -> tuple[OrderModes, ...]:
    """All natural modes with a frequency below omega [rad/s]."""
    cell, N = problem.cell, problem.n_cells
    at_rest, at_top = storage_stiffness(cell, 0.0), storage_stiffness(cell, omega)
    if np.array_equal(at_rest, at_top):
        return ring_modes(cell, N, below=omega)
    return own_ring_modes(cell, N, below=omega)
