"""The eigenproblem of free waves: (A_0 + lambda A_on + A_back / lambda) q = 0, A_back = A_on^T.

It is palindromic: a transposed solution belongs to 1 / lambda, so eigenvalues come in pairs. On
the state z = (q, y), with y = A_back q / lambda the forces from the cell behind, it reads
M z = lambda L z,

    M = [[-A_0, -1], [A_back, 0]],  L = [[A_on, 0], [0, 1]],  M J M^T = L J L^T,

a symplectic pencil, S = L^-1 M, which is never formed: A_on is as good as singular. The matrix
whose eigenvalues are sought is shift-and-invert of S + S^-1, whose eigenvalues are
nu = lambda + 1/lambda, each twice:

    (S + S^-1 - nu_0)^-1 = S (S - 1/lambda_0)^-1 (S - lambda_0)^-1,  nu_0 = lambda_0 + 1/lambda_0,

for which one factorisation is enough, as A(1/lambda_0) is the transpose of A(lambda_0).

Sources: Zhong & Williams, J. Sound Vib. 181 (1995) 485; Mehrmann & Watkins, SIAM J. Sci. Comput.
22 (2001) 1905; Mackey, Mackey, Mehl & Mehrmann, SIAM J. Matrix Anal. Appl. 28 (2006) 1029.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigvals, lapack
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.sparse.linalg import ArpackError, LinearOperator, eigs

from tyrefrf.arrays import ComplexArray, IntArray
from tyrefrf.errors import SolveError

NEAREST = 24
"""Eigenvalues that one shift asks for: 12 pairs, for every nu is there twice. More cost more than
a second shift does."""
SMALL = 100
"""Up to so many dofs all eigenvalues at once, dense, are as quick as a few."""
STEPS = 6  # of a cubic iteration that starts at some six digits


class Band:
    """A sparsity pattern in an order that makes it banded: LAPACK's band is then the quickest."""

    def __init__(self, pattern: csc_array) -> None:
        columns = np.repeat(np.arange(pattern.shape[1]), np.diff(pattern.indptr))
        self.order: IntArray = reverse_cuthill_mckee(csr_array(pattern), symmetric_mode=True)
        place = np.argsort(self.order)
        row, column = place[pattern.indices], place[columns]
        self.n = len(place)
        self.width = int(np.max(np.abs(row - column), initial=0))
        self._slots = (2 * self.width + row - column, column)

    def factorise(self, entries: ComplexArray) -> BandFactor:
        """LU of the matrix with these entries, with partial pivoting.

        A pivot that is exactly zero, on an eigenvalue, becomes as small as can be: the solution
        then grows along the eigenvector, which is what inverse iteration wants.
        """
        A = np.zeros((3 * self.width + 1, self.n), complex, order="F")
        A[self._slots] = entries
        lu, pivots, _ = lapack.zgbtrf(A, self.width, self.width, overwrite_ab=True)
        diagonal = lu[2 * self.width]
        diagonal[diagonal == 0.0] = np.finfo(float).eps * np.abs(entries).max()
        return BandFactor(self, lu, pivots)


@dataclass(frozen=True, slots=True, eq=False)
class BandFactor:
    """LU factors in LAPACK's band storage, and the pivots."""

    band: Band
    lu: ComplexArray
    pivots: IntArray

    def solve(self, b: ComplexArray, *, transposed: bool = False) -> ComplexArray:
        """A^-1 b or A^-T b for right-hand sides (n,) or (n, m)."""
        width, order = self.band.width, self.band.order
        x = np.empty(b.shape, complex)
        x[order], _ = lapack.zgbtrs(
            self.lu, width, width, b[order], self.pivots, trans=int(transposed)
        )
        return x

    @property
    def phase(self) -> float:
        """The phase of det A [rad], from the pivots and the rows that they swapped."""
        swaps = np.count_nonzero(self.pivots != np.arange(self.band.n))
        return float(np.angle(self.lu[2 * self.band.width]).sum() + np.pi * swaps)


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """Two waves, lambda and 1/lambda: A(ratio) right = 0 and A(1/ratio) left = 0.

    residual: ||A(ratio) right|| / (||A|| ||right||), or of left if that is larger.
    """

    ratio: complex
    right: ComplexArray
    left: ComplexArray
    residual: float


@dataclass(frozen=True, slots=True, eq=False)
class Palindrome:
    """A(lambda) = A_0 + lambda A_on + A_back / lambda at one frequency.

    A_0, A_on, A_back: (n, n) of one sparsity pattern, and band that pattern's order.
    """

    band: Band
    A_0: csc_array
    A_on: csc_array
    A_back: csc_array

    def at(self, ratio: complex) -> csc_array:
        """A(lambda)."""
        return self.A_0 + ratio * self.A_on + self.A_back / ratio

    def factorise(self, ratio: complex) -> BandFactor:
        """LU of A(lambda)."""
        on, back = ratio * self.A_on.data, self.A_back.data / ratio
        return self.band.factorise(self.A_0.data + on + back)

    def near(self, ratio: complex) -> tuple[ComplexArray, float]:
        """The nu nearest to that of a ratio, and the radius in nu within which these are all.

        Raises SolveError where Arnoldi's iteration does not converge.
        """
        if self.band.n <= SMALL:
            return self.everywhere(ratio), np.inf
        n = 2 * self.band.n
        start = np.random.default_rng(0).standard_normal((2, n))
        try:
            theta = eigs(
                LinearOperator((n, n), matvec=self._inverse(ratio), dtype=complex),
                k=NEAREST,
                ncv=2 * NEAREST,
                v0=start[0] + 1j * start[1],
                tol=1e-6,  # refined later
                return_eigenvectors=False,
            )
        except ArpackError as error:
            raise SolveError(f"free waves near lambda = {ratio:.4g}: {error}") from error
        return ratio + 1.0 / ratio + 1.0 / theta, float(1.0 / np.abs(theta).min())

    def everywhere(self, ratio: complex) -> ComplexArray:
        """Every nu, from the same matrix, dense: what `near` falls back on."""
        theta = eigvals(self._inverse(ratio)(np.eye(2 * self.band.n, dtype=complex)))
        finite = np.abs(theta) > np.finfo(float).eps * np.abs(theta).max()
        return ratio + 1.0 / ratio + 1.0 / theta[finite]

    def _inverse(self, ratio: complex) -> Callable[[ComplexArray], ComplexArray]:
        """What takes states z (2n,) or (2n, m) to S (S - 1/lambda_0)^-1 (S - lambda_0)^-1 z."""
        factor, n = self.factorise(ratio), self.band.n

        def resolvent(z: ComplexArray, shift: complex, *, transposed: bool) -> ComplexArray:
            """(S - shift)^-1 z = (M - shift L)^-1 L z."""
            u, v = z[:n], z[n:]
            q = -factor.solve(self.A_on @ u - v / shift, transposed=transposed)
            return np.concatenate([q, (self.A_back @ q - v) / shift])

        def apply(z: ComplexArray) -> ComplexArray:
            w = resolvent(z, ratio, transposed=False)
            return w + resolvent(w, 1.0 / ratio, transposed=True) / ratio

        return apply

    def refined(self, nu: complex) -> Pair:
        """The pair of waves at an eigenvalue found, to rounding.

        Inverse iteration from both sides, with the ratio that annuls y^T A(lambda) x: cubic.
        """
        root = np.sqrt(nu / 2.0 - 1.0) * np.sqrt(nu / 2.0 + 1.0)
        ratio = complex(nu / 2.0 + root if abs(nu / 2.0 - root) > 1.0 else nu / 2.0 - root)
        x: ComplexArray = np.random.default_rng(1).standard_normal(self.band.n) + 0j
        y = x
        for _ in range(STEPS):
            slope = self.A_on - self.A_back / ratio**2
            factor = self.factorise(ratio)
            f = slope @ x
            x, y = factor.solve(f), factor.solve(slope.T @ y, transposed=True)
            change = (y @ f) / (y @ (slope @ x))
            f, x, y = f / np.linalg.norm(x), x / np.linalg.norm(x), y / np.linalg.norm(y)
            if not abs(change) < 0.1 * abs(ratio):
                break
            ratio = complex(ratio - change)
            if abs(change) < 1e-14 * abs(ratio):
                break
        return Pair(ratio, x, y, max(self._residual(ratio, x), self._residual(1.0 / ratio, y)))

    def _residual(self, ratio: complex, q: ComplexArray) -> float:
        A = self.at(ratio)
        return float(np.linalg.norm(A @ q) / (abs(A).sum(axis=0).max() * np.linalg.norm(q)))
