"""The circumferential orders of a ring in banded factorisations.

Numbered along the profile, A_h is a narrow band. The bands of several orders stand one after
another in one matrix for LAPACK, as many as stay in a core's cache until they are solved for; the
factor of A_h serves A_-h = A_h^T too. Where each entry of the cell's matrix goes is found once: a
line then costs two products and LAPACK's work.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from tyrefrf.arrays import ComplexArray, FloatArray, IntArray
from tyrefrf.errors import SingularError
from tyrefrf.solvers.orders import Folded, Orders

CACHED = 1 << 15
"""Complex numbers that are factorised at once; 512 KiB."""


class BandedOrders:
    """Q^T A_h Q at some orders h, for motions Q (n, m) that mix with no others.

    Q has one nonzero at most in each row: every dof moves in one of the motions.
    """

    def __init__(self, orders: Orders, Q: csc_array, n_cells: int, h: IntArray) -> None:
        entries, rows, columns, weights = _projected(orders.pattern, Q)
        order = _narrow(rows, columns, Q.shape[1])
        place = np.argsort(order)
        rows, columns = place[rows], place[columns]
        self.Q, self.h, self.m = Q[:, order], h, Q.shape[1]
        self.width = int(np.max(np.abs(rows - columns)))
        self._height = 3 * self.width + 1  # LAPACK's band, with room for what pivots fill
        turn = np.exp(2j * np.pi * h / n_cells)
        self._turns = np.stack([np.ones(len(h)), turn, 1.0 / turn], axis=1)
        slot = columns * self._height + 2 * self.width + rows - columns
        used, place = np.unique(slot, return_inverse=True)
        shape = len(used), orders.pattern.nnz
        self._collect = csr_array((weights, (place, entries)), shape=shape)
        self._used = used
        of_one = self.m * self._height
        self._at_once = max(1, CACHED // of_one)
        self._workspace = np.empty((min(len(h), self._at_once), of_one), complex)

    def solve(
        self, D: Folded, f: ComplexArray, g: ComplexArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """A_h^-1 f_h and A_h^-T g_h for right-hand sides f (h, m, k) and g (h, m, l).

        Raises SingularError where a pivot is exactly zero.
        """
        parts = np.stack([D.straight, D.on, D.back], axis=1)
        entries = (self._collect @ parts.view(float)).view(complex).T
        x, y = np.empty_like(f), np.empty_like(g)
        for start in range(0, len(self.h), self._at_once):
            block = slice(start, start + self._at_once)
            factor = self._factorised(self._turns[block] @ entries)
            x[block] = factor.solve(f[block])
            if g.size:
                y[block] = factor.solve(g[block], transposed=True)
        return x, y

    def _factorised(self, entries: ComplexArray) -> BandedFactor:
        """The factor, good until the next, of orders whose entries (h, slots) these are."""
        band = self._workspace[: len(entries)]
        band[...] = 0.0
        band[:, self._used] = entries
        ab = band.reshape(-1, self._height).T
        lu, pivots, info = lapack.zgbtrf(ab, self.width, self.width, overwrite_ab=True)
        if info > 0:
            raise SingularError("no solution: the equations are exactly singular")
        return BandedFactor(lu, pivots, self.width)


@dataclass(frozen=True, slots=True, eq=False)
class BandedFactor:
    """LU factors of A_h, order after order, in LAPACK's band storage, and their pivots."""

    lu: ComplexArray
    pivots: IntArray
    width: int

    def solve(self, f: ComplexArray, *, transposed: bool = False) -> ComplexArray:
        """A_h^-1 f_h, or A_h^-T f_h, for right-hand sides (h, m, k)."""
        b = f.reshape(-1, f.shape[2])
        x, _ = lapack.zgbtrs(self.lu, self.width, self.width, b, self.pivots, trans=int(transposed))
        return x.reshape(f.shape)


def _projected(pattern: csc_array, Q: csc_array) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
    """Entries of A by their numbers, where each goes in Q^T A Q, and its weight there."""
    motion, weight = np.zeros(Q.shape[0], int), np.zeros(Q.shape[0])
    coo = Q.tocoo()
    motion[coo.row], weight[coo.row] = coo.col, coo.data
    A = pattern.tocoo()
    weights = weight[A.row] * weight[A.col]
    kept = np.flatnonzero(weights)
    return kept, motion[A.row[kept]], motion[A.col[kept]], weights[kept]


def _narrow(rows: IntArray, columns: IntArray, m: int) -> IntArray:
    """The order (m,) of the motions with the narrower band: theirs, or Cuthill and McKee's."""
    pattern = csr_array((np.ones(len(rows)), (rows, columns)), shape=(m, m))
    thin = np.asarray(reverse_cuthill_mckee(pattern, symmetric_mode=True))
    place = np.argsort(thin)
    widths = [np.max(np.abs(rows - columns)), np.max(np.abs(place[rows] - place[columns]))]
    return thin if widths[1] < widths[0] else np.arange(m)
