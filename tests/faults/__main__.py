"""The table of faults: each put in on purpose, how often, what was lost, what the user saw.

    python -m tests.faults [PART ...] [--kills 100] [--cases 10000] [--seed 1]

PART: killed, starved, misfed, physics; all of them without one. What is found of a part is kept in
build/faults, with the generated cases that came to anything else in build/faults/cases, and
docs/validation/faults.md is made of all that is there. An hour, as root, who may mount the disks
that are full. Exits 1 where something was lost.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path

from tyrefrf.study.machine import machine

from . import kills, misfed, starved
from .rows import NOTHING, Row

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "build/faults"
PAGE = ROOT / "docs/validation/faults.md"

HEAD = """\
# Faults put in on purpose

Made by `python -m tests.faults`; nothing here is typed. Every row is a fault that was put in so
many times, what was lost by it, and what the user saw, with the exit status.

- **Killed**: a run, adaptive lines and a sweep are ended by a signal at a random moment between
  their start and their end, gone on with by `--resume`, ended again, until they are done. Lost
  would be: a line that was on disk before, a results file that cannot be read, a traceback, or, in
  the end, another digit than those of a run that nobody ended. Where nothing was said, the signal
  came before the program had begun, or when all was written. Runs that exclude each other, and
  cases that changed: lost would be anything that was there.
- **Starved**: no room on a disk that is full at ever later moments, no right to write, too few open
  files, too little memory. Lost would be: a file that stood before, a results file that is not
  whole, more than a message, another status than 1.
- **Misfed**: lost would be a traceback, a hang, another status, or anything written.
- **Physics**: lost would be a wrong answer, or an error that does not name the fault.
"""


def row_cells(row: Row) -> list[str]:
    """A row as cells of Markdown."""
    cells = [row.fault, str(row.times), row.lost, row.seen]
    return [" ".join(cell.replace("|", "\\|").split()) for cell in cells]


def page(parts: dict[str, dict[str, object]]) -> str:
    """The page, of all parts that there are."""
    texts = [HEAD]
    for found in parts.values():
        table = [Row(**row) for row in found["rows"]]  # type: ignore[attr-defined]
        lines = ["| fault | times | lost | what the user saw |", "| --- | --- | --- | --- |"]
        lines += [f"| {' | '.join(row_cells(row))} |" for row in table]
        made = f"{found['made']}, {found['machine']}, {found['minutes']:.0f} minutes"
        total = sum(row.times for row in table)
        texts.append(f"## {table[0].part}\n\n{total} faults; {made}.\n\n" + "\n".join(lines) + "\n")
    return "\n".join(texts)


def main() -> int:
    """Put faults in, keep what is found, and write the page; 1 where something was lost."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART")
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    known: dict[str, Callable[[], Iterator[Row]]] = {
        "killed": lambda: kills.rows(asked.kills, asked.seed),
        "starved": starved.rows,
        "misfed": lambda: misfed.rows(asked.cases, asked.seed),
        "physics": _physics,
    }
    for name in asked.parts or known:
        _keep(name, known[name])
    kept = {name: KEPT / f"{name}.json" for name in known}
    parts = {name: json.loads(path.read_text()) for name, path in kept.items() if path.exists()}
    PAGE.write_text(page(parts), encoding="utf-8")
    lost = [row for found in parts.values() for row in found["rows"] if row["lost"] != NOTHING]
    return int(bool(lost))


def _physics() -> Iterator[Row]:
    """The rows of wrong physics: each put in once."""
    done = subprocess.run(
        [sys.executable, "-m", "faults.physics", "--json"],
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT / "tests"), str(ROOT)])},
        capture_output=True,
        text=True,
        check=False,
    )
    for row in json.loads(done.stdout):
        yield Row("Physics", row["fault"], 1, NOTHING if row["right"] else "WRONG", row["said"])


def _keep(name: str, faults: Callable[[], Iterator[Row]]) -> None:
    """Put the faults of a part in, and keep what is found."""
    start, found = time.perf_counter(), []
    for row in faults():
        found.append(asdict(row))
        print(*row_cells(row), sep=" | ", flush=True)
    here = machine()
    facts = {
        "made": datetime.now(UTC).date().isoformat(),
        "machine": f"{here['processor']}, {here['cores']} cores, Python {here['Python']}",
        "minutes": (time.perf_counter() - start) / 60.0,
        "rows": found,
    }
    KEPT.mkdir(parents=True, exist_ok=True)
    (KEPT / f"{name}.json").write_text(json.dumps(facts, indent=1))


if __name__ == "__main__":
    sys.exit(main())
