"""Seconds per line of the recursion and of the cyclic solver, beside sparse solvers of the ring.

    python -m benchmarks.speed

One thread; the shortest of runs that take turns. A line by `recursive` or `cyclic` is everything:
forming D, solving, the field of all sections and its residual. PARDISO (complex symmetric) and
SuperLU only factorise the ring's matrix and substitute one load; their analysis, assembly and any
check are left out. The difference, of the solvers to the libraries and between these, is that of a
section's displacements relative to their norm, the largest of all sections.
"""

from __future__ import annotations

from benchmarks.machine import NOT_HERE, description, interleaved, ms, one_thread, table
from benchmarks.tyres import LOADS, lines_of, problem_under, size_of, tyres
from tyrefrf.case import Case
from tyrefrf.study.compare import section_error

LIBRARIES = ("PARDISO", "SuperLU")
FAST = ("recursive", "cyclic")
ROUNDS = 5


def measured() -> str:
    """The table, in Markdown."""
    with one_thread():
        rows = [_row(name, case, load) for name, case in tyres().items() for load in LOADS]
    header = ["tyre", "load", *(f"{name} [ms]" for name in (*LIBRARIES, *FAST))]
    header += [f"{library} / {name}" for name in FAST for library in LIBRARIES]
    return (
        "Per line, one thread, shortest of runs in turn. PARDISO and SuperLU: the full ring's "
        "factorisation and one substitution alone; the last column: the largest difference to them "
        "of any section's displacements.\n\n" + table([*header, "difference"], rows)
    )


def _row(name: str, case: Case, load: str) -> list[str]:
    """One tyre under one load."""
    problem = problem_under(case, load)
    lines = lines_of((*LIBRARIES, *FAST), problem)
    q = {solver: line() for solver, line in lines.items()}
    difference = max(section_error(q[a], q[b]) for a in q for b in LIBRARIES if b in q and a != b)
    seconds = interleaved(lines, ROUNDS)
    times = [ms(seconds.get(solver)) for solver in (*LIBRARIES, *FAST)]
    ratios = [ratio(seconds, library, solver) for solver in FAST for library in LIBRARIES]
    return [f"{name}: {size_of(problem)}", load, *times, *ratios, f"{difference:.0e}"]


def ratio(seconds: dict[str, float], slow: str, fast: str) -> str:
    """How many times faster, in words for a table."""
    return f"{seconds[slow] / seconds[fast]:.3g}" if slow in seconds else NOT_HERE


if __name__ == "__main__":
    print(description())
    print(measured())
