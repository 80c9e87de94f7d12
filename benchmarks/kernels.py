"""Which LAPACK factorisation serves a join: general (getrf) or complex-symmetric (sytrf).

    python -m benchmarks.kernels

One thread. A join factorises one symmetric block of n dofs and solves for at least n right-hand
sides. Shares of the layered tyre's section have some 120 to 250 dofs, its whole section 501.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import lapack

from benchmarks.machine import description, interleaved, ms, one_thread, table

SIZES = (81, 126, 252, 504)


def measured() -> str:
    """The table, in Markdown."""
    rows = []
    with one_thread():
        for n in SIZES:
            steps = interleaved(_steps(n))
            longer = (steps["sytrf"] + steps["sytrs"]) / (steps["getrf"] + steps["getrs"])
            rows.append([f"{n}", *map(ms, steps.values()), f"{longer:.2f}"])
    header = ["n", *(f"{name} [ms]" for name in _steps(1)), "symmetric over general, both steps"]
    return "n right-hand sides, one thread, shortest of runs in turn.\n\n" + table(header, rows)


def _steps(n: int) -> dict[str, Callable[[], object]]:
    """Both factorisations, their substitutions, and a matrix product of the same size."""
    rng = np.random.default_rng(0)
    A = rng.standard_normal((n, n)) + 1j * rng.standard_normal((n, n))
    A = np.asfortranarray(A + A.T)
    B = np.asfortranarray(rng.standard_normal((n, n)) + 0j)
    lu, pivots, _ = lapack.zgetrf(A)
    ldl, blocks, _ = lapack.zsytrf(A, lwork=64 * n)
    return {
        "getrf": lambda: lapack.zgetrf(A),
        "getrs": lambda: lapack.zgetrs(lu, pivots, B),
        "sytrf": lambda: lapack.zsytrf(A, lwork=64 * n),
        "sytrs": lambda: lapack.zsytrs(ldl, blocks, B),
        "zgemm": lambda: A @ B,
    }


if __name__ == "__main__":
    print(description())
    print(measured())
