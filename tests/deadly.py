"""Work that kills the process that does it, and more that workers must be able to import."""

from __future__ import annotations

import importlib.metadata
import math
import os
import signal
import time
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from tyrefrf.solvers import Recursive
from tyrefrf.study.executor import Task

HERE = os.environ.setdefault("TYREFRF_TEST_PROCESS", str(os.getpid()))


def tasks_of(function, n):
    """function(0), ..., function(n - 1)."""
    make = partial(partial, function)
    return (Task(make, item) for item in range(n))


def reason_of(task, reason):
    """What stands for a lost item."""
    return f"{task.item}: {reason}"


def kill_this_process() -> None:
    assert str(os.getpid()) != HERE, "this would be the tests' own process"
    os.kill(os.getpid(), signal.SIGKILL)


def kill_this_process_whatever(*arguments) -> None:
    kill_this_process()


def square(item: int) -> int:
    return item**2


def slow_square(item: int) -> int:
    time.sleep(0.05)
    return item**2


def no_square(item: int) -> int:
    if item == 3:
        raise ValueError("three has no square")
    return item**2


def own_pid(item: int) -> int:
    time.sleep(0.02)
    return os.getpid()


@dataclass(frozen=True)
class Deadly:
    """Squares, but for one item; that kills the process, the first so many times."""

    item: int
    notes: Path
    times: int = 1_000_000

    def __call__(self, item: int) -> int:
        if item == self.item and len(list(self.notes.iterdir())) < self.times:
            (self.notes / f"{time.monotonic_ns()}").touch()
            kill_this_process()
        return item**2


@dataclass(frozen=True, eq=False)
class Making:
    """Makes a function, as a solver is made, and takes a note of it."""

    array: object
    notes: Path

    def __call__(self):
        (self.notes / f"{os.getpid()}-{time.monotonic_ns()}").touch()
        return partial(looked_up, self.array)


def looked_up(array, item):
    time.sleep(0.02)
    return os.getpid(), array.flags.writeable, float(array[item])


class DeadlyAbove(Recursive):
    """A solver that kills its process on the lines above 400 Hz."""

    def field(self, omega):
        if omega > 2.0 * math.pi * 400.0:
            kill_this_process()
        return super().field(omega)


def blas_threads(item: int) -> set[int]:
    from threadpoolctl import threadpool_info

    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def other_version(name: str) -> str:
    """A package's version; other processes have an old scipy, and no tyrefrf."""
    if str(os.getpid()) == HERE:
        return importlib.metadata.version(name)
    if name == "tyrefrf":
        raise importlib.metadata.PackageNotFoundError(name)
    return "0.1" if name == "scipy" else importlib.metadata.version(name)
