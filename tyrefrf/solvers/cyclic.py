"""The ring by circumferential orders: one narrow band for each, nothing condensed.

Shares with the recursion nothing but the cell's matrices and their symmetries.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array

from tyrefrf.arrays import ComplexArray
from tyrefrf.solvers.banded import BandedOrders
from tyrefrf.solvers.orders import Folded, Orders
from tyrefrf.solvers.problem import Field, RingProblem, watched
from tyrefrf.solvers.symmetry import halves

UNTOUCHED = 1e-14
"""Part of the loads, relative to all of them, below which motions are not excited."""


@dataclass(frozen=True, slots=True, eq=False)
class Half:
    """Motions that mix with no others, at the orders h at which the loads f (h, m, k) excite them.

    Loads are real, so that f_-h is the conjugate of f_h; and A_-h = A_h^T.
    """

    bands: BandedOrders
    f: ComplexArray

    def add_to(self, x_h: ComplexArray, D: Folded) -> None:
        """Add these motions' part to x_h (N, n, k), at the orders h and -h."""
        factor = self.bands.factorise(D)
        h, Q = self.bands.h, self.bands.Q
        minus = (h > 0) & (2 * h < len(x_h))
        x_h[h] += _expanded(Q, factor.solve(self.f))
        back = factor.solve(self.f.conj(), transposed=True)
        x_h[-h[minus]] += _expanded(Q, back[minus])


def _expanded(Q: csc_array, x: ComplexArray) -> ComplexArray:
    """Q x (h, n, k) of motions x (h, m, k)."""
    flat = Q @ x.transpose(1, 0, 2).reshape(x.shape[1], -1)
    return flat.reshape(Q.shape[0], len(x), x.shape[2]).transpose(1, 0, 2)


class Cyclic:
    """A_h x_h = f_h at every circumferential order that the loads excite; q by inverse FFT.

    Tyres that mirror in y fall into two halves; a load in the middle plane excites one of them.
    """

    exact = True

    def __init__(self, problem: RingProblem) -> None:
        self.problem = problem
        self._orders = Orders(problem.cell)
        f = problem.loads.toarray().reshape(problem.n_cells, problem.cell.n_own, -1)
        f_h = np.fft.fft(f[:, problem.free], axis=0)[: problem.n_cells // 2 + 1]
        size = np.linalg.norm(f_h)
        self._halves = []
        for Q in halves(problem.cell):
            own = np.einsum("hnk,nm->hmk", f_h, Q.toarray())
            excited = np.linalg.norm(own, axis=(1, 2)) > UNTOUCHED * size
            if np.any(excited):
                h = np.flatnonzero(excited)
                bands = BandedOrders(self._orders, Q, problem.n_cells, h)
                self._halves.append(Half(bands, np.stack([bands.Q.T @ f_h[i] for i in h])))

    def field(self, omega: float) -> Field:
        """Solve one line; omega [rad/s]. Raises SingularError if an order resonates undamped."""
        D = self.problem.cell.dynamic_stiffness(omega)
        if np.any(D.imag):
            return self._solved(omega, D)
        return self._watching._solved(omega, D).without_last()

    @cached_property
    def _watching(self) -> Cyclic:
        """The solver of lines without any loss, where one load more is needed for proof."""
        return Cyclic(watched(self.problem))

    def _solved(self, omega: float, D: ComplexArray) -> Field:
        """The field from the cell's dynamic stiffness entries."""
        problem, N = self.problem, self.problem.n_cells
        folded = self._orders.folded(D)
        x_h = np.zeros((N, self._orders.n, problem.n_loads), complex)
        for half in self._halves:
            half.add_to(x_h, folded)
        q = np.zeros((N, problem.cell.n_own, problem.n_loads), complex)
        q[:, problem.free] = np.fft.ifft(x_h, axis=0)
        return Field.checked(problem, omega, q)
