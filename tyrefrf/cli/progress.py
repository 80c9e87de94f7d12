"""Progress on stderr: a bar with rate and remaining time on a terminal, plain lines in a log."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

SECONDS_BETWEEN_LINES = 5.0


@contextmanager
def progress_of(n_lines: int, what: str, there: int = 0) -> Iterator[Callable[[int], None]]:
    """Give a function to call with the number of frequency lines just finished.

    there: how many were finished before. A terminal that is closed, or a log without room, shows
    nothing more, and ends nothing.
    """
    if sys.stderr.isatty():
        with _bar(n_lines, what, there) as advance:
            yield advance
    else:
        yield _Log(n_lines, what, there)


@contextmanager
def _bar(n_lines: int, what: str, there: int) -> Iterator[Callable[[int], None]]:
    """A rich progress bar."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    bar = Progress(*columns, console=Console(stderr=True))
    with suppress(OSError):
        bar.start()
    try:
        task = bar.add_task(what, total=n_lines, completed=there, rate="")
        start = time.perf_counter()

        def advance(n: int) -> None:
            done = bar.tasks[0].completed + n - there
            rate = done / (time.perf_counter() - start)
            bar.update(task, advance=n, rate=f"{rate:.1f} lines/s")

        yield advance
    finally:
        with suppress(OSError):
            bar.stop()


class _Log:
    """A line every few seconds, and at the end."""

    def __init__(self, n_lines: int, what: str, there: int) -> None:
        self.n_lines, self.what, self.there, self.done = n_lines, what, there, there
        self.start = self.last = time.perf_counter()

    def __call__(self, n: int) -> None:
        self.done += n
        now = time.perf_counter()
        if now - self.last < SECONDS_BETWEEN_LINES and self.done < self.n_lines:
            return
        self.last = now
        rate = (self.done - self.there) / (now - self.start)
        left = (self.n_lines - self.done) / rate if rate else 0.0
        words = f"{self.done}/{self.n_lines} lines, {rate:.1f} lines/s, {left:.0f} s left"
        with suppress(OSError):
            print(f"{self.what}: {words}", file=sys.stderr, flush=True)
