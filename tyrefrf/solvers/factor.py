"""Dense factorisations that know how far they can be trusted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from tyrefrf.arrays import ComplexArray, IntArray
from tyrefrf.errors import SingularError

RCOND_MIN = 1e-13
"""Reciprocal condition below which a matrix counts as singular: a solution would keep less than
three digits. Damped tyres stay far above (measured from 0 to 3000 Hz, tests/solvers/
test_singular.py): 4e-6 where homogeneous with eta = 0.1, 2e-9 with a belt of loss-free steel,
5e-10 with that and eta = 0.03. Undamped ones lose digits long before they come here: those lines
are known by their residual."""


@dataclass(frozen=True, slots=True, eq=False)
class Factor:
    """LU factors (n, n) of a matrix and their pivots."""

    lu: ComplexArray
    pivots: IntArray

    def solve(self, B: ComplexArray, *, transposed: bool = False) -> ComplexArray:
        """A^-1 B, or A^-T B, for right-hand sides (n, m)."""
        X, _ = lapack.zgetrs(self.lu, self.pivots, B, trans=0 if transposed else 1)
        return X


def factorise(A: ComplexArray) -> Factor:
    """Factorise A (n, n) with partial pivoting; A^T in fact, which needs no copy to LAPACK's order.

    Raises SingularError where the estimated reciprocal condition (LAPACK's zgecon, 1-norm) is
    below RCOND_MIN.
    """
    norm = np.abs(A).sum(axis=1).max()
    lu, pivots, info = lapack.zgetrf(A.T)
    rcond = lapack.zgecon(lu, norm)[0] if info == 0 else 0.0
    if not rcond >= RCOND_MIN:
        raise SingularError(
            f"singular to working precision (reciprocal condition {rcond:.1e}): an undamped "
            "resonance lies on this line, or nothing holds the tyre; add a loss factor, fix the "
            "rim, or move the line"
        )
    return Factor(lu, pivots)
