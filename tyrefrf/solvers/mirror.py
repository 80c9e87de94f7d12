"""Chains of a cell that is its own mirror image: a third of the work, and less.

With S, the section's mirror, RR = S LL S and LR^T = S LR S. In a basis of its eigenvectors, `e`
those that it leaves as they are and `o` those that it turns round, RR + LL of two equal chains
falls into the blocks ee and oo, and RR is never formed.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.solvers.factor import Factor, factorise

N_STRIPS = 4  # of a symmetric product: 5/8 of its operations


@dataclass(frozen=True, slots=True, eq=False)
class MirrorChain:
    """n_cells cells in a row, everything between the end faces eliminated: [5] and [18].

    LL, LR: (n, n) dynamic stiffness [N/m] in the basis of S. n_even: how many of its vectors S
    leaves as they are; they come first. joint: how it was made, None for a single cell.
    """

    DOUBLE: ClassVar[float] = 10.3  # operations over n^3, a third of the motions odd: 0.9 to
    JOIN: ClassVar[float] = 23.7  # factorise, 4.4 to solve, 5 to multiply; 2.7, 8 and 13

    n_cells: int
    LL: ComplexArray
    LR: ComplexArray
    n_even: int
    joint: Doubled | Joined | None = None

    @property
    def sign(self) -> FloatArray:
        """The diagonal (n,) of S."""
        return np.where(np.arange(len(self.LL)) < self.n_even, 1.0, -1.0)

    @property
    def RR(self) -> ComplexArray:
        """S LL S."""
        return self.sign[:, None] * self.LL * self.sign

    def joined(self, other: MirrorChain) -> MirrorChain:
        """Join a right neighbour of the same cells: [18].

        Raises SingularError if the joined chain, ends fixed, resonates without damping.
        """
        return self._doubled() if other is self else self._with(other)

    def _doubled(self) -> MirrorChain:
        """Twice this chain: with X_e = LR_e LL_ee^-1 LR_e^T, and X_o alike,

        LL' = LL - (X_e + X_o) / 2 and LR' = (X_o - X_e) S / 2.
        """
        LL, LR, e, o = self.LL, self.LR, slice(0, self.n_even), slice(self.n_even, None)
        Y_e, Y_o = (factorise(LL[part, part]).solve(LR[:, part].T) for part in (e, o))
        X_e, X_o = symmetric_product(LR[:, e], Y_e), symmetric_product(LR[:, o], Y_o)
        return MirrorChain(
            n_cells=2 * self.n_cells,
            LL=LL - 0.5 * (X_e + X_o),
            LR=0.5 * (X_o - X_e) * self.sign,
            n_even=self.n_even,
            joint=Doubled(self, Y_e, Y_o),
        )

    def _with(self, other: MirrorChain) -> MirrorChain:
        """Join a longer or shorter chain; the whole is again its own mirror image.

        LL' = LL1 - LR1 D* LR1^T and LR' = -LR1 D* LR2, from D* LR1^T alone.
        """
        factor = factorise(self.RR + other.LL)
        X_L = factor.solve(self.LR.T)
        return MirrorChain(
            n_cells=self.n_cells + other.n_cells,
            LL=self.LL - symmetric_product(self.LR, X_L),
            LR=-X_L.T @ other.LR,
            n_even=self.n_even,
            joint=Joined(self, other, factor, X_L),
        )

    def inner_faces(self, q_L: ComplexArray, q_R: ComplexArray) -> ComplexArray:
        """Displacements (n_cells - 1, n, m) of the eliminated faces from the ends' (n, m)."""
        if self.joint is None:
            return np.empty((0, *q_L.shape), complex)
        return self.joint.inner_faces(q_L, q_R)


@dataclass(frozen=True, slots=True, eq=False)
class Doubled:
    """The face that two equal chains shared: q_e = -Y_e (q_L + S q_R) / 2, q_o with a minus.

    Y_e: LL_ee^-1 LR_e^T (n_e, n), for what S keeps; Y_o likewise, for what it turns round.
    """

    half: MirrorChain
    Y_e: ComplexArray
    Y_o: ComplexArray

    def inner_faces(self, q_L: ComplexArray, q_R: ComplexArray) -> ComplexArray:
        """Of both chains, in one go, and the shared one between them."""
        image = self.half.sign[:, None] * q_R
        q = -0.5 * np.concatenate([self.Y_e @ (q_L + image), self.Y_o @ (q_L - image)])
        both = self.half.inner_faces(np.hstack([q_L, q]), np.hstack([q, q_R]))
        left, right = np.split(both, 2, axis=2)
        return np.concatenate([left, q[None], right])


@dataclass(frozen=True, slots=True, eq=False)
class Joined:
    """The face that two different chains shared: q = -X_L q_L - D* LR2 q_R."""

    left: MirrorChain
    right: MirrorChain
    factor: Factor
    X_L: ComplexArray

    def inner_faces(self, q_L: ComplexArray, q_R: ComplexArray) -> ComplexArray:
        """Of the left chain, the shared one, and of the right chain."""
        q = -(self.X_L @ q_L + self.factor.solve(self.right.LR @ q_R))
        left, right = self.left.inner_faces(q_L, q), self.right.inner_faces(q, q_R)
        return np.concatenate([left, q[None], right])


def symmetric_product(A: ComplexArray, B: ComplexArray) -> ComplexArray:
    """A B (n, n) of A (n, k) and B (k, n), where it is known to be symmetric."""
    n = len(A)
    C = np.empty((n, n), complex)
    edges = np.linspace(0, n, N_STRIPS + 1).astype(int)
    for start, stop in pairwise(edges):
        C[start:, start:stop] = A[start:] @ B[:, start:stop]
        C[start:stop, stop:] = C[stop:, start:stop].T
    return C
