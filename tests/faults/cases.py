"""Spoilt case files by the thousand: each gives results, or an error with a place in the file.

    python -m tests.faults.cases --count 10000 --seed 1
    python -m tests.faults.cases --count 1000 --json

Prints a table by the kind of fault. Exits 1 where anything else came of a case: those are kept in
--keep DIR. Each case goes to a command of the program, in a worker process whose memory is bounded,
and which is killed where a case takes longer than --limit seconds of it.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from multiprocessing import get_context
from pathlib import Path

from hypothesis import HealthCheck, Phase, Verbosity, given, seed, settings

from .outcome import ELSE, HANG, KINDS, TRACEBACK, Outcome, Sandbox
from .spoil import ALL, Spoilt, spoilt

CPU_LIMIT = 60.0
"""Seconds that a case may compute."""
MEMORY = 6 << 30
"""Bytes of address space that a worker may take."""
WAITS = 10.0
"""How much longer than it computes a case may take on a busy machine."""


@dataclass(slots=True)
class Row:
    """What became of the cases of one kind."""

    kind: str
    generated: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    slowest: float = 0.0

    def add(self, outcome: Outcome) -> None:
        """Count a case."""
        self.generated += 1
        self.outcomes[outcome.kind] += 1
        self.slowest = max(self.slowest, outcome.seconds)

    @property
    def other(self) -> int:
        """Cases with another outcome than there may be."""
        return sum(self.outcomes[kind] for kind in ELSE)


def drawn(kind: str, count: int, number: int) -> list[Spoilt]:
    """So many different cases of a kind, the same for the same number."""
    found: list[Spoilt] = []

    @seed(number)
    @settings(
        max_examples=count,
        derandomize=False,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        verbosity=Verbosity.quiet,
        suppress_health_check=list(HealthCheck),
    )
    @given(spoilt(kind))
    def draw(case: Spoilt) -> None:
        found.append(case)

    draw()
    return found


class Worker:
    """A process that tries cases, and is replaced where one does not end."""

    def __init__(self, limit: float) -> None:
        self.limit = limit
        self._start()

    def _start(self) -> None:
        context = get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_work, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()

    def outcome(self, case: Spoilt) -> Outcome:
        """What becomes of a case; "hang" where the process had to be killed."""
        start, begun = time.perf_counter(), self._cpu()
        self._pipe.send(case)
        try:
            while self._cpu() - begun < self.limit > (time.perf_counter() - start) / WAITS:
                if self._pipe.poll(1.0):
                    return self._pipe.recv()
            kind, words = HANG, f"longer than {self.limit:g} s"
        except EOFError:
            self._process.join()
            kind, words = TRACEBACK, f"the process died: {self._process.exitcode}"
        self._process.kill()
        self._start()
        return Outcome(kind, words, time.perf_counter() - start)

    def _cpu(self) -> float:
        """Seconds that the process has computed: a busy machine makes no case slow."""
        fields = Path(f"/proc/{self._process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def stop(self) -> None:
        """End the process."""
        self._process.kill()


def _work(pipe) -> None:
    import resource

    os.dup2(2, 1)  # what the table is printed to
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    with tempfile.TemporaryDirectory() as scratch:
        sandbox = Sandbox(Path(scratch))
        while True:
            pipe.send(sandbox.outcome(pipe.recv()))


def tried(count: int, number: int, limit: float, keep: Path | None) -> Iterator[Row]:
    """A row for every kind of fault, together `count` cases."""
    worker = Worker(limit)
    try:
        for k, kind in enumerate(ALL):
            row = Row(kind)
            share = count * (k + 1) // len(ALL) - count * k // len(ALL)
            for case in drawn(kind, share, number) if share else []:
                outcome = worker.outcome(case)
                row.add(outcome)
                if outcome.kind in ELSE and keep is not None:
                    _keep(keep, case, outcome)
            yield row
    finally:
        worker.stop()


def _keep(directory: Path, case: Spoilt, outcome: Outcome) -> None:
    directory.mkdir(parents=True, exist_ok=True)
    number = len(list(directory.glob("*.toml"))) + 1
    (directory / f"{number}.toml").write_bytes(case.case or case.data)
    if case.case:
        (directory / f"{number}.{Path(case.file).name}").write_bytes(case.data)
    words = f"{case.kind}, {case.command}: {outcome.kind}\n{outcome.words}\n"
    (directory / f"{number}.txt").write_text(words, errors="replace")


HEADER = ("fault", "cases", *KINDS, "anything else", "slowest [s]")


def cells(row: Row) -> list[str]:
    """A row in words."""
    counts = [row.outcomes[kind] for kind in KINDS]
    return [row.kind, *map(str, (row.generated, *counts, row.other)), f"{row.slowest:.1f}"]


def facts(rows: list[Row], number: int, seconds: float) -> dict[str, object]:
    """The same for scripts."""
    return {
        "seed": number,
        "cases": sum(row.generated for row in rows),
        "anything_else": sum(row.other for row in rows),
        "slowest": max((row.slowest for row in rows), default=0.0),
        "seconds": seconds,
        "outcomes": dict(sum((row.outcomes for row in rows), Counter())),
        "kinds": [asdict(row) | {"anything_else": row.other} for row in rows],
    }


def main() -> int:
    """Try so many cases and print the table; 1 where anything else came of one."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults.cases", description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=float, default=CPU_LIMIT, help="CPU seconds for a case")
    parser.add_argument("--keep", type=Path, help="directory for cases with another outcome")
    parser.add_argument("--json", action="store_true")
    asked = parser.parse_args()
    start, rows = time.perf_counter(), []
    if not asked.json:
        print("| " + " | ".join(HEADER) + " |\n|" + "---|" * len(HEADER))
    for row in tried(asked.count, asked.seed, asked.limit, asked.keep):
        rows.append(row)
        if not asked.json:
            print("| " + " | ".join(cells(row)) + " |", flush=True)
    found = facts(rows, asked.seed, time.perf_counter() - start)
    if asked.json:
        print(json.dumps(found, indent=2))
    else:
        print(
            f"\n{found['cases']} cases, {found['anything_else']} with anything else, slowest "
            f"{found['slowest']:.1f} s, {found['seconds']:.0f} s in all (seed {asked.seed})"
        )
    return 1 if found["anything_else"] else 0


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    sys.exit(main())
