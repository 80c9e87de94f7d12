"""Whether a ring's factor fits in memory, known before a line is solved."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from pathlib import Path

from tyrefrf.errors import SolveError
from tyrefrf.limits import resident_now, room_of_process
from tyrefrf.solvers.direct import check_library, n_entries, ring_matrix
from tyrefrf.solvers.pardiso import PardisoSystem
from tyrefrf.solvers.problem import RingProblem
from tyrefrf.solvers.sparse import Scattered, factor_entries, minimum_degree

PROCESS = 100e6  # bytes of a process with numpy, scipy and the case: measured 60e6 to 75e6
PER_ENTRY = 85.0
"""Bytes per assembled entry of the cells, index maps and what was sorted for them: measured on
the peak resident size of the homogeneous, the layered and the quadratic tyre (75 to 92)."""
PER_FACTOR_ENTRY = 18.5
"""Bytes per entry of SuperLU's L and U, a complex number and its index: measured 18.0 to 18.7, for
2e6 to 25e6 entries."""


def memory_needed(problem: RingProblem, library: str = "auto") -> float:
    """Peak memory [bytes] of a process that solves this ring by `direct`.

    The factor's entries are counted, not guessed: SuperLU's from the order of elimination,
    PARDISO's by its analysis. Takes less time than a line. Where diagonal pivots fail (lines
    of undamped tyres), SuperLU's second factor is larger: measured 1.03 to 1.5 times on tyres of
    the paper's size, 2.9 times on a small one. That is not counted. Where the ring's entries alone
    do not fit, nor would they while its factor's are counted: then they are all that is.
    """
    ring = PROCESS + PER_ENTRY * n_entries(problem) + _fields(problem)
    available = available_memory()
    there = min(math.inf if available is None else available, room_of_process())
    if ring > there + resident_now():
        return ring
    matrix = ring_matrix(problem)
    if check_library(library) == "pardiso":
        return ring + PardisoSystem(matrix).memory
    return ring + PER_FACTOR_ENTRY * _superlu_entries(matrix)


def check_memory(problem: RingProblem, library: str, jobs: int) -> None:
    """Raises SolveError where `jobs` processes would not fit in the memory that is left."""
    available = available_memory()
    if available is None:
        return
    needed = memory_needed(problem, library)
    if jobs * needed <= available:
        return
    fits = int(available // needed)
    fewer = f"--jobs {fits} would fit; " if fits else ""
    raise SolveError(
        f"the solver 'direct' needs {jobs * needed / 1e9:.3g} GB of memory ({needed / 1e9:.3g} GB "
        f"for each of {jobs} jobs), and {available / 1e9:.3g} GB are available: {fewer}'cyclic' "
        "and 'recursive' give the same answer in a fraction of it; or mesh more coarsely"
    )


def _superlu_entries(matrix: Scattered) -> int:
    pattern = matrix.compressed()
    return factor_entries(pattern, minimum_degree(pattern))


def _fields(problem: RingProblem) -> float:
    """Bytes of loads, displacements and forces, some eight of each, one load more than asked."""
    return 8 * 16.0 * problem.n_ring_dofs * (problem.n_loads + 1)


def available_memory(root: Path = Path("/")) -> int | None:
    """Bytes that may still be taken: the machine's, or this process's control group's if less.

    None where the system does not say (no Linux). root: where /proc and /sys are.
    Source: proc_meminfo(5), and the kernel's documents of cgroup v1 and v2.
    """
    try:
        meminfo = (root / "proc/meminfo").read_text()
    except OSError:
        return None
    machine = re.search(r"^MemAvailable:\s+(\d+) kB", meminfo, re.MULTILINE)
    if machine is None:
        return None
    return min([1024 * int(machine[1]), *_group_rooms(root)])


def _group_rooms(root: Path) -> Iterator[int]:
    """What is left [bytes] of every memory limit on this process, v1 or v2."""
    for line in _lines(root / "proc/self/cgroup"):
        _, controllers, path = line.split(":", 2)
        if not controllers:
            base, names = root / "sys/fs/cgroup", ("memory.max", "memory.current")
        elif "memory" in controllers.split(","):
            base = root / "sys/fs/cgroup/memory"
            names = ("memory.limit_in_bytes", "memory.usage_in_bytes")
        else:
            continue
        group = base / path.lstrip("/")
        for folder in (group, *group.parents):
            limit, used = (next(iter(_lines(folder / name)), "max") for name in names)
            if limit != "max" and used != "max":
                yield int(limit) - int(used) + _cached(folder)
            if folder == base:
                break


def _cached(folder: Path) -> int:
    """Bytes that a group holds of files not lately used, and gives back when asked."""
    fields = dict(line.split() for line in _lines(folder / "memory.stat"))
    return int(fields.get("total_inactive_file", fields.get("inactive_file", 0)))


def _lines(path: Path) -> list[str]:
    """A file's lines; none where it cannot be read."""
    try:
        return path.read_text().splitlines()
    except OSError:
        return []
