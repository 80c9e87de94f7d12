"""Symmetries of a cell: proposed by its nodes, proved on its matrices, never assumed.

Three reflections map a cell onto itself, node on node, where it has them:

- `around`, about its own middle plane: (r, y, theta) -> (r, y, alpha - theta), displacements with
  signs (1, 1, -1): revolved cells of isotropic materials;
- `across`, about the tyre's middle plane: (r, -y, theta), signs (1, -1, 1);
- `turned`, both at once, a half turn about a radius: signs (1, -1, -1): cords at +-angle.

The second splits the section's motions into two shares that never mix. The first and the third
make every chain of cells its own mirror image: RR = S LL S and LR^T = S LR S.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array, eye_array, hstack
from scipy.spatial import KDTree

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from tyrefrf.fem.assembly import CellMatrices

SAME_PLACE = 1e-7
"""Distance of a node's image from a node, relative to the cell's size, up to which they match."""

SAME_ENTRY = 1e-10
"""Difference of an entry from its image, relative to its row's and column's diagonal, up to which
they match: above what summing in another order leaves. The residual of every line is computed
without any symmetry."""

UNTOUCHED = 1e-14
"""Part of the loads, relative to all of them, below which motions are not excited."""

AROUND, ACROSS, TURNED = (1, -1), (-1, 1), (-1, -1)
"""Signs of y and of theta (about the cell's middle) under each reflection."""


@dataclass(frozen=True, slots=True, eq=False)
class Share:
    """Motions of a section that a ring of its cells keeps to themselves.

    Q: (n, m) an orthonormal basis of them over the section's free dofs.
    n_even: how many of them the cell's mirror image leaves as they are: these come first, those
        that it turns round follow. None where the cell is not its own mirror image.
    """

    Q: csc_array
    n_even: int | None


def shares(cell: CellMatrices) -> tuple[Share, ...]:
    """All motions of a section, in as many shares as the cell's symmetries allow."""
    n_face = cell.n_face
    across, around, turned = (_reflection(cell, *signs) for signs in (ACROSS, AROUND, TURNED))
    free = ~cell.fixed[:n_face]
    mirror = around if across is not None else around or turned
    S = None if mirror is None else _on(mirror, free)
    if across is not None:
        return tuple(_share(Q, S) for Q in _eigenvectors(_on(across, free)))
    if S is None:
        return (whole(cell),)
    return (_share(csc_array(hstack(_eigenvectors(S))), S),)


def whole(cell: CellMatrices) -> Share:
    """All motions of a section together, whatever symmetries the cell has."""
    n = int(np.sum(~cell.fixed[: cell.n_face]))
    return Share(eye_array(n, format="csc"), None)


def halves(cell: CellMatrices) -> tuple[csc_array, ...]:
    """Bases (n, m) of the motions of a cell's own free dofs that never mix: two, or one of all."""
    free = ~cell.fixed[: cell.n_own]
    across = _reflection(cell, *ACROSS)
    if across is None:
        return (eye_array(int(free.sum()), format="csc"),)
    return _eigenvectors(_on(across, free))


def mapped(Q: csc_array | csr_array, x: ComplexArray) -> ComplexArray:
    """Q x (n, j, k) of motions x (m, j, k) in the basis Q (n, m)."""
    return (Q @ x.reshape(len(x), x[0].size)).reshape(Q.shape[0], *x.shape[1:])


@dataclass(frozen=True, slots=True, eq=False)
class Turnabout:
    """The ring's mirror about its first section, which takes order h to -h: A_-h = R A_h R^-1.

    For a cell that mirrors `around`. Over the own free dofs (n,): dof i of the section falls on
    itself, one inside a cell on its image in the cell before, hence with exp(-i mu).
    """

    image: IntArray
    sign: FloatArray
    inside: BoolArray

    def of(self, x: ComplexArray, mu: FloatArray) -> ComplexArray:
        """R x of motions x (n, h, k) of the orders with these mu (h,)."""
        turned = np.empty_like(x)
        turned[self.image] = self.sign[:, None, None] * x
        inside = self.image[self.inside]
        turned[inside] *= np.exp(-1j * mu)[:, None]
        return turned


def turnabout(cell: CellMatrices) -> Turnabout | None:
    """The ring's mirror, None where the cell has none."""
    around = _reflection(cell, *AROUND)
    if around is None:
        return None
    own, free = slice(0, cell.n_own), ~cell.fixed[: cell.n_own]
    inside = np.arange(cell.n_own) >= cell.n_face
    image = np.where(inside, around.image[own], np.arange(cell.n_own))
    number = np.cumsum(free) - 1
    return Turnabout(number[image[free]], around.sign[own][free], inside[free])


@dataclass(frozen=True, slots=True, eq=False)
class Reflection:
    """Dof i of the cell (n,) falls on dof image[i], with this sign."""

    image: IntArray
    sign: FloatArray


def _reflection(cell: CellMatrices, y: int, theta: int) -> Reflection | None:
    """A reflection of the cell, None if it lacks it."""
    node = _images(cell.points, y, theta)
    if node is None:
        return None
    image = (3 * node[:, None] + np.arange(3)).ravel()
    sign = np.tile([1.0, y, theta], len(node))
    G = csr_array((sign, (image, np.arange(len(image)))), shape=(len(image),) * 2)
    held = np.array_equal(cell.fixed[image], cell.fixed)
    if held and all(_same(G @ A @ G.T, A) for A in _matrices(cell)):
        return Reflection(image, sign)
    return None


def _on(reflection: Reflection, free: BoolArray) -> csc_array:
    """The signed permutation of the free ones of a cell's first dofs: its section, or its own.

    A section's dof that falls on the right section is that of the section all the same.
    """
    n = len(free)
    last = len(reflection.image) - n  # where the right section begins, if these are the left's
    image = reflection.image[:n]
    image = np.where(image >= n, image - last, image)
    S = csc_array((reflection.sign[:n], (image, np.arange(n))), shape=(n, n))
    return S[free][:, free]


def _share(Q: csc_array, mirror: csc_array | None) -> Share:
    """A basis of eigenvectors of the mirror, those that it leaves as they are in front."""
    if mirror is None:
        return Share(Q, None)
    value = (Q * (mirror @ Q)).sum(axis=0)
    return Share(Q[:, np.argsort(-value, kind="stable")], int(np.sum(value > 0.0)))


def _eigenvectors(S: csc_array) -> tuple[csc_array, csc_array]:
    """Orthonormal bases of what a signed permutation of order two keeps, and of what it turns."""
    image = S.indices
    first = np.arange(len(image)) <= image
    found = []
    for value in (1.0, -1.0):
        B = (eye_array(len(image), format="csc") + value * S)[:, first]
        length = np.sqrt((B * B).sum(axis=0))
        found.append(csc_array(B[:, length > 0.0] / length[length > 0.0]))
    return found[0], found[1]


def _images(points: FloatArray, y: int, theta: int) -> IntArray | None:
    """The node (n,) on which each node falls, None where one falls on none."""
    r, along, angle = points.T
    middle = angle.max() / 2.0
    about = np.stack([r, along, r * (angle - middle)], axis=1)
    distance, node = KDTree(about).query(about * [1.0, y, theta])
    size = np.ptp(about, axis=0).max()
    return np.asarray(node) if np.all(distance <= SAME_PLACE * size) else None


def _matrices(cell: CellMatrices) -> Iterator[csr_array]:
    """The cell's D where stiffness and mass weigh the same, and where the mass hardly counts."""
    K = sum(cell.K.values(), start=cell.K_G + cell.K_P)
    diagonal = cell.rows == cell.indices
    omega = float(np.sqrt(np.abs(K[diagonal]).sum() / cell.M[diagonal].sum()))
    for share in (1.0, 0.01):
        yield cell.sparse(cell.dynamic_stiffness(share * omega))


def _same(A: csr_array, B: csr_array) -> bool:
    scale = np.sqrt(np.abs(B.diagonal()))
    difference = (A - B).tocoo()
    bound = SAME_ENTRY * scale[difference.row] * scale[difference.col]
    return bool(np.all(np.abs(difference.data) <= bound))
