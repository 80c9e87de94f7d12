"""Ctrl-C and the signals that end a process: what is there is kept, and said."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

HEEDED = ("SIGINT", "SIGTERM", "SIGHUP")
"""Ctrl-C; the end that a batch system or `kill` asks for; a terminal that is closed."""

SOON = 0.01  # seconds


class Interrupted(BaseException):
    """A signal has ended the work.

    No KeyboardInterrupt, which libraries on the way have their own answers to. words: what has
    become of what was done.
    """

    def __init__(self, number: int, words: str = "") -> None:
        self.number, self.words = number, words
        super().__init__(words)

    @property
    def status(self) -> int:
        """Exit status, as shells have it: 128 and the signal's number."""
        return 128 + self.number

    def __str__(self) -> str:
        name = signal.Signals(self.number).name
        return f"interrupted by {name}" + (f": {self.words}" if self.words else "")


@contextmanager
def heeding_signals() -> Iterator[None]:
    """Raise Interrupted on the first signal; a second one ends the process there and then.

    Signals that the process was told to ignore, as by nohup, stay ignored.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread may ask for signals
        return
    numbers = [getattr(signal, name) for name in HEEDED if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in numbers}
    heeded = [number for number in numbers if before[number] is not signal.SIG_IGN]

    def interrupt(number: int, frame: FrameType | None) -> None:
        for each in heeded:
            signal.signal(each, signal.SIG_DFL)
        raise Interrupted(number)

    with _heard():
        try:
            for number in heeded:
                signal.signal(number, interrupt)
            yield
        finally:
            for number in heeded:
                signal.signal(number, before[number])


@contextmanager
def _heard() -> Iterator[None]:
    """Raise Interrupted once more where Python could not let it through.

    An exception that comes up while an object is being destroyed is only printed.
    """
    if not hasattr(signal, "setitimer"):  # Windows
        yield
        return
    before = sys.unraisablehook, signal.getsignal(signal.SIGALRM)

    def not_let_through(what: sys.UnraisableHookArgs) -> None:
        if not isinstance(what.exc_value, Interrupted):
            before[0](what)
            return
        number = what.exc_value.number

        def again(alarm: int, frame: FrameType | None) -> None:
            raise Interrupted(number)

        signal.signal(signal.SIGALRM, again)
        signal.setitimer(signal.ITIMER_REAL, SOON)

    sys.unraisablehook = not_let_through
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        sys.unraisablehook = before[0]
        signal.signal(signal.SIGALRM, before[1])
