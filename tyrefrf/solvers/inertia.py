"""How many eigenvalues lie below a shift, without computing one: Sylvester's law of inertia.

A Hermitian A = L D L^H has as many negative eigenvalues as D has negative entries, so the negative
pivots of K - sigma M count the omega^2 below sigma.
Source: Parlett, The Symmetric Eigenvalue Problem (1998), section 3.3.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import SuperLU, splu

from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.solvers.orders import Orders

RESIDUAL_TRUSTED = 1e-6
"""Of a solve with the factors, relative to the right-hand side: it grows with the factors'
rounding and with 1/(distance of the shift from the nearest eigenvalue), the two things that could
turn a pivot's sign."""


def negative_eigenvalues(A: csc_array) -> int:
    """How many eigenvalues of a Hermitian matrix (n, n) are negative.

    By SuperLU's diagonal pivots; where it left the diagonal, or the factors cannot be trusted, by
    all eigenvalues of the dense matrix. An eigenvalue within rounding of zero counts either way.
    """
    factor = symmetric_factor(A)
    if factor is not None and _trusted(A, factor):
        return int(np.sum(factor.U.diagonal().real < 0.0))
    return int(np.sum(np.linalg.eigvalsh(A.toarray()) < 0.0))


def symmetric_factor(A: csc_array) -> SuperLU | None:
    """SuperLU factors with pivots from the diagonal; None where a pivot is exactly zero."""
    try:
        return splu(
            A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError:
        return None


def _trusted(A: csc_array, factor: SuperLU) -> bool:
    """Whether the pivots stood on the diagonal, and the factors solve what they should."""
    if not np.array_equal(factor.perm_r, factor.perm_c):
        return False
    f = start_vector(A)
    lack = np.linalg.norm(A @ factor.solve(f) - f)
    return bool(lack <= RESIDUAL_TRUSTED * np.linalg.norm(f))  # False where it is NaN


def start_vector(A: csc_array) -> np.ndarray:
    """A vector (n,) of A's type that is orthogonal to nothing, the same in every run."""
    return np.random.default_rng(0).uniform(0.5, 1.5, A.shape[0]).astype(A.dtype)


def unstable_orders(cell: CellMatrices, n_cells: int) -> dict[int, int]:
    """Circumferential orders at which the static stiffness is indefinite, and by how many.

    Counts the negative eigenvalues of the loss-free K + K_G + K_P at rest. An empty answer: the
    tyre is stable.
    """
    orders = Orders(cell)
    folded = orders.folded(sum(cell.K.values(), start=cell.K_G + cell.K_P))
    counts = {
        h: negative_eigenvalues(orders.matrix(folded.at(2.0 * np.pi * h / n_cells)))
        for h in range(n_cells // 2 + 1)
    }
    return {h: count for h, count in counts.items() if count}
