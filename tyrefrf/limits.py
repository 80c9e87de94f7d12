"""What this process may take of memory, by its own limits and before anything large is imported."""

from __future__ import annotations

import math
from contextlib import suppress
from pathlib import Path

LEAST = 600e6
"""Bytes of addresses that the program and each of its workers take before they compute: libraries
reserve most of them. With less, some cannot be loaded, and OpenBLAS may wait for ever."""


def room_of_process() -> float:
    """Bytes that this process, or one like it, may still take by its own limits (`ulimit -v`).

    Infinite where it has none. Limits are on addresses, of which libraries take many that they
    never touch.
    """
    try:
        import resource
    except ImportError:  # Windows
        return math.inf
    sizes = _status_of_process()
    rooms = [
        limit - sizes.get(size, 0)
        for which, size in ((resource.RLIMIT_AS, "VmSize"), (resource.RLIMIT_DATA, "VmData"))
        if (limit := resource.getrlimit(which)[0]) != resource.RLIM_INFINITY
    ]
    return max(0.0, min(rooms)) if rooms else math.inf


def resident_now() -> int:
    """Bytes that this process holds."""
    return _status_of_process().get("VmRSS", 0)


def _status_of_process() -> dict[str, int]:
    """What Linux says of this process's memory [bytes]; nothing elsewhere."""
    lines: list[str] = []
    with suppress(OSError):
        lines = Path("/proc/self/status").read_text().splitlines()
    rows = (line.split() for line in lines)
    return {row[0].rstrip(":"): 1024 * int(row[1]) for row in rows if row[-1:] == ["kB"]}
