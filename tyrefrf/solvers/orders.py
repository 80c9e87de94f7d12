"""The ring's equations by circumferential order: A_h = P_h^H D P_h.

With q_{j+1} = q_j exp(i mu), mu = 2 pi h / N, a cell's displacements follow from its own dofs,
P_h = [own; right section = left section times exp(i mu)], and the right section's forces come
home to the left one with exp(-i mu).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from tyrefrf.fem.assembly import CellMatrices


@dataclass(frozen=True, slots=True, eq=False)
class Folded:
    """A cell's matrix as entries of A = straight + on exp(i mu) + back exp(-i mu)."""

    straight: ComplexArray | FloatArray
    on: ComplexArray | FloatArray
    back: ComplexArray | FloatArray

    def at(self, mu: float) -> ComplexArray:
        """Entries of A_h at mu = 2 pi h / N."""
        turn = np.exp(1j * mu)
        return self.straight + turn * self.on + self.back / turn


class Orders:
    """Folds a cell's matrices onto its own dofs that move; index maps are made once.

    n: size of A_h.
    """

    def __init__(self, cell: CellMatrices) -> None:
        n_own = cell.n_own
        free = ~cell.fixed[:n_own]
        self.n = int(free.sum())
        self._keep = ~(cell.fixed[cell.rows] | cell.fixed[cell.indices])
        rows, columns = cell.rows[self._keep], cell.indices[self._keep]
        turns = (columns >= n_own).astype(int) - (rows >= n_own)  # exponents of exp(i mu)
        number = np.cumsum(free) - 1
        row, column = (number[np.where(d >= n_own, d - n_own, d)] for d in (rows, columns))
        keys, slot = np.unique(column * self.n + row, return_inverse=True)
        self._indices = keys % self.n
        self._indptr = np.searchsorted(keys, np.arange(self.n + 1) * self.n)
        self._collect = [_collector(slot, turns == turn, len(keys)) for turn in (0, 1, -1)]

    @property
    def pattern(self) -> csc_array:
        """Ones where A_h (n, n) has entries."""
        return self.matrix(np.ones(len(self._indices)))

    def folded(self, entries: ComplexArray | FloatArray) -> Folded:
        """A matrix in the cell's pattern (nnz,), folded."""
        kept = entries[self._keep]
        return Folded(*(collect @ kept for collect in self._collect))

    def matrix(self, entries: ComplexArray | FloatArray) -> csc_array:
        """A_h (n, n) as scipy knows it, from what `Folded.at` gives."""
        return csc_array((entries, self._indices, self._indptr), shape=(self.n, self.n))


def _collector(slot: IntArray, here: BoolArray, n_slots: int) -> csr_array:
    """Sums the cell's entries that are `here` into the folded pattern."""
    entries = np.flatnonzero(here)
    return csr_array((np.ones(len(entries)), (slot[entries], entries)), shape=(n_slots, len(slot)))
