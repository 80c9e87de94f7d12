"""The memory that a study says it needs, beside what it takes at its peak.

    python -m tests.faults.memory
    python -m tests.faults.memory --json

Prints a row for each of some studies, of every solver and command, with what is largest in each:
cells, elements in a cell, loads, lines and probes. Exits 1 where an estimate is below 0.9 or above
1.5 of what was taken. What a command takes is looked at from outside (`benchmarks.command`): the
high-water mark of a process alone, the proportional sizes of several at one moment.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.command import command
from tyrefrf.case import Case, make_grid, parse_case
from tyrefrf.study.choose import with_solver
from tyrefrf.study.compare import with_lines
from tyrefrf.study.memory import (
    Need,
    need_of_cell,
    need_of_comparison,
    need_of_deflections,
    need_of_modes,
    need_of_run,
    need_of_waves,
)
from tyrefrf.study.model import Workshop, build_model

LEAST, MOST = 0.9, 1.5


@dataclass(frozen=True, slots=True)
class Tyre:
    """A tyre of rubber: its sizes, loads, points and lines, and how it is solved."""

    along: int = 28
    through: int = 1
    angle: float = 8.0
    around: int = 1
    element: str = "hex8i"
    loads: int = 2
    points: int = 5
    lines: int = 3
    solver: str = 'name = "recursive"'
    more: str = ""

    @property
    def text(self) -> str:
        """Its case."""
        loads = "".join(
            f'[[loads]]\nname = "l{k}"\ns = {0.2 + 0.6 * k / self.loads:.6f}\n'
            f'angle = {37 * k % 360}\ndirection = "r"\n'
            for k in range(self.loads)
        )
        along = max(1, self.points // 50)
        return f"""\
geometry = {{ elements_along = {self.along}, elements_through = {self.through}, material = "r" }}
materials.r = {{ E = "80 MPa", nu = 0.42, rho = 1200, eta = 0.1 }}
cell.sector_angle = {self.angle}
cell.elements_around = {self.around}
cell.element = "{self.element}"
frequency = {{ start = 100, stop = 500, count = {self.lines} }}
solver = {{ {self.solver} }}
{self.more}
[[probes]]
name = "points"
kind = "region"
s = [0.1, 0.9]
direction = "r"
count = [{along}, {self.points // along}]
{loads}"""


@dataclass(frozen=True, slots=True)
class Study:
    """A tyre, the command that it is given to, and what that needs."""

    tyre: Tyre
    command: str = "run"
    options: tuple[str, ...] = ("--jobs", "1")
    jobs: int = 1
    need: Callable[[Case, int], Need] = field(
        default=lambda case, jobs: need_of_run(case, [build_model(case).problem], jobs)
    )

    @property
    def words(self) -> str:
        """What it is."""
        plain = Tyre()
        said = [
            f"{name} {getattr(self.tyre, name)}"
            for name in (
                "along",
                "through",
                "angle",
                "around",
                "element",
                "loads",
                "points",
                "lines",
            )
            if getattr(self.tyre, name) != getattr(plain, name)
        ]
        return ", ".join([f"{self.command} ({self.tyre.solver}, {self.jobs} job(s))", *said])


def _of_sweep(case: Case, jobs: int) -> Need:
    grid = make_grid(case, {"E_r": None})
    problems = [model.problem for model in grid.each(Workshop().model)]
    return need_of_run(case, problems, jobs)


def _of_deflections(case: Case, jobs: int) -> Need:
    return need_of_deflections(case, build_model(case).problem)


def _of_modes(case: Case, jobs: int) -> Need:
    return need_of_modes(build_model(case).problem, 1000)


def _of_waves(case: Case, jobs: int) -> Need:
    return need_of_waves(build_model(case).problem, jobs)


def _of_comparison(case: Case, jobs: int) -> Need:
    solvers = [with_solver(case, name).solver for name in ("cyclic", "direct")]
    return need_of_comparison(with_lines(case, 3), build_model(case).problem, solvers)


CYCLIC, DIRECT, MODAL = (f'name = "{name}"' for name in ("cyclic", "direct", "modal"))
NONE_DRAWN = "output = { plots = [] }"
TWO = ("--jobs", "2")
STUDIES = (
    Study(Tyre()),
    Study(Tyre(lines=6), options=TWO, jobs=2),
    Study(Tyre(along=100, through=2, lines=2)),
    Study(Tyre(along=100, through=2, lines=4), options=TWO, jobs=2),
    Study(Tyre(angle=0.5, lines=2)),
    Study(Tyre(angle=0.5, loads=10, lines=2)),
    Study(Tyre(angle=24, through=2, around=8, lines=2)),
    Study(Tyre(angle=0.5, loads=10, lines=2, solver=CYCLIC)),
    Study(Tyre(angle=24, along=100, through=4, around=8, lines=2, solver=CYCLIC)),
    Study(Tyre(angle=24, element="hex20", around=6, lines=2, solver=CYCLIC)),
    Study(Tyre(along=60, through=2, lines=2, solver=DIRECT)),
    Study(Tyre(along=60, through=2, lines=4, solver=DIRECT), options=TWO, jobs=2),
    Study(Tyre(along=60, through=2, lines=2, solver=MODAL)),
    Study(Tyre(along=8, angle=24, points=2000, lines=600, solver=CYCLIC, more=NONE_DRAWN)),
    Study(Tyre(along=8, angle=24, loads=20, points=500, lines=200, solver=CYCLIC, more=NONE_DRAWN)),
    Study(
        Tyre(along=100, element="hex20", angle=24, lines=2, solver=CYCLIC, more="inflation = "
             '{ pressure = "0.3 bar" }\noutput = { plots = [] }'),
    ),
    Study(
        Tyre(angle=1.0, loads=4, lines=2, solver=CYCLIC,
             more='output = { plots = [], deflections = ["200 Hz"] }'),
        need=_of_deflections,
    ),
    Study(
        Tyre(along=8, angle=24, points=1000, lines=200, solver=CYCLIC,
             more='sweep.E_r = ["70 MPa", "80 MPa", "90 MPa"]\noutput = { plots = [] }'),
        command="sweep", options=("--jobs", "1", "--param", "E_r"), need=_of_sweep,
    ),
    Study(Tyre(along=60, through=2), command="modes", options=("--count", "1000"), need=_of_modes),
    Study(Tyre(through=2), command="dispersion", options=("--lines", "2", "--jobs", "1"),
          need=_of_waves),
    Study(Tyre(along=60, through=2), command="compare", options=("--solvers", "cyclic,direct"),
          jobs=1, need=_of_comparison),
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Row:
    """A study, what it says that it needs, and what it took [bytes]."""

    study: str
    estimated: float
    taken: float

    @property
    def ratio(self) -> float:
        """Of the estimate to what was taken."""
        return self.estimated / self.taken

    @property
    def is_honest(self) -> bool:
        """Whether the estimate is near enough."""
        return LEAST <= self.ratio <= MOST


def row_of(study: Study) -> Row:
    """Estimate and run a study."""
    case = parse_case(study.tyre.text, "tyre.toml", "tyre")
    bricks = study.tyre.along * study.tyre.through * study.tyre.around
    estimated = max(study.need(case, study.jobs).total, need_of_cell(case, bricks).total)
    with TemporaryDirectory() as scratch:
        path = Path(scratch) / "tyre.toml"
        path.write_text(study.tyre.text)
        output = ("--output", f"{scratch}/out", "--json")
        found = command(study.command, str(path), *output, *study.options, watch=True)
    alone = study.jobs == 1 and study.command != "compare"
    return Row(study.words, estimated, found.main if alone else found.together)


def main() -> int:
    """Print the table; 1 where an estimate is not honest."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults.memory", description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--only", type=int, nargs="*", help="numbers of studies, from 0")
    asked = parser.parse_args()
    rows = []
    if not asked.json:
        print("| study | needs [MB] | took [MB] | ratio |\n|---|---|---|---|")
    for k in asked.only or range(len(STUDIES)):
        rows.append(row_of(STUDIES[k]))
        row = rows[-1]
        if not asked.json:
            sizes = f"{row.estimated / 1e6:.0f} | {row.taken / 1e6:.0f} | {row.ratio:.2f}"
            print(f"| {row.study} | {sizes} |", flush=True)
    if asked.json:
        told = [
            {"study": r.study, "needs": r.estimated, "took": r.taken, "ratio": r.ratio}
            for r in rows
        ]
        print(json.dumps({"rows": told, "dishonest": sum(not r.is_honest for r in rows)}, indent=2))
    return 0 if all(row.is_honest for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
