"""Natural modes whose moduli are those at their own frequency: K'(omega) phi = omega^2 M phi.

A nonlinear eigenproblem, solved order by order on a subspace that grows until every mode's
residual is small. On it the j-th mode is where the j-th eigenvalue of K'(omega), ascending,
crosses omega^2: so no two modes can come to be one, and none is left out.
Sources: Voss and Werner, A minimax principle for nonlinear eigenvalue problems, Math. Meth. Appl.
Sci. 4 (1982), 415-424 (modes by rank, safeguarded iteration); Voss, An Arnoldi method for nonlinear
eigenvalue problems, BIT Numer. Math. 44 (2004), 387-401 (the subspace).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from scipy.linalg import eigh, svd

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.errors import SolveError
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.fem.relaxation import Relaxation, Scaling
from tyrefrf.fem.viscoelastic import Modulus
from tyrefrf.solvers.inertia import symmetric_factor
from tyrefrf.solvers.modes import (
    RESIDUAL_MAX,
    ZERO,
    OrderModes,
    Pencil,
    Pencils,
    cutoff_for,
    lowest,
    modes_below,
    turned,
)
from tyrefrf.solvers.orders import Folded, Orders

ROUNDS = 12
"""Times that the subspace may grow; rubber that stiffens tenfold took 3."""
CROSSED = 1e-11
"""How closely a crossing is found, relative to the cut-off."""
SETTLED = 1e-8
"""Residual at which the subspace holds a mode: the frequency's error is of its square."""
SECANTS = 12
"""Steps for one crossing before bisection takes over; rubber takes 3 to 6."""
DEPENDENT = 1e-10
"""Share of a direction in the vectors below which the subspace goes without it."""


def own_ring_modes(
    cell: CellMatrices, n_cells: int, *, below: float | None = None, count: int | None = None
) -> tuple[OrderModes, ...]:
    """As `ring_modes`, with every mode's storage moduli at its own frequency.

    The shapes of one order are each of unit modal mass, but orthogonal only as far as the moduli
    agree. As many modes lie below omega as eigenvalues of K'(omega) - omega^2 M are negative, if
    no storage modulus grows faster than omega^2, which no relaxing material does.
    Raises SolveError as `ring_modes`.
    """
    if (below is None) == (count is None):
        raise ValueError("either `below` or `count`")
    pencils = Pencils(cell, n_cells)
    if count is not None:
        below = cutoff_for(lambda omega: pencils.at(omega).count_below(omega), pencils, count)
    assert below is not None
    relaxing = RelaxingOrders(cell, n_cells)
    modes = tuple(own_modes_below(relaxing, h, below) for h in range(n_cells // 2 + 1))
    return modes if count is None else lowest(modes, count)


class RelaxingOrders:
    """The ring's orders at all frequencies; what frequency only scales is kept in parts."""

    def __init__(self, cell: CellMatrices, n_cells: int) -> None:
        self.n_cells = n_cells
        self.pencils = Pencils(cell, n_cells)
        self._orders = Orders(cell)
        self._parts: list[tuple[Modulus | None, Folded]] = []
        self._others: list[tuple[Relaxation, FloatArray]] = []
        self._parts.append((None, self._orders.folded(cell.K_G + cell.K_P)))
        for name, K in cell.K.items():
            relaxation = cell.relaxation[name]
            if isinstance(relaxation, Scaling):
                self._parts.append((relaxation.modulus, self._orders.folded(K)))
            else:
                self._others.append((relaxation, K))

    def pencil(self, h: int, omega: float) -> Pencil:
        """K'(omega) and M of order h."""
        return self.pencils.at(omega).of(h)

    def projected(self, h: int, V: ComplexArray) -> Callable[[float], ComplexArray]:
        """V^H K'(omega) V (k, k) of order h, as a function of omega; V: (n, k)."""
        mu = 2.0 * np.pi * h / self.n_cells

        def onto(folded: Folded) -> ComplexArray:
            return np.asarray(V.conj().T @ (self._orders.matrix(folded.at(mu)) @ V))

        parts = [(modulus, onto(folded)) for modulus, folded in self._parts]

        def K(omega: float) -> ComplexArray:
            total = sum(X * (1.0 if law is None else law.scale(omega).real) for law, X in parts)
            for relaxation, reference in self._others:
                entries = relaxation.stiffness(reference, omega).real
                total = total + onto(self._orders.folded(entries))
            return np.asarray(total)

        return K


def own_modes_below(orders: RelaxingOrders, h: int, cutoff: float) -> OrderModes:
    """All modes of order h with a frequency below the cut-off [rad/s].

    Raises SolveError as `ring_modes`.
    """
    stiffest = modes_below(orders.pencil(h, cutoff), cutoff)
    omega = stiffest.omega  # as many as there are of the modes themselves
    if not len(omega):
        return stiffest
    softest = modes_below(orders.pencil(h, 0.0), cutoff).first(len(omega))
    V = orthonormal(np.hstack([stiffest.shapes, softest.shapes]))
    for _ in range(ROUNDS):
        omega, phi = _crossings(orders, h, V, omega, cutoff)
        at_own = [orders.pencil(h, w) for w in omega]
        residual = _residuals(at_own, omega, phi, cutoff)
        open_ = np.flatnonzero(residual > SETTLED)
        if not len(open_):
            break
        better = _improved([at_own[j] for j in open_], omega[open_], phi[:, open_])
        V = orthonormal(np.hstack([V, beside(V, better)]))
    if np.any(residual > RESIDUAL_MAX):
        raise SolveError(
            f"circumferential order {h}: the modes below {cutoff / (2.0 * np.pi):.6g} Hz do not "
            "settle on moduli of their own frequencies; take the moduli at a stated frequency"
        )
    return OrderModes(h, stiffest.n_members, omega, turned(phi), residual)


def orthonormal(vectors: ComplexArray) -> ComplexArray:
    """A basis (n, k) of what vectors along (n, m) span, whatever their lengths."""
    U, s, _ = svd(vectors / np.linalg.norm(vectors, axis=0), full_matrices=False)
    return np.asarray(U[:, s > DEPENDENT * s[0]])


def beside(V: ComplexArray, vectors: ComplexArray) -> ComplexArray:
    """The parts of vectors (n, m) that are orthogonal to V, however small they are."""
    for _ in range(2):  # twice is enough
        vectors = vectors - V @ (V.conj().T @ vectors)
    return vectors


def _crossings(
    orders: RelaxingOrders, h: int, V: ComplexArray, start: FloatArray, cutoff: float
) -> tuple[FloatArray, ComplexArray]:
    """The modes of the lowest m ranks in the subspace V (n, k): omega (m,), shapes (n, m).

    start: (m,) near them [rad/s].
    """
    rest = orders.pencil(h, 0.0)
    K, M = orders.projected(h, V), V.conj().T @ (rest.M @ V)
    zero = ZERO * rest.scale

    def root(rank: int, omega: float) -> float:
        squared = eigh(K(omega), M, eigvals_only=True, subset_by_index=(rank, rank))[0]
        return float(np.sqrt(squared)) if squared > zero else 0.0

    omega, phi = np.empty(len(start)), np.empty((len(V), len(start)), complex)
    for rank, near in enumerate(start):
        omega[rank] = crossing(partial(root, rank), near, cutoff)
        phi[:, rank] = V @ eigh(K(omega[rank]), M, subset_by_index=(rank, rank))[1][:, 0]
    return omega, phi


def crossing(root: Callable[[float], float], near: float, cutoff: float) -> float:
    """Where root(omega) = omega between 0, where it is at least that, and the cut-off.

    By secants; a storage modulus that all but jumps may throw them out, and then by bisection.
    """
    from scipy.optimize import brentq

    def lack(omega: float) -> float:
        return root(omega) - omega

    before, now = near, root(near)
    lack_before = now - before
    for _ in range(SECANTS):
        lack_now = lack(now)
        if abs(lack_now) <= CROSSED * cutoff:
            return now
        if lack_now == lack_before:
            break
        now, before = now + lack_now * (now - before) / (lack_before - lack_now), now
        lack_before = lack_now
        if not 0.0 <= now <= cutoff:
            break
    return float(brentq(lack, 0.0, cutoff, xtol=CROSSED * cutoff))


def _residuals(
    pencils: Sequence[Pencil], omega: FloatArray, phi: ComplexArray, cutoff: float
) -> FloatArray:
    """||K' phi - omega^2 M phi|| of every mode at its own moduli, relative as in `OrderModes`."""
    residual = np.empty(len(omega))
    for j, (pencil, w, shape) in enumerate(zip(pencils, omega, phi.T, strict=True)):
        force = pencil.M @ shape
        lack = np.linalg.norm(pencil.K @ shape - w**2 * force)
        residual[j] = lack / ((w**2 + pencil.shift(cutoff)) * np.linalg.norm(force))
    return residual


def _improved(pencils: Sequence[Pencil], omega: FloatArray, phi: ComplexArray) -> ComplexArray:
    """Vectors (n, m) that hold the modes better: one step of inverse iteration from each."""
    better = phi.copy()
    for j, (pencil, w) in enumerate(zip(pencils, omega, strict=True)):
        factor = symmetric_factor(pencil.minus(w**2).astype(complex))
        if factor is not None:
            better[:, j] = factor.solve(pencil.M @ phi[:, j])
    return better
