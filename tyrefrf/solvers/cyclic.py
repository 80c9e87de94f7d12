"""The ring by circumferential orders: one narrow band for each, nothing condensed.

Shares with the recursion nothing but the cell's matrices and their symmetries.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray
from tyrefrf.solvers.banded import BandedOrders
from tyrefrf.solvers.orders import Folded, Orders
from tyrefrf.solvers.problem import Field, RingProblem, needs_watch, watched
from tyrefrf.solvers.symmetry import UNTOUCHED, Turnabout, halves, mapped, turnabout


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
        f_h = np.moveaxis(f_h, 1, 0)
        self._mu = 2.0 * np.pi * np.arange(f_h.shape[1]) / problem.n_cells
        self._mirror = turnabout(problem.cell)
        self._phase = _mirror_phases(self._mirror, f_h, self._mu)
        self._mixed: BoolArray = np.asarray(np.isnan(self._phase).any(axis=0))
        self._halves = []
        for Q in halves(problem.cell):
            own = mapped(csr_array(Q.T), f_h)
            excited = np.linalg.norm(own, axis=(0, 2)) > UNTOUCHED * np.linalg.norm(f_h)
            if np.any(excited):
                h = np.flatnonzero(excited)
                bands = BandedOrders(self._orders, Q, problem.n_cells, h)
                own = mapped(csr_array(bands.Q.T), f_h[:, h])
                self._halves.append(Half(bands, np.moveaxis(own, 0, 1).copy()))

    @property
    def operations(self) -> float:
        """Of the factorisations of a line: 16 m w^2 for every order's band of m dofs."""
        bands = [half.bands for half in self._halves]
        return sum(16.0 * len(band.h) * band.m * band.width**2 for band in bands)

    def field(self, omega: float) -> Field:
        """Solve one line; omega [rad/s]. Raises SingularError if an order resonates undamped."""
        D = self.problem.cell.dynamic_stiffness(omega)
        if needs_watch(self.problem, D, omega):
            return self._watching._checked(D).without_last()
        return self._checked(D)

    @cached_property
    def _watching(self) -> Cyclic:
        """The solver of lines where one load more is needed for proof: see `needs_watch`."""
        return Cyclic(watched(self.problem))

    def _checked(self, D: ComplexArray) -> Field:
        """The field from the cell's dynamic stiffness entries."""
        return Field.checked(self.problem, D, self.displacements(D))

    def displacements(self, D: ComplexArray) -> ComplexArray:
        """The ring's (n_cells, n_own, n_loads), unchecked. Raises SingularError as `field`."""
        problem = self.problem
        q = np.zeros((problem.cell.n_own, problem.n_cells, problem.n_loads), complex)
        q[problem.free] = np.fft.ifft(self._all_orders(self._orders.folded(D)), axis=1)
        return np.moveaxis(q, 0, 1)

    def _all_orders(self, D: Folded) -> ComplexArray:
        """x_h (n, N, k), dof by dof, negative orders at the end."""
        n_orders, N, mixed = len(self._mu), self.problem.n_cells, self._mixed
        x_h = np.zeros((self._orders.n, N, len(mixed)), complex)
        x, minus = x_h[:, :n_orders], x_h[:, : n_orders - 1 : -1]  # h = 0..N/2; -1, -2, ...
        pairs = np.s_[:, 1 : 1 + minus.shape[1]]
        back = np.zeros((*x.shape[:2], int(mixed.sum())), complex)
        for half in self._halves:
            h, Q = half.bands.h, half.bands.Q
            there, opposite = half.bands.solve(D, half.f, half.f[..., mixed].conj())
            x[:, h] += mapped(Q, np.moveaxis(there, 1, 0))
            back[:, h] += mapped(Q, np.moveaxis(opposite, 1, 0))
        if self._mirror is not None:
            minus[...] = self._phase[pairs[1]] * self._mirror.of(x[pairs], self._mu[pairs[1]])
        minus[..., mixed] = back[pairs]
        return x_h


def _mirror_phases(mirror: Turnabout | None, f_h: ComplexArray, mu: FloatArray) -> ComplexArray:
    """(h, k) the phases with which the loads' mirror images R f_h are f_-h; NaN where they are not.

    f_h: (n, h, k) at mu (h,).
    """
    if mirror is None:
        return np.full(f_h.shape[1:], complex(np.nan, np.nan))
    image = mirror.of(f_h, mu)
    size = np.linalg.norm(f_h, axis=0)
    still = size <= UNTOUCHED * size.max(axis=0)
    part = np.einsum("nhk,nhk->hk", image.conj(), f_h.conj())
    phase = np.where(still, 1.0, part / np.where(still, 1.0, size**2))
    lack = np.linalg.norm(f_h.conj() - phase * image, axis=0)
    return np.where(lack <= UNTOUCHED * size.max(axis=0), phase, complex(np.nan, np.nan))
