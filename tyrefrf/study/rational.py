"""One rational fit of many responses: common poles, found from few samples.

The responses of a structure have their poles in common, so the fit is barycentric with support
points z_j and weights w_j that serve all of them,

    r(x) = sum_j w_j f_j / (x - z_j)  /  sum_j w_j / (x - z_j),

which takes the values f_j at the z_j whatever the weights are. The AAA algorithm adds support
points where the fit is worst, and takes the weights that leave the least in the linearised
equations of all other samples.
Sources: Nakatsukasa, Sete & Trefethen, The AAA algorithm for rational approximation, SIAM J. Sci.
Comput. 40 (2018), A1494-A1522; for many functions: Lietaert, Meerbergen, Perez & Vandereycken,
Automatic rational approximation and linearization of nonlinear eigenvalue problems, IMA J. Numer.
Anal. 42 (2022), 1087-1115; with random combinations in their place: Guettel, Negri Porzio &
Tisseur, Robust rational approximations of nonlinear eigenvalue problems, SIAM J. Sci. Comput. 44
(2022), A2439-A2463. scipy's own AAA takes one function at a time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigvals

from tyrefrf.arrays import ComplexArray, FloatArray, IntArray

COMBINATIONS = 16
"""Random combinations of the responses that stand for all of them when weights are sought."""
SPARE = 2
"""Samples at least that are left for the weights, beside as many equations as weights."""
AT_ONCE = 6
"""For so many support points that there are, one more is added at a time. On the homogeneous tyre
that took as many lines as adding them singly, 144 and 152, in a third of the time."""


@dataclass(frozen=True, slots=True, eq=False)
class Rational:
    """A fit in barycentric form; it knows its poles, and not the responses.

    support: (m,) numbers of the samples that it interpolates. z: (m,) their places. w: (m,).
    """

    support: IntArray
    z: FloatArray
    w: ComplexArray

    def basis(self, x: FloatArray) -> ComplexArray:
        """(len(x), m) what each support value contributes at x: r(x) = basis @ f."""
        with np.errstate(divide="ignore", invalid="ignore"):
            cauchy = self.w / (x[:, None] - self.z)
            basis = cauchy / cauchy.sum(axis=1, keepdims=True)
        hit, which = np.nonzero(x[:, None] == self.z)
        basis[hit] = 0.0
        basis[hit, which] = 1.0
        return basis

    def poles(self) -> ComplexArray:
        """(up to m - 1,) zeros of the denominator: finite eigenvalues of an arrowhead pencil."""
        m = len(self.z)
        centre, span = self.z.mean(), np.ptp(self.z) or 1.0
        arrow = np.zeros((m + 1, m + 1), complex)
        arrow[0, 1:], arrow[1:, 0] = self.w, 1.0
        arrow[1:, 1:] = np.diag((self.z - centre) / span)
        B = np.eye(m + 1)
        B[0, 0] = 0.0
        found = eigvals(arrow, B)
        return centre + span * found[np.isfinite(found)]

    def residues(self, poles: ComplexArray) -> ComplexArray:
        """(n_poles, m) what each support value contributes to the residue at simple poles."""
        cauchy = 1.0 / (poles[:, None] - self.z)
        return self.w * cauchy / -np.sum(self.w * cauchy**2, axis=1, keepdims=True)


def fit(
    x: FloatArray,
    values: ComplexArray,
    weight: FloatArray,
    tolerance: float,
    start: Sequence[int] = (),
) -> Rational:
    """Fit values (k, r) at x (k,) until |error| * weight (k, r) is within a tolerance everywhere.

    start: numbers of samples that are to be support points whatever happens, such as those of a
    fit to fewer samples. The fit ends short of the tolerance where the samples do not determine
    more weights.
    """
    some = _combined(values)
    most = _most_support(len(x), some.shape[1])
    support = list(start)[:most] or [int(np.argmax(np.linalg.norm(values, axis=1)))]
    while True:
        rational = _weighted(x, some, support)
        error = (np.abs(rational.basis(x) @ values[support] - values) * weight).max(axis=1)
        error[support] = 0.0
        room = min(most - len(support), max(1, len(support) // AT_ONCE))
        worst = [int(i) for i in np.argsort(-error, kind="stable")[:room] if error[i] > tolerance]
        if not worst:
            return rational
        support += worst


def _most_support(k: int, r: int) -> int:
    """Support points that k samples of r responses determine the weights of."""
    return max(1, min(k - SPARE, k * r // (r + 1)))


def _combined(values: ComplexArray) -> ComplexArray:
    """Responses (k, r), or as many random combinations of them as is enough."""
    n = values.shape[1]
    if n <= COMBINATIONS:
        return values
    rng = np.random.default_rng(0)
    mix = rng.standard_normal((2, n, COMBINATIONS)) / np.sqrt(2.0 * COMBINATIONS)
    return values @ (mix[0] + 1j * mix[1])


def _weighted(x: FloatArray, values: ComplexArray, support: list[int]) -> Rational:
    """The weights that leave the least of sum_j w_j (f(x) - f_j) / (x - z_j) at other samples."""
    others = np.setdiff1d(np.arange(len(x)), support)
    z, f = x[support], values[support]
    w = np.ones(len(support), complex)
    if len(support) > 1 and len(others):
        loewner = (values[others][:, None] - f) / (x[others, None] - z)[:, :, None]
        rows = loewner.transpose(0, 2, 1).reshape(-1, len(support))
        w = np.linalg.svd(rows, full_matrices=len(rows) < len(support))[2][-1].conj()
    return Rational(np.array(support), z, w)
