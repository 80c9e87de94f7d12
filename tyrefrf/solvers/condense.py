"""Elimination of the cell's interior dofs: [2]-[5], loads inside the cell included."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tyrefrf.arrays import ComplexArray, IntArray
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.solvers.chain import Chain
from tyrefrf.solvers.factor import Factor, factorise


@dataclass(frozen=True, slots=True, eq=False)
class Interior:
    """What brings the interior back: q_I = D_II^-1 f_I - X_L q_L - X_R q_R.

    factor: of D_II (n_I, n_I); D_LI, D_RI: (n, n_I); X_L, X_R: (n_I, n).
    """

    factor: Factor
    D_LI: ComplexArray
    D_RI: ComplexArray
    X_L: ComplexArray
    X_R: ComplexArray


class Condenser:
    """Turns the cell's sparse D into the dense face stiffness, with index maps made once."""

    def __init__(self, cell: CellMatrices) -> None:
        moves = ~cell.fixed
        self.n_face = int(moves[: cell.n_face].sum())
        self.n_inner = int(moves[cell.n_face : cell.n_own].sum())
        number = np.cumsum(moves) - 1
        self._keep = moves[cell.rows] & moves[cell.indices]
        self._rows: IntArray = number[cell.rows[self._keep]]
        self._columns: IntArray = number[cell.indices[self._keep]]

    def __call__(self, D: ComplexArray) -> tuple[Chain, Interior]:
        """The single-cell chain of [4] and the interior's recovery, from D's entries (nnz,).

        Raises SingularError if the cell, faces fixed, resonates without damping.
        """
        n, n_i = self.n_face, self.n_inner
        A = np.zeros((2 * n + n_i,) * 2, complex)
        A[self._rows, self._columns] = D[self._keep]
        L, I, R = slice(0, n), slice(n, n + n_i), slice(n + n_i, None)  # noqa: E741  the paper's I
        factor = factorise(A[I, I]) if n_i else Factor(A[I, I], np.empty(0, np.int64))
        X = factor.solve(np.hstack([A[I, L], A[I, R]])) if n_i else np.empty((0, 2 * n), complex)
        X_L, X_R = X[:, :n], X[:, n:]
        chain = Chain(
            n_cells=1,
            LL=A[L, L] - A[L, I] @ X_L,
            LR=A[L, R] - A[L, I] @ X_R,
            RR=A[R, R] - A[R, I] @ X_R,
        )
        return chain, Interior(factor, A[L, I], A[R, I], X_L, X_R)
