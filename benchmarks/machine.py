"""What the numbers were measured on, and how fast it multiplies matrices."""

from __future__ import annotations

import time
from collections.abc import Callable
from datetime import UTC, datetime

import numpy as np

from tyrefrf.study.machine import machine


def description() -> str:
    """Processor, cores, versions and date in one line."""
    known = machine()
    packages = ", ".join(
        f"{name} {known[name]}" for name in ("Python", "numpy", "scipy", "tyrefrf")
    )
    return f"{known['processor']}, {known['cores']} cores, {packages}, {datetime.now(UTC):%Y-%m-%d}"


def best(function: Callable[[], object], repeats: int) -> float:
    """The shortest of several runs [s], after one to warm up: the least disturbed by others."""
    function()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times)


def zgemm_rate(n: int = 512) -> float:
    """Operations per second of a complex matrix product, at 8 n^3 operations."""
    rng = np.random.default_rng(0)
    A = rng.standard_normal((n, n)) + 1j * rng.standard_normal((n, n))
    return 8.0 * n**3 / best(lambda: A @ A, 5)


def table(header: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
