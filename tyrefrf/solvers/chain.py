"""Chains of cells: their dynamic stiffness between the two end faces, and how they join.

All matrices are complex symmetric, so RL = LR^T is never stored.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tyrefrf.arrays import ComplexArray
from tyrefrf.solvers.factor import Factor, factorise


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """n_cells cells in a row, everything between the end faces eliminated: [5] and [18].

    LL, LR, RR: (n, n) dynamic stiffness [N/m]. joint: how it was made, None for a single cell.
    """

    n_cells: int
    LL: ComplexArray
    LR: ComplexArray
    RR: ComplexArray
    joint: Joint | None = None

    def inner_faces(self, q_L: ComplexArray, q_R: ComplexArray) -> ComplexArray:
        """Displacements (n_cells - 1, n, m) of the eliminated faces from the ends' (n, m)."""
        if self.joint is None:
            return np.empty((0, *q_L.shape), complex)
        a, b = self.joint.left, self.joint.right
        q = self.joint.shared_face(q_L, q_R)
        if a is b:  # both halves in one go
            both = a.inner_faces(np.hstack([q_L, q]), np.hstack([q, q_R]))
            left, right = np.split(both, 2, axis=2)
        else:
            left, right = a.inner_faces(q_L, q), b.inner_faces(q, q_R)
        return np.concatenate([left, q[None], right])


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """The face that two chains shared: factor of D*^-1 = RR1 + LL2, and q = -X_L q_L - X_R q_R."""

    left: Chain
    right: Chain
    factor: Factor
    X_L: ComplexArray
    X_R: ComplexArray

    def shared_face(self, q_L: ComplexArray, q_R: ComplexArray) -> ComplexArray:
        """Displacement (n, m) of the shared face."""
        return -(self.X_L @ q_L + self.X_R @ q_R)


def join(a: Chain, b: Chain) -> Chain:
    """Join two neighbours and eliminate the face they share: [18].

    LL = LL1 - LR1 D* LR1^T, LR = -LR1 D* LR2, RR = RR2 - LR2^T D* LR2, by one factorisation.
    Raises SingularError if the joined chain, ends fixed, resonates without damping.
    """
    n = len(a.LL)
    factor = factorise(a.RR + b.LL)
    X_L, X_R = np.hsplit(factor.solve(np.hstack([a.LR.T, b.LR])), [n])
    return Chain(
        n_cells=a.n_cells + b.n_cells,
        LL=a.LL - a.LR @ X_L,
        LR=-a.LR @ X_R,
        RR=b.RR - b.LR.T @ X_R,
        joint=Joint(a, b, factor, X_L, X_R),
    )


class Chains:
    """Chains of one cell of any length, each built once: [16] and the text below [18]."""

    def __init__(self, cell: Chain) -> None:
        self._made = {1: cell}

    def of(self, n_cells: int) -> Chain:
        """A chain of n_cells >= 1, from the powers of two of its binary digits, longest first."""
        if n_cells not in self._made:
            longest = 1 << (n_cells.bit_length() - 1)
            rest = n_cells - longest or (longest := longest // 2)
            self._made[n_cells] = join(self.of(longest), self.of(rest))
        return self._made[n_cells]
