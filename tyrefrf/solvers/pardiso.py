"""The ring's systems by MKL PARDISO."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.errors import SingularError
from tyrefrf.solvers.mkl import MATCHED, Pardiso
from tyrefrf.solvers.sparse import PIVOT_RESIDUAL, Scattered

REMARK = "PARDISO lost digits on its diagonal pivots here: matched pivots, refined"


class PardisoSystem:
    """MKL PARDISO's L D L^T; the pattern is analysed once.

    memory: what a factorisation takes [bytes], by the analysis; factor_entries: how many L has.
    """

    def __init__(self, matrix: Scattered) -> None:
        self._upper = matrix.upper().compressed()
        self._pardiso = Pardiso(self._upper.indptr, self._upper.indices)
        self.memory = self._pardiso.memory
        self.factor_entries = self._pardiso.factor_entries

    def solve(self, values: ComplexArray, f: ComplexArray) -> tuple[ComplexArray, str]:
        """A^-1 f (n, m) for the matrix that these values make, and a remark (mostly "").

        As with `solve_sparse`, pivots that stay near the diagonal lose digits where a part of
        the undamped tyre resonates on its own; PARDISO calls no pivot zero or perturbed there,
        but the residual tells. Such a line is solved once more with `MATCHED`.
        Raises SingularError where a pivot is zero even then.
        """
        entries = self._upper.entries(values)
        try:
            x = self._pardiso.solve(entries, f)
            if np.all(self._residuals(entries, x, f) <= PIVOT_RESIDUAL):
                return x, ""
        except SingularError:
            pass
        self._pardiso.release_factor()
        again = Pardiso(self._upper.indptr, self._upper.indices, MATCHED, entries)
        return again.solve(entries, f), REMARK

    def _residuals(self, entries: ComplexArray, x: ComplexArray, f: ComplexArray) -> FloatArray:
        """||A x - f|| / ||f|| of every column, from the upper triangle U: A = U + U^T - diag U."""
        U = csr_array((entries, self._upper.indices, self._upper.indptr), shape=2 * (len(f),))
        diagonal = U.diagonal()[:, None]
        lack = U @ x + U.T @ x - diagonal * x - f
        return np.linalg.norm(lack, axis=0) / np.linalg.norm(f, axis=0)
