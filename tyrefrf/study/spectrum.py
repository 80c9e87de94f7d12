"""The frequency sweep: chunks of lines over the cores, gathered into arrays."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.errors import SolveError
from tyrefrf.solvers import SOLVERS, Line, RingProblem, solve_line
from tyrefrf.study.executor import map_unordered

CHUNKS_PER_JOB = 8  # both cores finish together to within an eighth, and start-up is paid once
LONGEST_CHUNK = 64  # lines: a chunk is also how often progress is shown

Progress = Callable[[int], None]
"""Called with the number of lines just finished."""


@dataclass(frozen=True, slots=True, eq=False)
class Spectrum:
    """All lines of a problem.

    receptance: (n_probes, n_loads, f) [m/N], NaN where a line failed. residual: (f,).
    solve_time: (f,) [s]. remark: f texts, "" or what was special, or why the line failed.
    """

    receptance: ComplexArray
    residual: FloatArray
    solve_time: FloatArray
    remark: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class TimedLine:
    """One line's answer, where it belongs, and what it took [s]."""

    index: int
    line: Line
    seconds: float


def solve_spectrum(
    problem: RingProblem,
    solver: str,
    frequency: FloatArray,
    jobs: int,
    progress: Progress = lambda n_lines: None,
) -> Spectrum:
    """Solve every frequency line [Hz] by the solver of that name in `SOLVERS`.

    The answer does not depend on `jobs`. A line without an answer is NaN with its reason.
    """
    n = len(frequency)
    length = int(np.clip(-(-n // (CHUNKS_PER_JOB * jobs)), 1, LONGEST_CHUNK))
    chunks = [range(start, min(start + length, n)) for start in range(0, n, length)]
    work = partial(_solve_chunk, problem, solver, frequency)

    shape = (problem.probes.shape[1], problem.n_loads, n)
    receptance = np.full(shape, complex(np.nan, np.nan))
    residual, seconds = np.full(n, np.nan), np.full(n, np.nan)
    remark = [""] * n
    for lines in map_unordered(work, chunks, jobs):
        for done in lines:
            receptance[..., done.index] = done.line.receptance
            residual[done.index] = done.line.residual
            seconds[done.index] = done.seconds
            remark[done.index] = done.line.remark
        progress(len(lines))
    return Spectrum(receptance, residual, seconds, tuple(remark))


def _solve_chunk(
    problem: RingProblem, solver_name: str, frequency: FloatArray, chunk: range
) -> list[TimedLine]:
    """Solve some lines; one that fails is data."""
    solver = SOLVERS[solver_name](problem)
    lines = []
    for index in chunk:
        start = time.perf_counter()
        try:
            line = solve_line(problem, solver, 2.0 * np.pi * float(frequency[index]))
        except SolveError as error:
            line = _failed(problem, str(error))
        lines.append(TimedLine(index, line, time.perf_counter() - start))
    return lines


def _failed(problem: RingProblem, reason: str) -> Line:
    """A line without an answer."""
    nowhere = np.full((problem.probes.shape[1], problem.n_loads), complex(np.nan, np.nan))
    return Line(nowhere, float("nan"), reason)
