"""What a run takes against the number of its lines: the fixed cost, and the cost per line.

    python -m benchmarks.lines

`tyrefrf run` from the shell prompt to the last plot, lines evenly from 0 to 2000 Hz, on all cores.
Adaptively, only so many lines are solved as a fit of the others needs.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.command import Outcome, run_case_file
from benchmarks.machine import description, interleaved, table
from benchmarks.tyres import tyres, with_lines, with_solver
from tyrefrf.case import Case
from tyrefrf.study.local import cores

COUNTS = (10, 100, 1000, 2001)
RUNS = (
    ("homogeneous", "recursive", False),
    ("homogeneous", "cyclic", False),
    ("layered", "cyclic", False),
    ("layered", "cyclic", True),
)
"""Tyre, solver, and whether its lines are adaptive. Not here: the layered tyre by the recursion,
whose 2001 lines take more than a minute (`benchmarks.footprint` has them), and adaptive lines of
the homogeneous one (`benchmarks.adaptive`)."""
ROUNDS = 2


def measured(counts: tuple[int, ...] = COUNTS, rounds: int = ROUNDS) -> str:
    """The table, in Markdown."""
    rows = [_row(*run, counts, rounds) for run in RUNS]
    header = ["tyre", "solver", *(f"{count} lines [s]" for count in counts)]
    header += ["fixed [s]", "per line [ms]"]
    head = f"Wall time of `tyrefrf run`, {cores()} processes, shortest of {rounds}. Fixed cost and "
    return f"{head}cost per line: from the fewest and the most lines.\n\n" + table(header, rows)


def _row(tyre: str, solver: str, adaptive: bool, counts: tuple[int, ...], rounds: int) -> list[str]:
    """One tyre by one solver."""
    case = with_solver(tyres()[tyre], solver)
    with TemporaryDirectory() as scratch:
        seconds = interleaved(_runs(case, adaptive, counts, Path(scratch)), rounds, share=0.0)
    known = {count: seconds[str(count)] for count in counts}
    fixed, per_line = line_through(known)
    costs = ["-", "-"] if adaptive else [f"{fixed:.1f}", f"{1e3 * per_line:.2f}"]
    words = f"`{solver}`, adaptive" if adaptive else f"`{solver}`"
    return [tyre, words, *(f"{known[count]:.1f}" for count in counts), *costs]


def _runs(
    case: Case, adaptive: bool, counts: tuple[int, ...], scratch: Path
) -> dict[str, partial[Outcome]]:
    return {
        str(count): partial(run_case_file, with_lines(case, count, adaptive=adaptive), scratch)
        for count in counts
    }


def line_through(seconds: dict[int, float]) -> tuple[float, float]:
    """What no line costs, and what each costs more [s], by the fewest and the most lines."""
    few, many = min(seconds), max(seconds)
    per_line = (seconds[many] - seconds[few]) / (many - few)
    return seconds[few] - few * per_line, per_line


if __name__ == "__main__":
    print(description())
    print(measured())
