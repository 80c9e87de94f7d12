"""Which LAPACK factorisation serves a join: general (getrf) or complex-symmetric (sytrf).

    python -m benchmarks.kernels

One thread. A join factorises one symmetric block of n dofs and solves for at least n right-hand
sides. Shares of the layered tyre's section have some 120 to 250 dofs, its whole section 501.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack
from threadpoolctl import threadpool_limits

from benchmarks.machine import best, description, table

SIZES = (81, 126, 252, 504)


def measured() -> str:
    """The table, in Markdown."""
    rng = np.random.default_rng(0)
    rows = []
    with threadpool_limits(limits=1, user_api="blas"):
        for n in SIZES:
            A = rng.standard_normal((n, n)) + 1j * rng.standard_normal((n, n))
            A = np.asfortranarray(A + A.T)
            B = np.asfortranarray(rng.standard_normal((n, n)) + 0j)
            lu, pivots, _ = lapack.zgetrf(A)
            ldl, blocks, _ = lapack.zsytrf(A, lwork=64 * n)
            seconds = [
                best(lambda A=A: lapack.zgetrf(A), 10),  # type: ignore[misc]
                best(lambda lu=lu, p=pivots, B=B: lapack.zgetrs(lu, p, B), 10),  # type: ignore[misc]
                best(lambda A=A, n=n: lapack.zsytrf(A, lwork=64 * n), 10),  # type: ignore[misc]
                best(lambda ldl=ldl, p=blocks, B=B: lapack.zsytrs(ldl, p, B), 10),  # type: ignore[misc]
                best(lambda A=A, B=B: A @ B, 10),  # type: ignore[misc]
            ]
            both = (seconds[2] + seconds[3]) / (seconds[0] + seconds[1])
            rows.append([f"{n}", *(f"{1e3 * s:.3g}" for s in seconds), f"{both:.2f}"])
    header = ["n", "getrf [ms]", "getrs [ms]", "sytrf [ms]", "sytrs [ms]", "zgemm [ms]"]
    return "n right-hand sides, one thread, best of ten.\n\n" + table(
        [*header, "symmetric over general, both steps"], rows
    )


if __name__ == "__main__":
    print(description())
    print(measured())
