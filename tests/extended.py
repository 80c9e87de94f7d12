"""Rings in 80-bit numbers: matrices by the elements' own formulas, solved order by order.

What double precision loses, in the matrices and in the solution, is the difference to this. Only
where numpy's longdouble has more digits than double (`HAS_MORE_DIGITS`): x86.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace

import numpy as np
from rings import Ring
from scipy.linalg import lu_factor, lu_solve

from tyrefrf.fem import elements
from tyrefrf.fem.elasticity import isotropic
from tyrefrf.fem.quadrature import gauss
from tyrefrf.mesh.shapes import shape

REAL, COMPLEX = np.longdouble, np.clongdouble
HAS_MORE_DIGITS = np.finfo(REAL).eps < 1e-18
PI = REAL("3.14159265358979323846264338327950288")
AT_ONCE = 2000  # orders


def solve(A, B):
    """A^-1 B of stacks (..., n, n) and (..., n, m), by elimination with pivots."""
    stack = np.broadcast_shapes(A.shape[:-2], B.shape[:-2])
    kind = np.result_type(A, B, REAL)
    A, B = (
        np.array(np.broadcast_to(x, stack + x.shape[-2:]), kind).reshape(-1, *x.shape[-2:])
        for x in (A, B)
    )
    each, n = np.arange(len(A)), A.shape[-1]
    for k in range(n):
        pivot = k + np.argmax(np.abs(A[:, k:, k]), axis=1)
        for x in (A, B):
            x[each, pivot], x[:, k] = x[:, k].copy(), x[each, pivot].copy()
        factor = A[:, k + 1 :, k] / A[:, k, k][:, None]
        A[:, k + 1 :, k:] -= factor[:, :, None] * A[:, k, k:][:, None]
        B[:, k + 1 :] -= factor[:, :, None] * B[:, k][:, None]
    for k in reversed(range(n)):
        B[:, k] /= A[:, k, k][:, None]
        B[:, :k] -= A[:, :k, k][:, :, None] * B[:, k][:, None]
    return B.reshape(*stack, *B.shape[-2:])


def refined(A, B, times: int = 60):
    """A^-1 B (n, m) of extended A (n, n), by double factors and extended residuals."""
    factors = lu_factor(A.astype(complex))
    x = np.zeros(B.shape, COMPLEX)
    for _ in range(times):
        x += lu_solve(factors, (B - A @ x).astype(complex))
    return x


def _det(J):
    return np.einsum("...i,...i->...", J[..., 0, :], np.cross(J[..., 1, :], J[..., 2, :]))


def _einsum(subscripts, *operands, optimize=False):
    """Pair by pair: numpy's own has no fast way for these numbers."""
    path = ["einsum_path", *([(0, 1)] * (len(operands) - 1))] if len(operands) > 2 else False
    return np.einsum(subscripts, *operands, optimize=path)


class _Numpy:
    """numpy for `fem.elements`, whose LAPACK knows no more than double precision."""

    linalg = SimpleNamespace(solve=solve, det=_det)
    einsum = staticmethod(_einsum)

    def __getattr__(self, name):
        return getattr(np, name)


@contextmanager
def _extended_elements() -> Iterator[None]:
    plain, elements.np = elements.np, _Numpy()
    try:
        yield
    finally:
        elements.np = plain


@dataclass(frozen=True)
class ExtendedRing:
    """A ring's cell in 80-bit numbers, of exact angles; Rayleigh's damping left out."""

    ring: Ring

    @cached_property
    def matrices(self):
        """K by material and M (n, n) of the cell in r, y and theta."""
        ring, mesh = self.ring, self.ring.mesh
        r, y, _ = mesh.points.astype(REAL).T
        step = 2 * PI / ring.n_cells / (len(mesh.planes) - 1)
        theta = np.round(mesh.points[:, 2] / float(step)).astype(REAL) * step
        c, s = np.cos(theta), np.sin(theta)
        X = np.stack([r * c, y, r * s], axis=1)[mesh.bricks]
        o = 0.0 * c
        turn = np.array([[c, o, s], [o, o + 1.0, o], [-s, o, c]]).transpose(2, 0, 1)
        K, M = {}, 0.0
        with _extended_elements():
            for index, name in enumerate(mesh.materials):
                here, stuff = mesh.material == index, ring.materials[name]
                C = isotropic(REAL(stuff.E), REAL(stuff.nu))
                bricks = ring.element.stiffness(X[here], C)
                K[name] = self._added(here, bricks, turn)
                M = M + self._added(here, self._mass(X[here], stuff.rho), turn)
        return K, M

    def _mass(self, X, rho):
        """Consistent masses (e, 3a, 3a) of bricks X (e, a, 3)."""
        element = self.ring.element
        xi, w = gauss(element.mass_points, 3)
        N, dN = shape(element.natural, xi)
        dV = elements.gradients(X, dN)[1] * w
        M = np.einsum("ega,gb->eab", (rho * dV)[..., None] * N, N.astype(REAL))
        return np.einsum("eab,ij->eaibj", M, np.eye(3)).reshape(len(M), 3 * len(M[0]), -1)

    def _added(self, here, A, turn):
        mesh = self.ring.mesh
        total = np.zeros((3 * mesh.n_nodes,) * 2, REAL)
        for nodes, block in zip(mesh.bricks[here], A, strict=True):
            a = len(nodes)
            T = turn[nodes]
            local = np.einsum("aij,ajbk->aibk", T, block.reshape(a, 3, a, 3))
            local = np.einsum("aibk,blk->aibl", local, T).reshape(3 * a, 3 * a)
            dofs = (3 * nodes[:, None] + np.arange(3)).ravel()
            total[np.ix_(dofs, dofs)] += local
        return total

    def rounded(self):
        """The same with the matrices that double precision gave: what the solvers work on."""
        cell = self.ring.cell
        K = {name: cell.sparse(data).toarray().astype(REAL) for name, data in cell.K.items()}
        other = ExtendedRing(self.ring)
        other.__dict__["matrices"] = K, cell.sparse(cell.M).toarray().astype(REAL)
        return other

    def sections(self, omega: float, dof: int, cells=(0,)):
        """Displacements (len(cells), n_own) of some cells under a unit force on the first's dof."""
        ring, cell = self.ring, self.ring.cell
        K, M = self.matrices
        D = sum((1 + 1j * REAL(ring.materials[name].eta)) * A for name, A in K.items())
        D = D.astype(COMPLEX) - REAL(omega) ** 2 * M
        n_own, n_face, N = cell.n_own, cell.n_face, ring.n_cells
        free = np.flatnonzero(~cell.fixed[:n_own])
        straight = D[:n_own, :n_own].copy()
        straight[:n_face, :n_face] += D[n_own:, n_own:]
        on, back = np.zeros_like(straight), np.zeros_like(straight)
        on[:, :n_face], back[:n_face] = D[:n_own, n_own:], D[n_own:, :n_own]
        straight, on, back = (A[np.ix_(free, free)] for A in (straight, on, back))
        f = (free == dof).astype(COMPLEX)[:, None] / N
        q = np.zeros((len(cells), n_own), COMPLEX)
        orders = np.arange(N) - (N - 1) // 2
        for h in np.split(orders, range(AT_ONCE, N, AT_ONCE)):
            turn = np.exp(1j * (2 * PI * h.astype(REAL) / N))
            x = solve(straight + turn[:, None, None] * on + back / turn[:, None, None], f)[..., 0]
            for k, j in enumerate(cells):
                q[k, free] += np.exp(1j * (2 * PI * ((h * j) % N).astype(REAL) / N)) @ x
        return q
