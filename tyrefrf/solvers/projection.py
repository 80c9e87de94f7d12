"""The ring's equations of one order, projected on some of its modes, and what those leave out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray
from tyrefrf.errors import SingularError
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.fem.relaxation import Scaling
from tyrefrf.solvers.modes import OrderModes
from tyrefrf.solvers.orders import Folded, Orders

RESONANT = 1e-9
"""A mode without damping whose squared frequency is this close to a line's has no trustworthy
answer there, relative to the sum of both."""
ELSEWHERE = 2.0 * np.pi * 1000.0
"""A frequency [rad/s] at which all that depends on frequency is not what it is at 0 Hz."""


class Parts:
    """The cell's dynamic stiffness as D(omega) = sum over k of c_k(omega) X_k + rest(omega).

    Whatever frequency only scales is a part X_k, and is projected once; the rest is what becomes
    of materials whose elasticity changes its form, and has to be projected line by line.
    """

    def __init__(self, cell: CellMatrices) -> None:
        self.orders = Orders(cell)
        self._moduli, self._others = [], []
        X = [cell.K_G + cell.K_P, cell.C, cell.M]
        for name, K in cell.K.items():
            relaxation = cell.relaxation[name]
            if isinstance(relaxation, Scaling):
                self._moduli.append(relaxation.modulus)
                X.append(K)
            else:
                self._others.append((relaxation, K))
        self.folded = [self.orders.folded(part) for part in X]

    def coefficients(self, omega: float) -> ComplexArray:
        """The c_k (k,): of K_G + K_P, of C, of M, and of the K that moduli scale."""
        scales = [modulus.scale(omega) for modulus in self._moduli]
        return np.array([1.0, 1j * omega, -(omega**2), *scales])

    def rest(self, omega: float) -> Folded | None:
        """What is no such sum; mostly nothing."""
        if not self._others:
            return None
        entries = np.sum([r.stiffness(K, omega) for r, K in self._others], axis=0)
        return self.orders.folded(entries)

    def at(self, folded: Folded, mu: float) -> csc_array:
        """A part, or the rest, at mu = 2 pi h / N: (n, n)."""
        return self.orders.matrix(folded.at(mu))


@dataclass(frozen=True, slots=True, eq=False)
class Projection:
    """The ring's equations on the modes of order h, and on their conjugates for -h.

    As A_-h = A_h^T, the conjugate modes give the transposed matrix: one factor serves both.
    omega_r: (m,) [rad/s]; V: (n, m). parts: (k, m, m) V^H X_k V, or (k, m) of their diagonals
    where the modes are not coupled. f, f_back: (m, n_loads) V^H f_h and V^T f_-h.
    """

    h: int
    mu: float
    omega_r: FloatArray
    V: ComplexArray
    parts: ComplexArray
    f: ComplexArray
    f_back: ComplexArray
    exchange: Exchange | None = None

    @classmethod
    def of(cls, modes: OrderModes, parts: Parts, f_h: ComplexArray, *, coupled: bool) -> Projection:
        """f_h: (N, n, n_loads) loads by order, -h from the end."""
        h, V, mu = modes.order, modes.shapes, 2.0 * np.pi * modes.order / len(f_h)
        return cls(
            h=h,
            mu=mu,
            omega_r=modes.omega,
            V=V,
            parts=np.array([_onto(V, parts.at(X, mu), coupled) for X in parts.folded]),
            f=V.conj().T @ f_h[h],
            f_back=V.T @ f_h[-h],
        )

    def answers(
        self, omega: float, c: ComplexArray, rest: csc_array | None
    ) -> tuple[ComplexArray, ComplexArray]:
        """x_h and x_-h (n, n_loads), from the parts' coefficients and the rest of A_h (n, n)."""
        A = self.kept(c, rest)
        self._check(omega, A.diagonal() if A.ndim == 2 else A)
        if self.exchange is None:
            y, y_back = _solve(A, self.f, self.f_back)
            return self.V @ y, self.V.conj() @ y_back
        g, g_back = self.exchange.forces(c)
        y, y_back = _solve(A, self.f - g, self.f_back - g_back)
        x, x_back = self.exchange.motions(c, y, y_back)
        return self.V @ y - x, self.V.conj() @ y_back - x_back

    def kept(self, c: ComplexArray, rest: csc_array | None) -> ComplexArray:
        """What is kept of V^H A_h V: all (m, m), or the diagonal (m,)."""
        A: ComplexArray = np.tensordot(c, self.parts, axes=1)
        return A if rest is None else A + _onto(self.V, rest, self.parts.ndim == 3)

    def _check(self, omega: float, diagonal: ComplexArray) -> None:
        """Raise SingularError where a mode resonates on the line and nothing damps it."""
        rigid_at_rest = self.omega_r + omega == 0.0
        resonant = np.abs(diagonal) <= RESONANT * (self.omega_r**2 + omega**2)
        endless = self.omega_r[rigid_at_rest | resonant]
        if len(endless):
            hertz = endless[0] / (2.0 * np.pi)
            raise SingularError(
                f"a mode of order {self.h} at {hertz:.6g} Hz resonates undamped on this line; add "
                "a loss factor, fix the rim, or move the line"
            )


@dataclass(frozen=True, slots=True, eq=False)
class Exchange:
    """What the modes V of an order, and all that they leave out, exert on one another beyond 0 Hz.

    At 0 Hz, what is left out moves by G f, G = A_h(0)^-1 - V (V^H A_h(0) V)^-1 V^H, which does not
    answer to A_h(0) V. On another line A_h differs by E = sum of (c_k(omega) - c_k(0)) X_k, and to
    first order in G E

        (V^H A_h V) y = V^H (f - E G f),  x = V y + G f - G E (V y + G f).

    Without the last term the modes' loss forces would stay as they are at 0 Hz, and what is left
    out would have no inertia. What is no such sum (`Parts.rest`) counts as at 0 Hz.
    Source: Rubin, Improved component-mode representation for structural dynamic analysis, AIAA J.
    13 (1975), 995-1006 (residual flexibility, inertia and damping).

    varying: (k,) whether c_k changes; p of them do. c_0: (p,) at 0 Hz. For h, and for -h back:
    T (p, n, m): G X_k V; u (p, n, n_loads): G X_k G f_h; g (p, m, n_loads): V^H X_k G f_h.
    """

    varying: BoolArray
    c_0: ComplexArray
    T: ComplexArray
    T_back: ComplexArray
    u: ComplexArray
    u_back: ComplexArray
    g: ComplexArray
    g_back: ComplexArray

    @classmethod
    def of(cls, order: Projection, parts: Parts, x_h: ComplexArray) -> Exchange:
        """x_h: (N, n, n_loads) G f by order."""
        V, V_back, m = order.V, order.V.conj(), len(order.omega_r)
        all_X = [parts.at(part, order.mu) for part in parts.folded]
        c, rest = parts.coefficients(0.0), parts.rest(0.0)
        varying = parts.coefficients(ELSEWHERE) != c
        A_rest = None if rest is None else parts.at(rest, order.mu)
        A = sum((c_k * X_k for c_k, X_k in zip(c, all_X, strict=True)), start=0.0 * all_X[0])
        lu = splu(csc_array(A if A_rest is None else A + A_rest))
        A_kept = order.kept(c, A_rest)
        moved, moved_back = np.hstack([V, x_h[order.h]]), np.hstack([V_back, x_h[-order.h]])
        G, G_back, g, g_back = [], [], [], []
        for k in np.flatnonzero(varying):
            F, F_back = all_X[k] @ moved, all_X[k].T @ moved_back
            P, P_back = V_back.T @ F, V.T @ F_back
            y, y_back = _solve(A_kept, P, P_back)
            G.append(lu.solve(F) - V @ y)
            x_back = lu.solve(F_back, "T")  # type: ignore[call-overload]  # scipy's stubs lack trans
            G_back.append(x_back - V_back @ y_back)
            g.append(P[:, m:])
            g_back.append(P_back[:, m:])
        T, u = np.split(np.array(G), [m], axis=2)
        T_back, u_back = np.split(np.array(G_back), [m], axis=2)
        return cls(varying, c[varying], T, T_back, u, u_back, np.array(g), np.array(g_back))

    def forces(self, c: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """V^H E G f of h and of -h (m, n_loads)."""
        e = c[self.varying] - self.c_0
        return np.tensordot(e, self.g, axes=1), np.tensordot(e, self.g_back, axes=1)

    def motions(
        self, c: ComplexArray, y: ComplexArray, y_back: ComplexArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """G E (V y + G f) of h and of -h (n, n_loads)."""
        e = c[self.varying] - self.c_0
        return (
            np.tensordot(e, self.T @ y + self.u, axes=1),
            np.tensordot(e, self.T_back @ y_back + self.u_back, axes=1),
        )


def _onto(V: ComplexArray, A: csc_array, coupled: bool) -> ComplexArray:
    """V^H A V (m, m), or its diagonal (m,) alone."""
    AV = A @ V
    return V.conj().T @ AV if coupled else np.einsum("nm,nm->m", V.conj(), AV)


def _solve(
    A: ComplexArray, f: ComplexArray, f_back: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """A^-1 f and A^-T f_back, for A (m, m), m = 0 too, or for a diagonal (m,)."""
    if not len(A):
        return f, f_back
    if A.ndim == 1:
        return f / A[:, None], f_back / A[:, None]
    lu, pivots, _ = lapack.zgetrf(A)
    y, _ = lapack.zgetrs(lu, pivots, f)
    y_back, _ = lapack.zgetrs(lu, pivots, f_back, trans=1)
    return y, y_back
