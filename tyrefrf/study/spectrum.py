"""Frequency lines of one or several problems: chunks over the cores, gathered into arrays."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.solvers import Line, Maker, RingProblem, answer, no_answer, prepare
from tyrefrf.solvers import Solver as RingSolver
from tyrefrf.study.executor import Executor, Task, Workers, executor_of, map_unordered

if TYPE_CHECKING:
    from tyrefrf.case import Solver

CHUNKS_PER_JOB = 8  # both cores finish together to within an eighth
CHUNKS_PER_JOB_IN_ALL = 64  # of many problems: a chunk need not be shorter than that
LONGEST_CHUNK = 64  # lines: a chunk is also how often progress is shown

Progress = Callable[[int], None]
"""Called with the number of lines just finished."""


@dataclass(frozen=True, slots=True, eq=False)
class Spectrum:
    """All lines of a problem.

    receptance: (n_probes, n_loads, f) [m/N], NaN where a line failed. residual: (f,).
    solve_time: (f,) [s]. remark: f texts, "" or what was special, or why the line failed.
    prepare_time: what the solver took before the first line [s]; a modal one's modes.
    fit: how the lines that were not solved were fitted; None where all had to be solved. A fitted
    line has its receptance, and NaN for residual and solve_time.
    """

    receptance: ComplexArray
    residual: FloatArray
    solve_time: FloatArray
    remark: tuple[str, ...]
    prepare_time: float
    fit: Fit | None = None


@dataclass(frozen=True, slots=True)
class Fit:
    """What became of adaptive lines.

    tolerance: of the driving points' peaks. n_solved: lines that were solved. n_narrow: lines at
    resonances that are too narrow to be left to the fit. error: the worst on the last lines that
    were predicted before they were solved; NaN where none was.
    """

    tolerance: float
    n_solved: int
    n_narrow: int
    error: float


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Lines:
    """All lines [Hz] of one problem: a process is given this once, and makes the solver once."""

    problem: RingProblem
    make_solver: Maker
    frequency: FloatArray

    def __call__(self) -> Callable[[Chunk], list[TimedLine]]:
        """What solves some of them."""
        return partial(_solve_chunk, self, self.make_solver())


@dataclass(frozen=True, slots=True)
class Chunk:
    """Some lines of a problem, by their numbers: what a process is given at a time."""

    number: int
    lines: Sequence[int]


@dataclass(frozen=True, slots=True, eq=False)
class TimedLine:
    """One line's answer, where it belongs, and what it took [s]."""

    number: int
    index: int
    line: Line
    seconds: float


def solve_spectrum(
    problem: RingProblem,
    solver: Solver,
    frequency: FloatArray,
    workers: Workers,
    progress: Progress = lambda n_lines: None,
) -> Spectrum:
    """Solve every frequency line [Hz] by the solver that the case chose.

    The answer does not depend on the workers. A line without an answer is NaN with its reason; so
    is one that kills its process twice.
    Raises SolveError where no line could be solved: too little memory, a library that is missing.
    """
    return solve_spectra([problem], solver, frequency, workers, progress)[0]


def solve_spectra(
    problems: Sequence[RingProblem],
    solver: Solver,
    frequency: FloatArray,
    workers: Workers,
    progress: Progress = lambda n_lines: None,
) -> list[Spectrum]:
    """The same for several problems at the same lines, in their order.

    One pool works at all of them: no process waits for a problem's last line.
    """
    n = len(frequency)
    executor = executor_of(workers, n * len(problems))
    gathered = [Gathered.prepared(problem, solver, frequency, executor) for problem in problems]
    length = _chunk_length(n, len(problems), executor.jobs)
    solve_lines(gathered, [range(n)] * len(problems), length, executor, progress)
    return [found.spectrum() for found in gathered]


def solve_lines(
    gathered: Sequence[Gathered],
    lines: Sequence[Sequence[int]],
    length: int,
    executor: Executor,
    progress: Progress,
) -> None:
    """Solve some lines of each problem and gather them; a process gets `length` of them at once."""
    tasks = (
        Task(found.lines, Chunk(number, wanted[i : i + length]))
        for number, (found, wanted) in enumerate(zip(gathered, lines, strict=True))
        for i in range(0, len(wanted), length)
    )
    for solved in map_unordered(tasks, executor, _failed, _by_line):
        for done in solved:
            gathered[done.number].add(done)
        progress(len(solved))


def _chunk_length(n_lines: int, n_problems: int, jobs: int) -> int:
    """Lines in a chunk: short enough that the cores finish together, and not shorter."""
    of_one = -(-n_lines // (CHUNKS_PER_JOB * jobs))
    of_all = n_lines * n_problems // (CHUNKS_PER_JOB_IN_ALL * jobs)
    return min(max(of_one, of_all), n_lines, LONGEST_CHUNK)


class Gathered:
    """A problem's lines as they come; NaN where none has."""

    def __init__(
        self, problem: RingProblem, make_solver: Maker, frequency: FloatArray, prepare_time: float
    ) -> None:
        self.lines = Lines(problem, make_solver, frequency)
        self.prepare_time = prepare_time
        n_lines = len(frequency)
        self.receptance = np.full((*problem.shape, n_lines), complex(np.nan, np.nan))
        self.residual, self.seconds = np.full(n_lines, np.nan), np.full(n_lines, np.nan)
        self.remark = [""] * n_lines

    @classmethod
    def prepared(
        cls, problem: RingProblem, solver: Solver, frequency: FloatArray, executor: Executor
    ) -> Gathered:
        """No line yet, but all that the solver does before the first."""
        begun = time.perf_counter()
        make = prepare(problem, solver, executor.here)
        return cls(problem, make, frequency, time.perf_counter() - begun)

    def add(self, done: TimedLine) -> None:
        """Put a line in its place."""
        self.receptance[..., done.index] = done.line.receptance
        self.residual[done.index] = done.line.residual
        self.seconds[done.index] = done.seconds
        self.remark[done.index] = done.line.remark

    def spectrum(self) -> Spectrum:
        """All lines."""
        return Spectrum(
            self.receptance, self.residual, self.seconds, tuple(self.remark), self.prepare_time
        )


def _solve_chunk(of: Lines, solver: RingSolver, chunk: Chunk) -> list[TimedLine]:
    """Solve some lines; one that fails is data."""
    solved = []
    for index in chunk.lines:
        start = time.perf_counter()
        line = answer(of.problem, solver, 2.0 * np.pi * float(of.frequency[index]))
        solved.append(TimedLine(chunk.number, index, line, time.perf_counter() - start))
    return solved


def _by_line(task: Task[Chunk, list[TimedLine]]) -> list[Task[Chunk, list[TimedLine]]]:
    """The lines of a chunk whose process died: one of them may be to blame, or none."""
    return [Task(task.make, Chunk(task.item.number, [index])) for index in task.item.lines]


def _failed(task: Task[Chunk, list[TimedLine]], reason: str) -> list[TimedLine]:
    """What stands for lines that kill their process; the time they took counts as nothing."""
    of = task.make
    assert isinstance(of, Lines)
    return [
        TimedLine(
            task.item.number,
            index,
            no_answer(of.problem, f"{of.frequency[index]:.6g} Hz: {reason}"),
            0.0,
        )
        for index in task.item.lines
    ]
