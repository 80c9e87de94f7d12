"""Seconds per line of every solver, and how near the recursion comes to the machine's limit.

    python -m benchmarks.speed

One thread. A line is everything: forming D, condensing, joining, closing the ring, recovering
the whole field and its residual. `plain` is the recursion as the paper writes it, without the
symmetries of the cell and with one chain all around: its joins are what the operations count.
`direct` is SuperLU's, and where MKL is installed PARDISO's too.
"""

from __future__ import annotations

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks.machine import best, description, table, zgemm_rate
from tyrefrf.case import Case, builtin_text, parse_case, starter_text
from tyrefrf.solvers import SOLVERS, Direct, Recursive, mkl, solve_line
from tyrefrf.solvers.chain import Chain
from tyrefrf.solvers.ring import steps
from tyrefrf.study.model import build_model

FREQUENCY = 700.0  # Hz; the operations are the same at every line


def cases() -> dict[str, Case]:
    """The paper's two tyres."""
    return {
        "homogeneous": parse_case(starter_text(), "starter", "homogeneous"),
        "layered": parse_case(builtin_text(), "built-in", "layered"),
    }


BUILD = {
    "plain": lambda problem: Recursive(problem, symmetries=False, most_chains=1),
    **SOLVERS,
}
if mkl.installed():
    BUILD |= {"direct, PARDISO": Direct, "direct": lambda problem: Direct(problem, "superlu")}
SLOW = ("direct", "direct, PARDISO", "plain")


def join_operations(n: int) -> float:
    """Real operations of one plain join of chains with n dofs on a face.

    Factorisation 8/3 n^3, substitution of 2n right-hand sides 16 n^3, three products 24 n^3.
    """
    return (8.0 / 3.0 + 16.0 + 24.0) * n**3


def n_joins(n_cells: int) -> int:
    """Joins that one chain all around takes."""
    return len(steps(n_cells, Chain.DOUBLE, Chain.JOIN))


def measured() -> str:
    """The table, in Markdown."""
    rows = []
    with threadpool_limits(limits=1, user_api="blas"):
        rate = zgemm_rate()
        for name, case in cases().items():
            problem = build_model(case).problem
            n = int(problem.free[: problem.cell.n_face].sum())
            operations = join_operations(n) * n_joins(problem.n_cells)
            seconds = {}
            for solver, build in BUILD.items():
                built = build(problem)
                repeats = 3 if solver in SLOW else 20
                seconds[solver] = best(
                    lambda built=built, problem=problem: solve_line(  # type: ignore[misc]
                        problem, built, 2.0 * np.pi * FREQUENCY
                    ),
                    repeats,
                )
            reached = operations / seconds["plain"] / rate
            rows.append(
                [
                    f"{name}: {n} dofs, {problem.n_cells} cells",
                    *(f"{1e3 * seconds[solver]:.3g}" for solver in BUILD),
                    f"{operations / 1e9:.2f}",
                    f"{100.0 * reached:.0f} %",
                ]
            )
    header = ["section, ring", *(f"`{solver}` [ms]" for solver in BUILD)]
    header += ["operations of the plain joins [10^9]", "of the zgemm rate"]
    return f"Per line, one thread, best of several; zgemm at {rate / 1e9:.0f} GF/s.\n\n" + table(
        header, rows
    )


if __name__ == "__main__":
    print(description())
    print(measured())
