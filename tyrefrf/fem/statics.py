"""The cell at circumferential order 0: both sections move alike in cylindrical dofs."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from tyrefrf.arrays import FloatArray
from tyrefrf.errors import SolveError
from tyrefrf.fem.assembly import CellMatrices


class PeriodicCell:
    """Folds a cell's vectors and matrices onto its own dofs, and solves there.

    free: (n_own,) own dofs that move.
    """

    def __init__(self, cell: CellMatrices) -> None:
        dofs = np.arange(cell.n_dofs)
        self._own = np.where(dofs >= cell.n_own, dofs - cell.n_own, dofs)
        self._n_own = cell.n_own
        self.free = ~cell.fixed[: cell.n_own]
        self._keep = ~(cell.fixed[cell.rows] | cell.fixed[cell.indices])
        number = np.cumsum(self.free) - 1
        self._rows = number[self._own[cell.rows[self._keep]]]
        self._columns = number[self._own[cell.indices[self._keep]]]

    def folded(self, f: FloatArray) -> FloatArray:
        """Forces (n,) of a cell summed onto its own dofs (n_own,), the right section's too."""
        return np.bincount(self._own, weights=f, minlength=self._n_own).astype(float, copy=False)

    def solve(self, entries: FloatArray, f: FloatArray) -> FloatArray:
        """Displacements (n,) of the cell under folded forces f (n_own,), zero where fixed.

        entries: (nnz,) of a stiffness in the cell's pattern. Raises SolveError if singular.
        """
        n = int(self.free.sum())
        A = csc_array((entries[self._keep], (self._rows, self._columns)), shape=(n, n))
        try:
            x = splu(A).solve(f[self.free])
        except RuntimeError as error:
            raise SolveError("nothing holds the tyre against the pressure") from error
        q = np.zeros(self._n_own)
        q[self.free] = x
        return q[self._own]
