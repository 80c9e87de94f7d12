"""What a line costs by every solver, in operations and in this machine's seconds."""

from __future__ import annotations

import time

import numpy as np

from tyrefrf.solvers import Cyclic, Recursive, RingProblem
from tyrefrf.solvers.direct import check_library

REACHED = {"recursive": 0.65, "cyclic": 0.12}
"""Of the machine's zgemm rate: by the recursion's operations, and by those of LAPACK's bands, the
substitution counted with them."""

CHECK = 14_000.0
"""Cost of the field and its residual at the zgemm rate over N n."""

FIXED = {"recursive": 5e-3, "cyclic": 3e-4}
"""Seconds that any line takes beside its operations. With these the homogeneous and the layered
tyre are met within a third (benchmarks/RESULTS.md)."""

DIRECT = 35.0
"""Cost of SuperLU's `direct` at the zgemm rate over N n^3: both tyres within 10 %."""

PARDISO = 0.3
"""Of what SuperLU takes for `direct`: 0.22 on the layered tyre, 0.41 on the homogeneous one."""

MODAL = 35_000.0
"""Cost over N n: superposing 1000 modes, and the check of the field: 27 000 and 39 000."""


def section_dofs(problem: RingProblem) -> int:
    """Dofs of a section that move: the size of the recursion's matrices."""
    return int(problem.free[: problem.cell.n_face].sum())


def line_seconds(solver: str, problem: RingProblem) -> float:
    """Seconds per line, from the operations of the solver and this machine's zgemm rate."""
    N, own = problem.n_cells, int(problem.free.sum())
    cost = CHECK * N * own
    if solver == "recursive":
        n = section_dofs(problem)
        inside = 8.0 * (own - n) * ((own - n) / 3.0 + 2.0 * n) ** 2
        cost += (Recursive(problem).operations + inside) / REACHED["recursive"]
    elif solver == "cyclic":
        cost += Cyclic(problem).operations / REACHED["cyclic"]
    elif solver == "modal":
        cost = MODAL * N * own
    else:
        cost += DIRECT * N * own**3 * (PARDISO if check_library("auto") == "pardiso" else 1.0)
    return FIXED.get(solver, 0.0) + cost / zgemm_rate()


def zgemm_rate(n: int = 256, repeats: int = 3) -> float:
    """Operations per second of this machine's complex matrix product, one thread."""
    from threadpoolctl import threadpool_limits

    A = np.full((n, n), 1.0 + 1.0j)
    times = []
    with threadpool_limits(limits=1, user_api="blas"):
        for _ in range(repeats):
            start = time.perf_counter()
            _ = A @ A
            times.append(time.perf_counter() - start)
    return 8.0 * n**3 / min(times)
