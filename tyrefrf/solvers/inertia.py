"""How many eigenvalues lie below a shift, without computing one: Sylvester's law of inertia.

A Hermitian A = L D L^H has as many negative eigenvalues as D has negative entries, so the negative
pivots of K - sigma M count the omega^2 below sigma.
Source: Parlett, The Symmetric Eigenvalue Problem (1998), section 3.3.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import SuperLU, splu

from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.solvers.orders import Folded, Orders
from tyrefrf.solvers.rigid import RigidMotions

RESIDUAL_TRUSTED = 1e-6
"""Of a solve with the factors, relative to the right-hand side: it grows with the factors'
rounding and with 1/(distance of the shift from the nearest eigenvalue), the two things that could
turn a pivot's sign."""
HELD, FREE = 1e-13, 1e-8
"""Of trace K / trace M: what is added to K as so much mass, so that motions without stiffness do
not count as unstable by rounding: of matrices made here, and, where rigid motions cost nothing, of
matrices from files with seven digits. An instability that grows more slowly than exp(s t) goes
unseen: on the paper's layered tyre s = 0.2/s, and were it free, 60/s."""


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


def unstable_orders(
    cell: CellMatrices, n_cells: int, orders: Iterable[int] | None = None
) -> dict[int, int]:
    """Circumferential orders at which the static stiffness is indefinite, and by how many.

    Counts the negative eigenvalues of the loss-free K + K_G + K_P at rest. An empty answer: the
    tyre is stable. orders: where to look; everywhere by default.
    """
    folding, diagonal, static = Orders(cell), cell.rows == cell.indices, cell.static
    rounding = FREE if RigidMotions.of(cell, n_cells).count else HELD
    shift = rounding * np.abs(static[diagonal]).sum() / cell.M[diagonal].sum()
    folded = folding.folded(static + shift * cell.M)
    return _counts(folding, folded, n_cells, range(n_cells // 2 + 1) if orders is None else orders)


def negative_masses(cell: CellMatrices, n_cells: int) -> dict[int, int]:
    """Circumferential orders at which the mass is indefinite, and by how many."""
    folding, diagonal, static = Orders(cell), cell.rows == cell.indices, cell.static
    shift = HELD * cell.M[diagonal].sum() / np.abs(static[diagonal]).sum()  # not all have mass
    folded = folding.folded(cell.M + shift * static)
    return _counts(folding, folded, n_cells, range(n_cells // 2 + 1))


def _counts(folding: Orders, folded: Folded, n_cells: int, orders: Iterable[int]) -> dict[int, int]:
    """Negative eigenvalues by order, of the orders that have any."""
    counts = {
        h: negative_eigenvalues(folding.matrix(folded.at(2.0 * np.pi * h / n_cells)))
        for h in orders
    }
    return {h: count for h, count in counts.items() if count}
