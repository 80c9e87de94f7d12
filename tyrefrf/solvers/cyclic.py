"""The ring by circumferential orders: one narrow band for each, nothing condensed.

Shares with the recursion nothing but the cell's matrices and their symmetries.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray
from tyrefrf.solvers.banded import BandedOrders
from tyrefrf.solvers.orders import Folded, Orders
from tyrefrf.solvers.problem import Field, RingProblem, watched
from tyrefrf.solvers.symmetry import UNTOUCHED, Turnabout, expanded, halves, turnabout


@dataclass(frozen=True, slots=True, eq=False)
class Half:
    """Motions that mix with no others, and the loads f (h, m, k) on them at the orders excited."""

    bands: BandedOrders
    f: ComplexArray


class Cyclic:
    """A_h x_h = f_h at every circumferential order that the loads excite; q by inverse FFT.

    Tyres that mirror in y fall into two halves; a load in the middle plane excites one of them.
    Loads are real, so that f_-h is the conjugate of f_h. Its answer is the mirror image of x_h for
    a load that the ring's mirror keeps or turns round; for others A_-h = A_h^T.
    """

    exact = True

    def __init__(self, problem: RingProblem) -> None:
        self.problem = problem
        self._orders = Orders(problem.cell)
        f = problem.loads.toarray().reshape(problem.n_cells, problem.cell.n_own, -1)
        f_h = np.fft.fft(f[:, problem.free], axis=0)[: problem.n_cells // 2 + 1]
        self._mu = 2.0 * np.pi * np.arange(len(f_h)) / problem.n_cells
        self._mirror = turnabout(problem.cell)
        self._phase = _mirror_phases(self._mirror, f_h, self._mu)
        self._mixed: BoolArray = np.asarray(np.isnan(self._phase).any(axis=0))
        self._halves = []
        for Q in halves(problem.cell):
            own = np.stack([Q.T @ f for f in f_h])
            excited = np.linalg.norm(own, axis=(1, 2)) > UNTOUCHED * np.linalg.norm(f_h)
            if np.any(excited):
                h = np.flatnonzero(excited)
                bands = BandedOrders(self._orders, Q, problem.n_cells, h)
                self._halves.append(Half(bands, np.stack([bands.Q.T @ f_h[i] for i in h])))

    @property
    def operations(self) -> float:
        """Of the factorisations of a line: 16 m w^2 for every order's band of m dofs."""
        bands = [half.bands for half in self._halves]
        return sum(16.0 * len(band.h) * band.m * band.width**2 for band in bands)

    def field(self, omega: float) -> Field:
        """Solve one line; omega [rad/s]. Raises SingularError if an order resonates undamped."""
        D = self.problem.cell.dynamic_stiffness(omega)
        if np.any(D.imag):
            return self._checked(omega, D)
        return self._watching._checked(omega, D).without_last()

    @cached_property
    def _watching(self) -> Cyclic:
        """The solver of lines without any loss, where one load more is needed for proof."""
        return Cyclic(watched(self.problem))

    def _checked(self, omega: float, D: ComplexArray) -> Field:
        """The field from the cell's dynamic stiffness entries."""
        problem, N = self.problem, self.problem.n_cells
        q = np.zeros((N, problem.cell.n_own, problem.n_loads), complex)
        q[:, problem.free] = np.fft.ifft(self._all_orders(self._orders.folded(D)), axis=0)
        return Field.checked(problem, omega, q)

    def _all_orders(self, D: Folded) -> ComplexArray:
        """x_h (N, n, k), negative orders at the end."""
        N, mixed = self.problem.n_cells, self._mixed
        x = np.zeros((len(self._mu), self._orders.n, len(mixed)), complex)
        back = np.zeros((*x.shape[:2], int(mixed.sum())), complex)
        for half in self._halves:
            factor, h, Q = half.bands.factorise(D), half.bands.h, half.bands.Q
            x[h] = x[h] + expanded(Q, factor.solve(half.f))
            if np.any(mixed):
                f = half.f[..., mixed].conj()
                back[h] = back[h] + expanded(Q, factor.solve(f, transposed=True))
        minus = np.empty_like(x)
        if self._mirror is not None:
            minus[...] = self._phase[:, None] * self._mirror.of(x, self._mu)
        minus[..., mixed] = back
        return np.concatenate([x, minus[(N - 1) // 2 : 0 : -1]])


def _mirror_phases(mirror: Turnabout | None, f_h: ComplexArray, mu: FloatArray) -> ComplexArray:
    """(h, k) the phases with which the loads' mirror images R f_h are f_-h; NaN where they are not.

    f_h: (h, n, k) at mu (h,).
    """
    if mirror is None:
        return np.full((len(f_h), f_h.shape[2]), complex(np.nan, np.nan))
    image = mirror.of(f_h, mu)
    size = np.linalg.norm(f_h, axis=1)
    still = size <= UNTOUCHED * size.max(axis=0)
    part = np.einsum("hnk,hnk->hk", image.conj(), f_h.conj())
    phase = np.where(still, 1.0, part / np.where(still, 1.0, size**2))
    lack = np.linalg.norm(f_h.conj() - phase[:, None] * image, axis=1)
    return np.where(lack <= UNTOUCHED * size.max(axis=0), phase, complex(np.nan, np.nan))
