"""Frequency lines of one or several problems: chunks over the cores, recorded and gathered."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Protocol

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.solvers import Maker, RingProblem, TimedLine, answer, no_answer, prepare
from tyrefrf.solvers import Solver as RingSolver
from tyrefrf.study.executor import Executor, Task, Workers, executor_of, map_unordered

if TYPE_CHECKING:
    from tyrefrf.case import Solver
    from tyrefrf.results import Results, SweepResults

SOON = 0.2
"""Seconds that a chunk of lines takes: so long after it is solved, a line is recorded, and so far
apart the cores finish. A chunk's way to a process and back takes a millisecond."""
LONGEST_CHUNK = 64  # lines

Progress = Callable[[int], None]
"""Called with the number of lines just finished."""


class Record(Protocol):
    """Where lines are kept as they are solved: a journal, or nowhere (`Unrecorded`).

    known: lines that are solved already, by problem and index.
    """

    @property
    def known(self) -> Mapping[tuple[int, int], TimedLine]:
        """See above."""
        ...

    def begin(self, blank: Results | SweepResults) -> None:
        """Called before the first line, with the results without any."""
        ...

    def add(self, lines: Sequence[TimedLine]) -> None:
        """Called with lines just solved, or failed, in the process that gathers them."""
        ...


class Unrecorded:
    """Lines are not kept but in the results."""

    known: Mapping[tuple[int, int], TimedLine] = MappingProxyType({})

    def begin(self, blank: Results | SweepResults) -> None:
        """Nothing begins."""

    def add(self, lines: Sequence[TimedLine]) -> None:
        """Nothing is kept."""


UNRECORDED = Unrecorded()


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
    record: Record = UNRECORDED,
) -> list[Spectrum]:
    """The same for several problems at the same lines, in their order.

    One pool works at all of them: no process waits for a problem's last line. record: where lines
    are kept; those that it knows are not solved again.
    """
    every = range(len(frequency))
    executor = executor_of(workers, len(frequency) * len(problems))
    gathered = [
        Gathered.prepared(problem, solver, frequency, executor)
        if any((number, index) not in record.known for index in every)
        else Gathered(problem, _unneeded, frequency, 0.0)
        for number, problem in enumerate(problems)
    ]
    solve_lines(gathered, [every] * len(problems), executor, progress, record)
    return [found.spectrum() for found in gathered]


def _unneeded() -> RingSolver:
    raise AssertionError("all lines were known")


def solve_lines(
    gathered: Sequence[Gathered],
    lines: Sequence[Sequence[int]],
    executor: Executor,
    progress: Progress,
    record: Record,
) -> None:
    """Solve some lines of each problem and gather them; those that are known are only gathered."""
    left = [
        found.still_left(number, wanted, record.known)
        for number, (found, wanted) in enumerate(zip(gathered, lines, strict=True))
    ]
    longest = -(-max(map(len, left)) // executor.jobs)
    paces = [Pace(longest, found.seconds) for found in gathered]
    tasks = (
        Task(found.lines, Chunk(number, lines))
        for number, (found, pace) in enumerate(zip(gathered, paces, strict=True))
        for lines in pace.chunks(left[number])
    )
    for solved in map_unordered(tasks, executor, _failed, _by_line):
        record.add(solved)
        for done in solved:
            gathered[done.number].add(done)
        paces[solved[0].number].learn(done.seconds for done in solved)
        progress(len(solved))


class Pace:
    """How many lines make a chunk: as many as are solved soon, as far as is known so far.

    longest: lines of a chunk, whatever they take. seconds: what lines have taken, NaN for others.
    """

    def __init__(self, longest: int, seconds: FloatArray) -> None:
        self._longest = max(1, min(longest, LONGEST_CHUNK))
        self._length = 1
        self.learn(seconds[~np.isnan(seconds)])

    def chunks(self, lines: Sequence[int]) -> Iterator[Sequence[int]]:
        """The lines in chunks, each as long as is thought right when it is asked for."""
        start = 0
        while start < len(lines):
            end = start + self._length
            yield lines[start:end]
            start = end

    def learn(self, seconds: Iterable[float]) -> None:
        """Take what lines have taken for what others are going to take."""
        took = [each for each in seconds if each > 0.0]
        if took:
            self._length = min(max(1, round(SOON * len(took) / sum(took))), self._longest)


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

    def still_left(
        self, number: int, wanted: Sequence[int], known: Mapping[tuple[int, int], TimedLine]
    ) -> list[int]:
        """The lines that are still to be solved, once those that are known are in their places."""
        for index in wanted:
            if (number, index) in known:
                self.add(known[number, index])
        return [index for index in wanted if (number, index) not in known]

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
