"""How many operations a line is, and how near its solver comes to the machine's limit.

    python -m benchmarks.operations

The limit is the rate of the machine's own complex matrix product, zgemm, at 8 n^3 operations. The
operations are those of dense or banded algebra that a line cannot do without: joins and closings of
a recursion (`plain`: as the paper writes it), factorisations of the orders' bands. The time is that
of the whole line, with the field of all sections and its residual; and that of joins and closings
alone.
"""

from __future__ import annotations

from benchmarks.machine import description, interleaved, ms, one_thread, table, zgemm_rate
from benchmarks.parts import JOINS, parts_of
from benchmarks.tyres import OBLIQUE, lines_of, plain, problem_under, size_of, tyres
from tyrefrf.case import Case
from tyrefrf.solvers import Cyclic, Recursive, RingProblem

ALONE = "recursive, joins and closings alone"
WHOLE = ("plain", "recursive", "cyclic", "direct")


def measured() -> str:
    """The table, in Markdown."""
    with one_thread():
        rate = zgemm_rate()
        rows = [row for name, case in tyres().items() for row in _rows(name, case, rate)]
    header = ["tyre", "solver", "line [ms]", "operations [10^9]", "of the zgemm rate"]
    head = f"One thread, load {OBLIQUE}; zgemm at {rate / 1e9:.0f} GF/s. Operations of `direct` "
    return head + "are its library's own affair.\n\n" + table(header, rows)


def _rows(name: str, case: Case, rate: float) -> list[list[str]]:
    """One tyre by every solver."""
    problem = problem_under(case, OBLIQUE)
    lines = {**lines_of(WHOLE, problem), ALONE: parts_of(problem)[JOINS]}
    seconds = interleaved(lines)
    operations = operations_of(problem)
    return [
        [
            f"{name}: {size_of(problem)}",
            solver,
            ms(seconds[solver]),
            *_share(operations.get(solver), seconds[solver], rate),
        ]
        for solver in lines
    ]


def operations_of(problem: RingProblem) -> dict[str, float]:
    """Operations of a line, by solver."""
    joins = Recursive(problem).operations
    return {
        "plain": plain(problem).operations,
        "recursive": joins,
        ALONE: joins,
        "cyclic": Cyclic(problem).operations,
    }


def _share(operations: float | None, seconds: float, rate: float) -> list[str]:
    """Operations, and their rate as a share of the zgemm rate."""
    if operations is None:
        return ["-", "-"]
    return [f"{operations / 1e9:.3g}", f"{100.0 * operations / seconds / rate:.0f} %"]


if __name__ == "__main__":
    print(description())
    print(measured())
