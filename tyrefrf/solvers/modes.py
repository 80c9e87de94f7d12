"""Undamped natural modes of the ring by circumferential order, none missed.

K_h phi = omega^2 M_h phi with the cell's matrices folded as `orders` folds them. What is found at
every order is held against the number of eigenvalues below the cut-off by Sylvester's law.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import LinAlgError, eigh
from scipy.sparse import csc_array
from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.errors import SolveError
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.solvers.inertia import negative_eigenvalues, start_vector, symmetric_factor
from tyrefrf.solvers.orders import Folded, Orders

SHIFT = 0.01
"""Where the spectrum is inverted, relative to the cut-off's omega^2 and below zero: a free tyre's
K + shift M is positive definite, and its zero eigenvalues do not outweigh the others."""
NUDGES = (0.0, 1e-9, 1e-6, 1e-3)
"""Shares by which a cut-off is raised when an eigenvalue may lie on it; the modes between are
found, and dropped again."""
DENSE_SIZE, DENSE_SHARE = 60, 0.2
"""Size up to which, and share of it wanted from which on, all eigenvalues cost less than some."""
ZERO = 1e-12
"""omega^2 of a rigid motion, relative to the largest diagonal of K over M: rounding."""
RESIDUAL_MAX = 1e-6
"""Largest ||K phi - omega^2 M phi|| relative to (omega^2 + shift) ||M phi||."""
START, LEAST = 1e-3, 1e-4
"""Where a cut-off is first sought, and below which no lower one is, relative to the square root of
that diagonal: a free tyre has six modes below any, a buckled one too."""
MARGIN = 1.15
"""A cut-off for a number of modes may find as many times more; they are dropped."""


@dataclass(frozen=True, slots=True, eq=False)
class OrderModes:
    """Undamped modes of one circumferential order.

    order: h, 0 <= h <= N // 2. n_members: 1 for h = 0 and h = N/2, else 2: h and N - h, whose
        shapes are conjugate, make a pair.
    omega: (m,) [rad/s], ascending; a free tyre's rigid motions have zero.
    shapes: (n, m) over the cell's own dofs that move, as `Orders` numbers them; cell j moves with
        shape * exp(2 pi i h j / N). phi^H M_h phi = 1; the largest component is real and positive.
    residual: (m,) ||K phi - omega^2 M phi|| / ((omega^2 + shift) ||M phi||), shift > 0.
    """

    order: int
    n_members: int
    omega: FloatArray
    shapes: ComplexArray
    residual: FloatArray

    def first(self, m: int) -> OrderModes:
        """The lowest m of them."""
        return replace(
            self, omega=self.omega[:m], shapes=self.shapes[:, :m], residual=self.residual[:m]
        )


def ring_modes(
    cell: CellMatrices,
    n_cells: int,
    *,
    below: float | None = None,
    count: int | None = None,
    at: float = 0.0,
) -> tuple[OrderModes, ...]:
    """The modes of every order h = 0 .. N // 2 in turn, undamped.

    Either below: all with omega < below [rad/s]; or count: the lowest `count` of the whole ring,
    both members of a pair counted and no pair split. at: omega [rad/s] at which the materials'
    storage moduli are taken.
    Raises SolveError where the static stiffness is indefinite (a buckled tyre), or the modes do
    not come to as many as they are.
    """
    pencils = Pencils(cell, n_cells, at)
    if (below is None) == (count is None):
        raise ValueError("either `below` or `count`")
    if count is None:
        assert below is not None
        return tuple(modes_below(pencil, below) for pencil in pencils)
    cutoff = cutoff_for(pencils.count_below, pencils, count)
    return lowest(tuple(modes_below(pencil, cutoff) for pencil in pencils), count)


@dataclass(frozen=True, slots=True, eq=False)
class Pencil:
    """K_h and M_h of one order: Hermitian, real where the order is its own conjugate."""

    order: int
    n_members: int
    K: csc_array
    M: csc_array

    @property
    def n(self) -> int:
        """Size."""
        return int(self.K.shape[0])

    @property
    def scale(self) -> float:
        """The largest diagonal entry of K relative to that of M: about the highest omega^2."""
        return float(np.max(np.abs(self.K.diagonal()) / np.abs(self.M.diagonal())))

    def shift(self, cutoff: float) -> float:
        """By how much the spectrum is lifted for modes below a cut-off, which may be infinite."""
        return SHIFT * min(cutoff**2, self.scale)

    def minus(self, sigma: float) -> csc_array:
        """K - sigma M."""
        K, M = self.K, self.M
        return csc_array((K.data - sigma * M.data, K.indices, K.indptr), shape=K.shape)

    def count_below(self, omega: float) -> int:
        """How many modes have a frequency below omega [rad/s], by inertia."""
        return self.n if np.isinf(omega) else negative_eigenvalues(self.minus(omega**2))


class Pencils:
    """The undamped ring: a pencil for every order, at storage moduli of one frequency."""

    def __init__(self, cell: CellMatrices, n_cells: int, at: float = 0.0) -> None:
        self.n_cells = n_cells
        self._cell = cell
        self._orders = Orders(cell)
        self._K = self._orders.folded(storage_stiffness(cell, at))
        self._M = self._orders.folded(cell.M)

    def at(self, omega: float) -> Pencils:
        """The same ring at storage moduli of omega [rad/s]."""
        other = copy(self)
        other._K = self._orders.folded(storage_stiffness(self._cell, omega))
        return other

    def __iter__(self) -> Iterator[Pencil]:
        return (self.of(h) for h in range(self.n_cells // 2 + 1))

    def of(self, h: int) -> Pencil:
        """The pencil of order h."""
        N = self.n_cells
        K, M = (self._matrix(folded, h) for folded in (self._K, self._M))
        return Pencil(order=h, n_members=1 if 2 * h % N == 0 else 2, K=K, M=M)

    def count_below(self, omega: float) -> int:
        """How many modes of the ring, both members of pairs, have a frequency below omega."""
        return sum(pencil.n_members * pencil.count_below(omega) for pencil in self)

    def _matrix(self, folded: Folded, h: int) -> csc_array:
        entries = folded.at(2.0 * np.pi * h / self.n_cells)
        real = 2 * h % self.n_cells == 0
        return self._orders.matrix(entries.real if real else entries)


def storage_stiffness(cell: CellMatrices, omega: float) -> FloatArray:
    """Entries (nnz,) of the loss-free stiffness: Re K(omega) + K_G + K_P."""
    parts = (cell.relaxation[name].stiffness(K, omega).real for name, K in cell.K.items())
    return sum(parts, start=cell.K_G + cell.K_P)


def modes_below(pencil: Pencil, omega: float) -> OrderModes:
    """All modes of one order with a frequency below omega [rad/s].

    Raises SolveError as `ring_modes`.
    """
    for nudge in NUDGES:
        cutoff = omega * (1.0 + nudge)
        found = _as_many_as_there_are(pencil, cutoff)
        if found is not None:
            return found.first(int(np.searchsorted(found.omega, omega)))
    raise SolveError(
        f"circumferential order {pencil.order}: the modes below {omega / (2.0 * np.pi):.6g} Hz do "
        "not come to as many as the inertia of K - omega^2 M counts; try another cut-off"
    )


def _as_many_as_there_are(pencil: Pencil, cutoff: float) -> OrderModes | None:
    """The modes below a cut-off if they are as many as the inertia counts, by some method."""
    counted = pencil.count_below(cutoff)
    wanted_by_value = pencil.n <= DENSE_SIZE or counted > DENSE_SHARE * pencil.n
    methods = (_by_dense,) if wanted_by_value else (_by_lanczos, _by_dense)
    for method in methods:
        if counted == 0:
            return _ordered(pencil, np.empty((pencil.n, 0)), cutoff)
        shapes = method(pencil, cutoff, counted)
        found = None if shapes is None else _ordered(pencil, shapes, cutoff)
        if found is not None and len(found.omega) == counted:
            return found
    return None


def _by_lanczos(pencil: Pencil, cutoff: float, counted: int) -> ComplexArray | FloatArray | None:
    """Vectors (n, m >= counted) that span the lowest modes, by ARPACK on the inverted spectrum."""
    shift = pencil.shift(cutoff)
    A = pencil.minus(-shift)
    factor = symmetric_factor(A)
    if factor is None:
        return None
    inverse = LinearOperator(A.shape, factor.solve, dtype=A.dtype)
    try:
        _, shapes = eigsh(
            pencil.K, counted + 2, pencil.M, -shift, OPinv=inverse, v0=start_vector(A)
        )
    except ArpackError:
        return None
    return shapes


def _by_dense(pencil: Pencil, cutoff: float, counted: int) -> ComplexArray | FloatArray:
    """The same by LAPACK, from M phi = (K + shift M) phi / (omega^2 + shift).

    This way round low modes are the largest eigenvalues, and keep their digits.
    """
    shift = pencil.shift(cutoff)
    first = max(pencil.n - counted - 2, 0)
    A, M = pencil.minus(-shift).toarray(), pencil.M.toarray()
    try:
        _, shapes = eigh(M, A, subset_by_index=(first, pencil.n - 1))
    except LinAlgError as error:
        raise _buckled(pencil.order) from error
    return shapes


def _ordered(pencil: Pencil, shapes: ComplexArray | FloatArray, cutoff: float) -> OrderModes | None:
    """The modes below the cut-off in the span of some vectors (n, m), by Rayleigh and Ritz.

    None where the vectors are dependent, or a mode's residual is too large.
    """
    K, M = pencil.K, pencil.M
    try:
        squared, turn = eigh(shapes.conj().T @ (K @ shapes), shapes.conj().T @ (M @ shapes))
    except LinAlgError:
        return None
    inside = squared < cutoff**2
    squared, phi = squared[inside], shapes @ turn[:, inside]
    zero = ZERO * pencil.scale
    if np.any(squared < -zero):
        raise _buckled(pencil.order)
    shift = pencil.shift(cutoff)
    inertia_force = M @ phi
    residual = np.linalg.norm(K @ phi - inertia_force * squared, axis=0)
    residual /= (np.abs(squared) + shift) * np.linalg.norm(inertia_force, axis=0)
    if np.any(residual > RESIDUAL_MAX):
        return None
    return OrderModes(
        order=pencil.order,
        n_members=pencil.n_members,
        omega=np.sqrt(np.where(squared < zero, 0.0, squared)),
        shapes=turned(phi.astype(complex)),
        residual=residual,
    )


def turned(phi: ComplexArray) -> ComplexArray:
    """Shapes (n, m) with the phase at which their largest component is real and positive."""
    if not phi.size:
        return phi
    largest = np.take_along_axis(phi, np.argmax(np.abs(phi), axis=0)[None], axis=0)
    return phi * (np.abs(largest) / largest)


def _buckled(order: int) -> SolveError:
    return SolveError(
        f"circumferential order {order}: the static stiffness is indefinite: the tyre has buckled "
        "and has no natural modes about this state; lower the pressure, or stiffen the tyre"
    )


def cutoff_for(count_below: Callable[[float], int], pencils: Pencils, count: int) -> float:
    """A frequency [rad/s] with at least `count` modes of the ring below it, and few more.

    count_below: modes below a frequency, which never falls. Infinite where the ring has no more.
    """
    if count >= sum(pencil.n_members * pencil.n for pencil in pencils):
        return np.inf
    counts: dict[float, int] = {}
    top = float(np.sqrt(pencils.of(0).scale))
    omega = START * top
    while True:
        counts[omega] = count_below(omega)
        if counts[omega] >= count and omega < LEAST * top:
            return omega
        enough = [w for w, found in counts.items() if found >= count]
        short = [w for w, found in counts.items() if found < count]
        if not short or not enough:
            omega *= 0.5 if enough else 2.0
            continue
        low, high = max(short), min(enough)
        if counts[high] <= MARGIN * count or high / low < 1.0 + 1e-6:
            return high
        omega = float(np.sqrt(low * high))


def lowest(modes: Sequence[OrderModes], count: int) -> tuple[OrderModes, ...]:
    """The lowest `count` modes of the ring out of more, no pair split."""
    omega = np.concatenate([m.omega for m in modes])
    order = np.repeat(np.arange(len(modes)), [len(m.omega) for m in modes])
    members = np.array([m.n_members for m in modes])[order]
    ascending = np.argsort(omega, kind="stable")
    before = np.cumsum(members[ascending]) - members[ascending]
    kept = np.bincount(order[ascending][before < count], minlength=len(modes))
    return tuple(m.first(k) for m, k in zip(modes, kept, strict=True))
