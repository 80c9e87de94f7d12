"""Chains of cells: their dynamic stiffness between the two end faces, and how they join.

All matrices are complex symmetric, so RL = LR^T is never stored.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tyrefrf.arrays import ComplexArray
from tyrefrf.solvers.factor import factorise


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """n_cells cells in a row, everything between the end faces eliminated: [5] and [18].

    LL, LR, RR: (n, n) dynamic stiffness [N/m]. joint: how it was made, None for a single cell.
    """

    DOUBLE: ClassVar[float] = 42.7  # operations over n^3: factorise, solve, multiply
    JOIN: ClassVar[float] = 42.7

    n_cells: int
    LL: ComplexArray
    LR: ComplexArray
    RR: ComplexArray
    joint: Joint | None = None

    def joined(self, other: Chain) -> Chain:
        """Join the right neighbour: one chain, the face that they share eliminated: [18].

        LL = LL1 - LR1 D* LR1^T, LR = -LR1 D* LR2, RR = RR2 - LR2^T D* LR2, by one factorisation.
        Raises SingularError if the joined chain, ends fixed, resonates without damping.
        """
        n = len(self.LL)
        factor = factorise(self.RR + other.LL)
        X_L, X_R = np.hsplit(factor.solve(np.hstack([self.LR.T, other.LR])), [n])
        return Chain(
            n_cells=self.n_cells + other.n_cells,
            LL=self.LL - self.LR @ X_L,
            LR=-self.LR @ X_R,
            RR=other.RR - other.LR.T @ X_R,
            joint=Joint(self, other, X_L, X_R),
        )

    def inner_faces(self, q_L: ComplexArray, q_R: ComplexArray) -> ComplexArray:
        """Displacements (n_cells - 1, n, m) of the eliminated faces from the ends' (n, m)."""
        if self.joint is None:
            return np.empty((0, *q_L.shape), complex)
        return self.joint.inner_faces(q_L, q_R)


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """The face that two chains shared: q = -X_L q_L - X_R q_R."""

    left: Chain
    right: Chain
    X_L: ComplexArray
    X_R: ComplexArray

    def inner_faces(self, q_L: ComplexArray, q_R: ComplexArray) -> ComplexArray:
        """Of the left chain, the shared one, and of the right chain."""
        a, b = self.left, self.right
        q = -(self.X_L @ q_L + self.X_R @ q_R)
        if a is b:  # both halves in one go
            both = a.inner_faces(np.hstack([q_L, q]), np.hstack([q, q_R]))
            left, right = np.split(both, 2, axis=2)
        else:
            left, right = a.inner_faces(q_L, q), b.inner_faces(q, q_R)
        return np.concatenate([left, q[None], right])
