"""Runs that are killed at random moments, and what becomes of their lines.

Every run is killed, gone on with, and killed again until it ends; then its results are held
against those of a run that nobody killed, to the bit.
"""

from __future__ import annotations

import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import tyrefrf
from tyrefrf.errors import ResultsError
from tyrefrf.results import Results, load_any
from tyrefrf.results.journal import records_of

from ..killed import heeding, workers_of
from ..small import text_with
from .rows import Row, lost_of

PART = "Killed"
SAME = ("frequency", "mobility", "residual", "blocked_force", "solved")
LINES = ("values = [0.0, 40.0, 150.0, 420.0]", "stop = 420.0\ncount = 1201")
ADAPTIVE = ("values = [0.0, 40.0, 150.0, 420.0]", "stop = 420.0\ncount = 2401\nadaptive = true")
FINE = ("elements_along = 8", "elements_along = 16")

KINDS = {
    "a run": (text_with(LINES, FINE), "run", ()),
    "adaptive lines": (text_with(ADAPTIVE, FINE), "run", ()),
    "a sweep of two points": (
        text_with(LINES),
        "sweep",
        ("--param", "E_rubber", "--values", "40,80 MPa"),
    ),
}
"""What is killed: case, command, and its arguments."""

Tyre = Results | tyrefrf.SweepResults


@dataclass
class Found:
    """What was found of one kind of kill."""

    times: int = 0
    losses: list[str] = field(default_factory=list)
    ends: Counter[str] = field(default_factory=Counter)

    def add(self, status: int, err: str, expected: int, words: str) -> None:
        """Count a refusal: its status, and words that are to be in what was said."""
        self.times += 1
        if status != expected or words not in err or "Traceback" in err:
            self.losses.append(f"status {status}: {err.strip()[-200:]}")
        first = re.sub(r"out\d+/", "", (err.splitlines() or ["nothing"])[0])
        self.ends[f"`{re.sub(r'process .*', 'process n', first)}` ({status})"] += 1

    def row(self, fault: str) -> Row:
        """The table's row."""
        seen = ", ".join(f"{what}: {n}" for what, n in self.ends.most_common())
        return Row(PART, fault, self.times, lost_of(self.losses), seen)


class Killing:
    """Runs of one kind in a directory, killed at moments spread over how long they take."""

    def __init__(self, kind: str, directory: Path, seed: int) -> None:
        text, self.command, self.arguments = KINDS[kind]
        self.directory, self.random = directory, random.Random(seed)
        (directory / "tyre.toml").write_text(text)
        begun = time.monotonic()
        done = self.start("whole", "--force").wait()
        assert done == 0
        self.seconds = time.monotonic() - begun
        self.expected = load_any(self.target("whole"))
        self.number = 0

    def target(self, output: str) -> Path:
        """Where the results of an output are."""
        stem = "tyre" if self.command == "run" else "tyre_sweep"
        return self.directory / output / f"{stem}.h5"

    def start(self, output: str, *more: str) -> subprocess.Popen[str]:
        """Begin the command."""
        command = [self.command, "tyre.toml", *self.arguments, "--output", output, *more]
        return subprocess.Popen(
            [sys.executable, "-m", "tyrefrf", *command],
            cwd=self.directory,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            preexec_fn=heeding,
        )

    def times(self, n: int, number: int, *, worker: bool = False) -> Found:
        """So many signals of one kind, to the run or to one of its workers."""
        found = Found()
        while found.times < n:
            self.number += 1
            self._until_it_ends(f"out{self.number}", number, found, n, worker=worker)
        return found

    def _until_it_ends(
        self, output: str, number: int, found: Found, most: int, *, worker: bool
    ) -> None:
        """Kill a run, go on with it, kill that, ... and compare in the end."""
        target = self.target(output)
        while True:
            process = self.start(output, "--resume")
            killed = found.times < most and self._killed(process, number, target, found, worker)
            _, err = process.communicate()
            if "Traceback" in err:
                found.losses.append(f"a traceback: {err.strip().splitlines()[-1]}")
                print(err)
            if process.returncode == 0:
                self.compare(target, found)
                return
            if not killed or worker:
                found.losses.append(f"status {process.returncode}: {err.strip()[-200:]}")
                return
            found.ends[_end_of(err, process.returncode)] += 1

    def _killed(
        self, process: subprocess.Popen[str], number: int, target: Path, found: Found, worker: bool
    ) -> bool:
        """Send the signal at some moment; whether the run was still there then."""
        with suppress(subprocess.TimeoutExpired):
            process.wait(self.random.uniform(0.0, 1.1 * self.seconds))
            return False
        before = lines_at(target)
        pids = workers_of(process.pid) if worker else [process.pid]
        if not pids:
            return True
        with suppress(ProcessLookupError):
            os.kill(self.random.choice(pids), number)
        found.times += 1
        if worker:
            found.ends["the run went on and ended well"] += 1
            return True
        process.wait()
        after = lines_at(target)
        if not before <= after:
            found.losses.append(f"{len(before - after)} lines that were there before")
        self._look(target, found)
        return True

    def _look(self, target: Path, found: Found) -> None:
        """What `info` and `plot` would read: whole, or not there."""
        journal = target.with_suffix(".journal")
        if not target.exists() and not journal.exists():
            return
        try:
            load_any(target)
        except ResultsError as error:
            found.losses.append(f"what was there cannot be read: {error}")

    def compare(self, target: Path, found: Found) -> None:
        """Hold results against those of the run that nobody ended."""
        results = load_any(target)
        pairs = zip(points_of(results), points_of(self.expected), strict=True)
        for one, other in pairs:
            for name in SAME:
                if not np.array_equal(
                    getattr(one, name), getattr(other, name), equal_nan=name != "solved"
                ):
                    found.losses.append(f"other digits in {name}")
        there = {path.name for path in target.parent.iterdir()}
        left = there - {target.name, f".{target.name}.lock", "plots"}
        if left:
            found.losses.append(f"left behind: {', '.join(sorted(left))}")


def begun_twice(times: int) -> Row:
    """A second run to the same output while the first is under way."""
    found = Found()
    with tempfile.TemporaryDirectory() as name:
        killing = Killing("a run", Path(name), 0)
        while found.times < times:
            killing.number += 1
            output = f"out{killing.number}"
            target = killing.target(output)
            first = killing.start(output)
            while not lines_at(target) and first.poll() is None:
                time.sleep(0.01)
            for more in ("--resume", "--force"):
                second = killing.start(output, more)
                _, err = second.communicate()
                found.add(second.returncode, err, 2, "is being written by process")
            _, err = first.communicate()
            if first.returncode:
                found.losses.append(f"the first: {err.strip()[-200:]}")
            killing.compare(target, found)
    return found.row("a second run to the same output, `--resume` and `--force`")


def another_case(times: int) -> Row:
    """Going on with what was begun with another case."""
    found = Found()
    with tempfile.TemporaryDirectory() as name:
        killing = Killing("a run", Path(name), 0)
        case = killing.directory / "tyre.toml"
        text = case.read_text()
        for k in range(times):
            output = f"out{k}"
            first = killing.start(output)
            while not lines_at(killing.target(output)) and first.poll() is None:
                time.sleep(0.01)
            first.kill()
            first.communicate()
            before = lines_at(killing.target(output))
            case.write_text(text.replace("rho = 1200.0", f"rho = {1100 + k}.0"))
            second = killing.start(output, "--resume")
            _, err = second.communicate()
            case.write_text(text)
            found.add(second.returncode, err, 2, f"rho: 1200.0 -> {1100 + k}.0")
            if lines_at(killing.target(output)) != before:
                found.losses.append("lines that were there before")
            if killing.start(output, "--resume").wait() != 0:
                found.losses.append("the case as it was does not go on")
            killing.compare(killing.target(output), found)
    return found.row("`--resume` with another case than the one that was killed")


def points_of(results: object) -> tuple[Results, ...]:
    """A run, or the points of a sweep."""
    return (results,) if isinstance(results, Results) else results.points


def lines_at(target: Path) -> set[bytes]:
    """The lines that are on disk: their records, or, once the results are whole, all of them."""
    journal = target.with_suffix(".journal")
    if target.exists() and not journal.exists():
        return Everything()
    try:
        return set(list(records_of(journal))[1:])
    except ResultsError:
        return Everything() if target.exists() else set()


class Everything(set):
    """Has every line."""

    def __le__(self, other: object) -> bool:
        return isinstance(other, Everything)

    def __ge__(self, other: object) -> bool:
        return True


def _end_of(err: str, status: int) -> str:
    """What the user saw as the run was ended."""
    if status == -signal.SIGKILL:
        return "killed"
    said = re.sub(r"\d+ of", "n of", (err.strip().splitlines() or ["nothing"])[-1])
    return f"`{re.sub(r'out[0-9]+/', '', said)}` ({status})"


def rows(n_kills: int, seed: int) -> Iterator[Row]:
    """Every kind of run by every kind of end; `n_kills` kill -9 of the main process in all."""
    yield begun_twice(10)
    yield another_case(10)
    shares = dict(zip(KINDS, (0.5, 0.3, 0.2), strict=True))
    for kind, share in shares.items():
        with tempfile.TemporaryDirectory() as directory:
            killing = Killing(kind, Path(directory), seed)
            times = max(1, round(share * n_kills))
            yield killing.times(times, signal.SIGKILL).row(f"`kill -9` of {kind}")
            others = max(1, times // 3)
            for number in (signal.SIGTERM, signal.SIGINT):
                yield killing.times(others, number).row(f"{number.name} to {kind}")
            workers = killing.times(others, signal.SIGKILL, worker=True)
            yield workers.row(f"`kill -9` of a worker of {kind}")
