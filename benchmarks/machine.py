"""What the numbers were measured on, how they were timed, and how they are written down."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

import numpy as np
from threadpoolctl import threadpool_limits

from tyrefrf.solvers import mkl
from tyrefrf.study.machine import machine

NOT_HERE = "-"
"""In a table: what could not be measured on this machine, such as PARDISO without MKL."""


def description() -> str:
    """Processor, cores, versions and date in one line."""
    known = machine()
    names = ("Python", "numpy", "scipy", "tyrefrf")
    packages = ", ".join(f"{name} {known[name]}" for name in names)
    where = f"{known['processor']}, {known['cores']} cores, {packages}"
    return f"{where}, {library_description()}, {datetime.now(UTC):%Y-%m-%d}"


def library_description() -> str:
    """MKL's version, whose PARDISO others are held against, or that there is none."""
    if not mkl.installed():
        return "no MKL, hence no PARDISO"
    try:
        return f"mkl {version('mkl')}"
    except PackageNotFoundError:  # not the wheel's, but one on the loader's path
        return "mkl of the system"


def one_thread() -> AbstractContextManager[object]:
    """One BLAS thread for everybody; MKL is loaded with one."""
    return threadpool_limits(limits=1, user_api="blas")


def interleaved(
    functions: Mapping[str, Callable[[], object]], rounds: int = 3, share: float = 0.1
) -> dict[str, float]:
    """The shortest run [s] of each function, all of them in turn.

    What others do on the machine disturbs all alike, and the shortest run is the least disturbed.
    In its turn a quick function is repeated for `share` seconds: the lines of a spectrum follow
    one another too, and find the caches as they left them.
    """
    shortest = dict.fromkeys(functions, float("inf"))
    for _ in range(rounds):
        for name, function in functions.items():
            shortest[name] = min(shortest[name], _shortest(function, share))
    return shortest


def _shortest(function: Callable[[], object], share: float) -> float:
    """The shortest of as many runs as fit in a share [s], of one at least."""
    shortest, end = float("inf"), time.perf_counter() + share
    while True:
        start = time.perf_counter()
        function()
        now = time.perf_counter()
        shortest = min(shortest, now - start)
        if now >= end:
            return shortest


def zgemm_rate(n: int = 512) -> float:
    """Operations per second of a complex matrix product, at 8 n^3 operations."""
    rng = np.random.default_rng(0)
    A = rng.standard_normal((n, n)) + 1j * rng.standard_normal((n, n))
    return 8.0 * n**3 / interleaved({"A A": lambda: A @ A})["A A"]


def ms(seconds: float | None) -> str:
    """Milliseconds with three digits, for a table."""
    return NOT_HERE if seconds is None else f"{1e3 * seconds:.3g}"


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
