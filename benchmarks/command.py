"""The program as a shell starts it, watched from outside: time, memory, what it wrote."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from tyrefrf.case import Case, resolved_toml
from tyrefrf.study.local import ONE_THREAD

TYREFRF = (sys.executable, "-m", "tyrefrf")
INTERVAL = 0.05  # s between two looks at a command's memory


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a command took, from the shell prompt to the next.

    seconds: wall time. main: the main process's most resident memory [bytes]. together: that of
    the command's processes at once; pages that they share count in each. out: its stdout.
    """

    seconds: float
    main: int
    together: int
    out: str


def command(*arguments: str, program: tuple[str, ...] = TYREFRF, watch: bool = False) -> Outcome:
    """Run a command to its end, with the BLAS threads that a user has who asks for none.

    watch: whether its memory is looked at, on Linux; 0 bytes otherwise.
    Raises RuntimeError with the command's last words where its status is not 0.
    """
    environment = {key: value for key, value in os.environ.items() if key not in ONE_THREAD}
    main = together = 0
    with TemporaryDirectory() as scratch:
        out, err = Path(scratch) / "out", Path(scratch) / "err"
        with out.open("wb") as stdout, err.open("wb") as stderr:
            start = time.perf_counter()
            process = subprocess.Popen(
                [*program, *arguments], stdout=stdout, stderr=stderr, env=environment
            )
            family = Family(process.pid)
            while watch and process.poll() is None:
                first, *others = [*family.resident(), (0, 0)]
                main = max(main, first[1])
                together = max(together, first[0] + sum(now for now, _ in others))
                time.sleep(INTERVAL)
            status = process.wait()
            seconds = time.perf_counter() - start
        if status:
            raise RuntimeError(f"{' '.join(arguments)}: status {status}\n{err.read_text()}")
        return Outcome(seconds, main, together, out.read_text())


class Family:
    """A process and its descendants, as Linux's /proc shows them."""

    def __init__(self, pid: int) -> None:
        self.pid = pid
        self._members, self._strangers = {pid}, {1}

    def resident(self) -> Iterator[tuple[int, int]]:
        """Memory and high-water mark [bytes] of the process, then of the others.

        Of a page that n processes share, each has an n-th (proportional set size); the mark
        counts it in full.
        """
        numbers = {int(folder.name) for folder in Path("/proc").glob("[0-9]*")}
        for number in sorted(numbers - self._strangers):
            try:
                text = Path(f"/proc/{number}/status").read_text()
            except OSError:  # it has ended since
                continue
            facts = dict(line.split(":", 1) for line in text.splitlines())
            if number == self.pid or int(facts["PPid"]) in self._members:
                self._members.add(number)
                mark = facts.get("VmHWM", "0 kB").split()[0]
                yield _proportional(number), 1024 * int(mark)
            elif number not in self._members:  # those of the family that outlive it stay
                self._strangers.add(number)


def _proportional(number: int) -> int:
    """Proportional set size of a process [bytes]; 0 where it has ended."""
    try:
        text = Path(f"/proc/{number}/smaps_rollup").read_text()
    except OSError:
        return 0
    sizes = [line.split()[1] for line in text.splitlines() if line.startswith("Pss:")]
    return 1024 * int(sizes[0]) if sizes else 0


def run_case_file(case: Case, directory: Path, *options: str, watch: bool = False) -> Outcome:
    """`tyrefrf run` of a case into a directory, which may have its results already."""
    file = directory / f"{case.name}.toml"
    file.write_text(resolved_toml(case), encoding="utf-8")
    written = str(directory / case.name)
    return command(
        "run", str(file), "--output", written, "--json", "--force", *options, watch=watch
    )


def bytes_in(directory: Path, pattern: str = "*") -> int:
    """Size of all files in a directory and below it."""
    return sum(file.stat().st_size for file in directory.rglob(pattern) if file.is_file())
