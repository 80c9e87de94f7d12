"""What the command line makes of a case file, in this process and in a directory of its own."""

from __future__ import annotations

import json
import re
import shutil
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tyrefrf import load_results
from tyrefrf.case import Case, load_case
from tyrefrf.case.bounds import section_elements
from tyrefrf.errors import CaseError

from ..command import Done, command_here
from .bases import lay_out
from .spoil import CASE, Spoilt

PLACED = re.compile(rf"(sweep of )?{re.escape(CASE)}:[1-9][0-9]*: \S")
"""How a problem begins that has a place in the file."""
LARGEST = 2e7
"""Lines times dofs of the ring times loads, about, up to which a case is solved here."""
REFUSED, ANSWERED, PARTLY = "refused with a line", "results", "results but for lines"
NO_ANSWER, TOO_LARGE = "no answer, with a reason", "too large to be solved here"
KINDS = (REFUSED, ANSWERED, PARTLY, NO_ANSWER, TOO_LARGE)
NO_LINE, TRACEBACK, HANG = "refused without a line", "traceback", "hang"
ELSEWHERE, WRONG = "written elsewhere", "wrong results"
ELSE = (NO_LINE, TRACEBACK, HANG, ELSEWHERE, WRONG)
"""Outcomes that there must not be."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a case: one of `KINDS` or `ELSE`, the words for it, and the CPU time [s]."""

    kind: str
    words: str
    seconds: float


class Sandbox:
    """A directory with the files that the cases name, and beside it nothing that may change."""

    def __init__(self, directory: Path) -> None:
        self.outside, self.box = directory, directory / "box"
        self.box.mkdir(parents=True)
        lay_out(self.box)
        (directory / "beside.txt").write_text("as it was")
        self._before = self._tree()

    def outcome(self, spoilt: Spoilt) -> Outcome:
        """Run the command on the case."""
        file = self.box / spoilt.file
        whole = file.read_bytes() if file.exists() else b""
        (self.box / CASE).write_bytes(spoilt.case)
        file.write_bytes(spoilt.data)
        shutil.rmtree(self.box / "results", ignore_errors=True)
        start = time.process_time()
        kind, words = _Trial(self.box).outcome(spoilt.command)
        seconds = time.process_time() - start
        file.write_bytes(whole)
        after = self._tree()
        if kind not in ELSE and after != self._before:
            kind, words = ELSEWHERE, ", ".join(sorted(after.keys() ^ self._before.keys()))
        return Outcome(kind, words, seconds)

    def _tree(self) -> dict[str, bytes | None]:
        """Everything outside of the directories for results, with what is in it."""
        results = self.box / "results"
        return {
            str(path): path.read_bytes() if path.is_file() else None
            for path in self.outside.rglob("*")
            if path != results and results not in path.parents and path.name != CASE
        }


class _Trial:
    """The case of a box, given to a command."""

    def __init__(self, box: Path) -> None:
        self.box = box
        try:
            self.case: Case | None = load_case(box / CASE)
        except CaseError:
            self.case = None

    def outcome(self, command: str) -> tuple[str, str]:
        """What becomes of it, and the words for it."""
        if command not in ("check", "modes") and self.case and _work(self.case) > LARGEST:
            kind, words = _judged(self._done("check", CASE))
            return (TOO_LARGE, words) if kind == ANSWERED else (kind, words)
        done = self._done(*self._words(command))
        if command == "export" and done.status == 0:
            file = json.loads(done.stdout)["files"][0]
            done = self._done("export", file, "--to", "csv,mat,uff58", "--force")
            done = self._done("info", file) if done.status == 0 else done
        kind, words = _judged(done)
        if command == "run" and kind == ANSWERED and (wrong := _wrong(self.box)):
            return WRONG, wrong
        return kind, words

    def _words(self, command: str) -> list[str]:
        """The command line."""
        if command == "export":
            return ["run", CASE, "--json", "--jobs", "1"]
        if command == "sweep":
            swept = list(self.case.sweep)[:1] if self.case else []
            values = [f"--param={name}" for name in swept] or ["--param", "sector_angle=24,36"]
            return [command, CASE, "--jobs", "1", *values]
        more = {
            "run": ["--jobs", "1"],
            "dispersion": ["--jobs", "1", "--lines", "2"],
            "modes": ["--count", "20"],
        }
        return [command, CASE, *more.get(command, [])]

    def _done(self, *words: str) -> Done:
        return command_here(*words, cwd=self.box)


def _work(case: Case) -> float:
    """How much a case would have to solve, roughly."""
    section = 4.0 * section_elements(case) or 100.0
    if case.cell.element.startswith("hex20"):
        section *= 3.0
    dofs = 3.0 * section * case.cell.elements_around * case.cell.n_cells
    lines = 3.0 + len(case.frequency.lines()) + len(case.output.deflections)
    columns = len(case.loads) + len(case.probes) / 3.0
    swept = list(case.sweep.values())[:1]
    points = sum(len(v) if isinstance(v, tuple) else v.count for v in swept) or 1
    return dofs * lines * columns * (1.0 + section / 300.0) * points / 3.0


def _judged(done: Done) -> tuple[str, str]:
    if isinstance(done.status, str):
        return TRACEBACK, done.status
    lines = [line for line in done.stderr.splitlines() if not _is_said_on_the_way(line)]
    words = "\n".join(lines)
    if done.status == 2:
        return REFUSED if lines and all(map(PLACED.match, lines)) else NO_LINE, words
    if done.status == 1 and not done.stdout.strip():
        return NO_ANSWER if lines else TRACEBACK, words
    if done.status == 1:
        return PARTLY, words
    return (ANSWERED, "") if done.status == 0 else (TRACEBACK, f"status {done.status}\n{words}")


def _is_said_on_the_way(line: str) -> bool:
    return bool(re.search(r"lines/s, .* s left$", line)) or line.startswith("warning: ")


def _wrong(box: Path) -> str:
    """What is wrong with the file of a run that calls itself complete."""
    [file] = (box / "results").glob("*/*.h5")
    results = load_results(file)
    if not all(np.isfinite(array).all() for array in (results.receptance, results.blocked_force)):
        return "a complete run with NaN in it"
    if not np.all(results.solved) and "solved_lines" not in results.provenance.numbers:
        return "a line that was not solved, and no word of it"
    return ""
