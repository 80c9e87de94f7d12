"""Sparse complex symmetric systems: one pattern, new entries on every line, solved by SuperLU."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import spilu, splu

from tyrefrf.arrays import ComplexArray, FloatArray, IntArray
from tyrefrf.errors import SingularError

Ordering = Literal["NATURAL", "MMD_AT_PLUS_A"]

PIVOT_RESIDUAL = 1e-10
"""Relative residual up to which diagonal pivots are trusted; damped tyres stay below it."""


@dataclass(frozen=True, slots=True, eq=False)
class Scattered:
    """A symmetric matrix (n, n) as a sum: values[source[k]] is added at (rows[k], columns[k]).

    values: what changes from line to line, such as the entries of one cell's matrix; the places
    stay.
    """

    n: int
    rows: IntArray
    columns: IntArray
    source: IntArray

    def reordered(self, order: IntArray) -> Scattered:
        """The same with order[k] as its k-th row and column."""
        place = np.argsort(order)
        return Scattered(self.n, place[self.rows], place[self.columns], self.source)

    def upper(self) -> Scattered:
        """What stands on and above the diagonal."""
        kept = self.rows <= self.columns
        return Scattered(self.n, self.rows[kept], self.columns[kept], self.source[kept])

    def compressed(self) -> Compressed:
        """By rows, or by the columns of the transpose."""
        keys = self.rows * self.n + self.columns
        order = np.argsort(keys, kind="stable")
        keys = keys[order]
        starts = np.flatnonzero(np.diff(keys, prepend=-1))
        return Compressed(
            indptr=np.searchsorted(keys[starts], np.arange(self.n + 1) * self.n),
            indices=keys[starts] % self.n,
            _source=self.source[order],
            _starts=starts,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Compressed:
    """The pattern of a sparse matrix (n, n), indptr and sorted indices, and its filling."""

    indptr: IntArray
    indices: IntArray
    _source: IntArray
    _starts: IntArray

    @property
    def n(self) -> int:
        """Rows, and columns."""
        return len(self.indptr) - 1

    def entries(self, values: ComplexArray) -> ComplexArray:
        """Entries (nnz,) of the matrix that these values make."""
        return np.add.reduceat(values[self._source], self._starts)

    def of(self, entries: ComplexArray | FloatArray) -> csc_array:
        """A symmetric matrix as scipy knows it: its rows are its columns."""
        return csc_array((entries, self.indices, self.indptr), shape=(self.n, self.n))


class SuperLU:
    """scipy's SuperLU. The order of elimination is found once, from the pattern.

    On the paper's homogeneous and quadratic tyres the order takes a tenth of a factorisation.
    """

    def __init__(self, matrix: Scattered) -> None:
        self._order = minimum_degree(matrix.compressed())
        self._pattern = matrix.reordered(self._order).compressed()

    def solve(self, values: ComplexArray, f: ComplexArray) -> tuple[ComplexArray, str]:
        """A^-1 f (n, m) for the matrix that these values make, and "".

        Raises SingularError as `solve_sparse` does.
        """
        A = self._pattern.of(self._pattern.entries(values))
        x = np.empty(f.shape, complex)
        x[self._order] = solve_sparse(A, f[self._order], ordering="NATURAL")
        return x, ""


def solve_sparse(
    A: csc_array, f: ComplexArray, ordering: Ordering = "MMD_AT_PLUS_A"
) -> ComplexArray:
    """A^-1 f (n, m) by SuperLU, for a structurally symmetric A.

    ordering: SuperLU's permc_spec, a minimum degree of A + A^T or the order that A is in.

    The diagonal is kept as pivots, which fills least. Without damping that can lose every digit
    (a part of the tyre that resonates on its own is a singular leading block), so where the
    residual tells of it, the matrix is factorised once more with pivots from off the diagonal.
    Raises SingularError where a pivot is exactly zero even then; else the line's residual tells.
    """
    for threshold in (0.0, 0.1):
        try:
            x = splu(
                A,
                permc_spec=ordering,
                diag_pivot_thresh=threshold,
                options={"SymmetricMode": True},
            ).solve(f)
        except RuntimeError as error:
            if threshold:
                raise SingularError("no solution: the equations are exactly singular") from error
            continue
        if np.all(np.linalg.norm(A @ x - f, axis=0) <= PIVOT_RESIDUAL * np.linalg.norm(f, axis=0)):
            break
    return x


def minimum_degree(pattern: Compressed) -> IntArray:
    """SuperLU's order of elimination (n,) for a structurally symmetric pattern.

    An incomplete factorisation that keeps nothing beside the diagonal is what shows SuperLU's
    minimum degree of A + A^T without the price of factorising.
    """
    A = dominant(pattern.of(np.ones(len(pattern.indices))))
    factor = spilu(
        A,
        drop_tol=1.0,
        fill_factor=1.0,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return np.argsort(factor.perm_c)


def dominant(pattern: csc_array) -> csc_array:
    """A matrix of this pattern, whose diagonal is full, that any order of elimination factorises.

    -1 off the diagonal, and on it more than they add up to.
    """
    A = csc_array(pattern, dtype=float, copy=True)
    A.data[:] = -1.0
    A.setdiag(1.0 + np.diff(A.indptr))
    return A


def factor_entries(pattern: Compressed, order: IntArray) -> int:
    """Entries of L and U together, pivots counted twice, without factorising the matrix.

    Dofs whose columns have the same pattern (those of a node, or of the nodes of one edge
    through the tyre's thickness) are eliminated together and fill the same places, so a small
    matrix with one row for each such group tells all: n/3 rows and less, real numbers.
    """
    ones = pattern.of(np.ones(len(pattern.indices)))
    marks = ones @ np.random.default_rng(0).random(pattern.n)  # equal for equal patterns
    _, group, size = np.unique(marks[order], return_inverse=True, return_counts=True)
    last = np.zeros(len(size), np.int64)
    last[group] = np.arange(pattern.n)  # where its last dof stands in the order
    groups = np.argsort(last)
    one_each = order[last[groups]]
    lu = splu(
        dominant(csc_array(ones[one_each][:, one_each])),
        permc_spec="NATURAL",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    weight = size[groups].astype(float)
    filled = csc_array((np.ones(lu.L.nnz), lu.L.indices, lu.L.indptr), shape=lu.L.shape)
    return int(2.0 * (weight @ (filled @ weight)) - weight @ weight) + pattern.n
