"""What a run or sweep has left that was ended: the lines in its journal, or in its results file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from tyrefrf.arrays import ComplexArray
from tyrefrf.errors import ResultsError
from tyrefrf.results.file import open_file
from tyrefrf.results.journal import line_of, records_of
from tyrefrf.results.results import MISSING, Results
from tyrefrf.results.run_layout import read_run
from tyrefrf.results.sweep import SweepResults
from tyrefrf.results.sweep_layout import read_sweep
from tyrefrf.solvers import Line, TimedLine

Responses = Results | SweepResults

_READERS: dict[str, Callable[[Any], Responses]] = {"run": read_run, "sweep": read_sweep}


@dataclass(frozen=True, slots=True, eq=False)
class Left:
    """The lines that a run came to, and its results, of which all other lines are missing.

    lines: in the order in which they were solved; a line that failed and was solved later is there
    twice.
    """

    results: Responses
    lines: tuple[TimedLine, ...]

    @property
    def is_complete(self) -> bool:
        """Whether no line is missing, and none failed."""
        return not self.results.n_missing and not self.results.n_failed

    @property
    def answered(self) -> tuple[TimedLine, ...]:
        """The lines that have an answer, each once."""
        return tuple({line.place: line for line in self.lines if line.has_answer}.values())

    @property
    def n_there(self) -> int:
        """How many lines have an answer."""
        return len(self.answered)

    @property
    def n_lines(self) -> int:
        """How many lines there are to solve, of all points."""
        n_points = len(self.results.points) if isinstance(self.results, SweepResults) else 1
        return n_points * len(self.results.frequency)


def read_journal(path: Path) -> Left:
    """What is in a journal. Raises ResultsError for what is none."""
    records = records_of(path)
    image = next(records, None)
    if image is None:
        raise ResultsError(f"{path}: damaged where it begins; --force begins anew")
    with open_file(path, image) as file:
        blank = _READERS[file.attrs["content"]](file)
    lines = tuple(line_of(record, len(blank.loads)) for record in records)
    return Left(_with_lines(blank, lines), lines)


def left_in(results: Responses) -> Left:
    """What is in the results of a run that ended, or that was ended and wrote what it had."""
    points = [results] if isinstance(results, Results) else results.points
    lines = tuple(
        TimedLine(number, int(k), _line_at(point, int(k)), float(point.solve_time[k]))
        for number, point in enumerate(points)
        for k in np.flatnonzero(point.solved)
    )
    return Left(results, lines)


def _line_at(point: Results, k: int) -> Line:
    by_load = np.concatenate([point.receptance[..., k], point.blocked_force[..., k]], axis=1)
    receptance: ComplexArray = np.ascontiguousarray(by_load.T)
    return Line(receptance, float(point.residual[k]), point.remark[k])


def _with_lines(blank: Responses, lines: Sequence[TimedLine]) -> Responses:
    """Results with these lines in their places."""
    if isinstance(blank, Results):
        return _filled(blank, lines)
    of_point: list[list[TimedLine]] = [[] for _ in blank.points]
    for line in lines:
        of_point[line.number].append(line)
    points = map(_filled, blank.points, of_point)
    return replace(blank, points=tuple(points))


def _filled(blank: Results, lines: Sequence[TimedLine]) -> Results:
    receptance, blocked_force = blank.receptance.copy(), blank.blocked_force.copy()
    residual, solve_time = blank.residual.copy(), blank.solve_time.copy()
    remark = [MISSING] * len(blank.remark)
    n_probes = len(blank.probes)
    for done in lines:
        k, H = done.index, done.line.receptance
        receptance[..., k], blocked_force[..., k] = H[:n_probes].T, H[n_probes:].T
        residual[k], solve_time[k], remark[k] = done.line.residual, done.seconds, done.line.remark
    return replace(
        blank,
        receptance=receptance,
        blocked_force=blocked_force,
        solved=~np.isnan(residual),
        residual=residual,
        solve_time=solve_time,
        remark=tuple(remark),
    )
