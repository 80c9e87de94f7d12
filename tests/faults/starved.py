"""Runs on machines that have no room left, and whether they say so and damage nothing."""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from tyrefrf.errors import TyreFRFError
from tyrefrf.results import load_any

from ..small import text_with
from .rows import Row, lost_of

PART = "Starved"
NOBODY = 65534
WITHOUT_ROOT_S_RIGHTS = ("setpriv", "--bounding-set", "-dac_override,-dac_read_search")
"""Root, whom permissions bind as they do everybody."""
LINES = ("values = [0.0, 40.0, 150.0, 420.0]", "stop = 420.0\ncount = 301")
RUN = ("run", "tyre.toml", "--jobs", "1")
DISKS = (*range(4096, 60_000, 16_384), *range(60_000, 600_000, 20_000))
"""Sizes of disks, from too small for anything to nearly large enough."""


class Trials:
    """Commands under some want, what they said, and what they damaged."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self.losses: list[str] = []
        self.said: list[str] = []
        self.times = 0
        (directory / "tyre.toml").write_text(text_with(LINES))

    def run(self, *arguments: str | Path, output: Path, **more: Any) -> None:
        """Run a command that wants something; it may also have enough of it."""
        before = contents(output)
        done = command(*arguments, "--output", output, cwd=self.directory, **more)
        self.times += 1
        if done.returncode == 0:
            self.said.append("enough: 0")
            return
        progress = re.compile(r"lines/s|about \d+ s in all")
        lines = [line for line in done.stderr.splitlines() if not progress.search(line)]
        self.said.append(f"`{plain(lines[0], output, self.directory)}` ({done.returncode})")
        if done.returncode != 1 or "Traceback" in done.stderr or len(lines) > 2:
            self.losses.append(f"status {done.returncode}, {len(lines)} lines of message")
        after = contents(output)
        damaged = [path.name for path, content in before.items() if after.get(path) != content]
        if damaged:
            self.losses.append(f"damaged: {', '.join(damaged)}")
        self._look(output)

    def _look(self, output: Path) -> None:
        """What stands under the name of results is whole."""
        with suppress(PermissionError):
            for path in output.glob("*.h5"):
                try:
                    load_any(path)
                except TyreFRFError as error:
                    self.losses.append(str(error))

    def row(self, fault: str) -> Row:
        """The table's row."""
        counts = {text: self.said.count(text) for text in dict.fromkeys(self.said)}
        seen = ", ".join(f"{text}: {n}" for text, n in counts.items())
        return Row(PART, fault, self.times, lost_of(self.losses), seen)


def command(
    *arguments: str | Path, cwd: Path, start: Sequence[str] = (), **more: Any
) -> subprocess.CompletedProcess[str]:
    """The program, as a shell starts it; `start` starts it in its way."""
    return subprocess.run(
        [*start, sys.executable, "-m", "tyrefrf", *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=cwd,
        check=False,
        **more,
    )


def plain(words: str, *directories: Path) -> str:
    """Without what differs from trial to trial."""
    for directory in directories:
        words = words.replace(f"{directory}/", "")
    words = re.sub(r"tyrefrf-[0-9a-f]{32}", "tyrefrf-...", words)
    words = re.sub(r"and \d+ are allowed", "and n are allowed", words)
    return re.sub(r"and \d+ MB are left", "and n MB are left", words)


def contents(directory: Path) -> dict[Path, bytes]:
    """The files that stand in a directory, but for locks."""
    with suppress(PermissionError):
        files = [path for path in directory.rglob("*") if path.is_file()]
        return {path: path.read_bytes() for path in files if not path.name.startswith(".")}
    return {}


@contextmanager
def disk(directory: Path, size: int) -> Iterator[Path]:
    """A disk of its own of so many bytes."""
    directory.mkdir(exist_ok=True)
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(directory)]
    subprocess.run(mount, check=True, capture_output=True)
    try:
        yield directory
    finally:
        subprocess.run(["umount", str(directory)], check=True)


def at_most(what: int, amount: int) -> Callable[[], None]:
    """Limits a process, before it begins, to so much of something."""
    return lambda: resource.setrlimit(what, (amount, amount))


def full_disks(trials: Trials) -> Row:
    """A run on disks that are full at ever later moments."""
    for size in DISKS:
        with disk(trials.directory / "disk", size) as full:
            trials.run(*RUN, output=full / "o")
    return trials.row("disk full, at 31 moments from the first byte to the last plot")


def full_disks_with_results(trials: Trials) -> Row:
    """A run that is to replace results, where there is no room beside them."""
    for share in (0, 60_000, 120_000, 180_000, 260_000):
        with disk(trials.directory / "disk", 4_000_000) as full:
            assert command(*RUN, "--output", full / "o", cwd=trials.directory).returncode == 0
            free = os.statvfs(full).f_bavail * os.statvfs(full).f_frsize
            (full / "ballast").write_bytes(b"\0" * max(0, free - share))
            trials.run(*RUN, "--force", output=full / "o")
    return trials.row("disk full, complete results there, `--force`")


def no_large_files(trials: Trials) -> Row:
    """Files may not be larger than so much, as by a quota."""
    for size in range(1000, 200_000, 20_000):
        output = trials.directory / f"o{size}"
        trials.run(*RUN, output=output, preexec_fn=at_most(resource.RLIMIT_FSIZE, size))
    return trials.row("files limited in size (`ulimit -f`), 1 to 181 kB")


def read_only(trials: Trials) -> Row:
    """An output that can be read, but not written."""
    with disk(trials.directory / "disk", 4_000_000) as fixed:
        assert command(*RUN, "--output", fixed / "o", cwd=trials.directory).returncode == 0
        subprocess.run(["mount", "-o", "remount,ro", str(fixed)], check=True)
        trials.run(*RUN, output=fixed / "new")
        trials.run(*RUN, "--force", output=fixed / "o")
        trials.run(*RUN, "--resume", output=fixed / "o")
    return trials.row("output on a read-only disk")


def unwritable(trials: Trials) -> Row:
    """An output that belongs to somebody else."""
    output = trials.directory / "theirs"
    assert command(*RUN, "--output", output, cwd=trials.directory).returncode == 0
    for path in (output, *output.rglob("*")):
        os.chown(path, NOBODY, NOBODY)
    for target, more in ((output / "new", ()), (output, ("--force",)), (output, ("--resume",))):
        trials.run(*RUN, *more, output=target, start=WITHOUT_ROOT_S_RIGHTS)
    return trials.row("output in a directory of somebody else")


def few_handles(trials: Trials) -> Row:
    """Few open files are allowed."""
    limits: Sequence[int] = (6, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40)
    for jobs in ("1", "2"):
        for limit in limits:
            arguments = ("run", "tyre.toml", "--jobs", jobs)
            output = trials.directory / f"o{jobs}-{limit}"
            preexec = at_most(resource.RLIMIT_NOFILE, limit)
            trials.run(*arguments, output=output, preexec_fn=preexec)
    return trials.row("6 to 40 open files allowed (`ulimit -n`), 1 and 2 jobs")


def full_temporary(trials: Trials) -> Row:
    """No room where the processes are given their work."""
    for size in (4096, 16_384, 65_536):
        with disk(trials.directory / "disk", size) as full:
            environment = os.environ | {"TMPDIR": str(full)}
            arguments = ("run", "tyre.toml", "--jobs", "2")
            trials.run(*arguments, output=trials.directory / f"o{size}", env=environment)
    return trials.row("`TMPDIR` full, 2 jobs")


def little_memory(trials: Trials) -> Row:
    """Little memory is allowed, from none for any command to enough."""
    for jobs in ("1", "2"):
        for megabytes in (100, 200, 300, 400, 500, 590, 610, 650, 700, 800, 1000):
            arguments = ("run", "tyre.toml", "--jobs", jobs)
            preexec = at_most(resource.RLIMIT_AS, megabytes * 1_000_000)
            trials.run(*arguments, output=trials.directory / f"o{jobs}", preexec_fn=preexec)
            shutil.rmtree(trials.directory / f"o{jobs}", ignore_errors=True)
    return trials.row("100 to 1000 MB of memory allowed (`ulimit -v`), 1 and 2 jobs")


def needs_much(trials: Trials) -> Row:
    """Cases that need more memory than there is."""
    cases = {
        "section": [("elements_along = 8", "elements_along = 400\nelements_through = 8")],
        "ring": [("sector_angle = 24.0", "sector_angle = 0.036"), ("= 8\n", "= 100\n")],
        "lines": [(LINES[0], "stop = 1000.0\ncount = 1000000")],
    }
    for name, changes in cases.items():
        (trials.directory / f"{name}.toml").write_text(text_with(*changes))
        for command_ in ("run", "compare"):
            preexec = at_most(resource.RLIMIT_AS, 1_000_000_000)
            output = trials.directory / "o"
            trials.run(command_, f"{name}.toml", output=output, preexec_fn=preexec)
    return trials.row("cases that need more than is there, or allowed: 1 GB; `run`, `compare`")


FAULTS = (
    full_disks,
    full_disks_with_results,
    no_large_files,
    read_only,
    unwritable,
    few_handles,
    full_temporary,
    little_memory,
    needs_much,
)


def rows() -> Iterator[Row]:
    """Every fault; as root, who may mount disks."""
    for fault in FAULTS:
        with tempfile.TemporaryDirectory() as directory:
            yield fault(Trials(Path(directory)))
