"""From the cell's mesh to its matrices, in cylindrical dofs: [6]-[13] and [23] of the paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_array

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from tyrefrf.fem.constitutive import Constitutive, Scaled, constitutive
from tyrefrf.fem.elements import Element
from tyrefrf.fem.frames import rotations, turned
from tyrefrf.fem.orientation import in_bricks, layer_axes
from tyrefrf.fem.relaxation import Reassembly, Relaxation, Scaling
from tyrefrf.mesh.cell import CellMesh

if TYPE_CHECKING:
    from tyrefrf.case import Damping, Material


@dataclass(frozen=True, slots=True, eq=False)
class CellMatrices:
    """One cell's matrices in cylindrical dofs (r, y, theta) node by node.

    Dofs are ordered as the cell's nodes: left section, interior, right section. All matrices
    share one sparsity pattern (indptr, indices) of compressed rows; each is its data (nnz,).

    K: reference stiffness per material [N/m], loss-free; relaxation: what each becomes at a
    frequency.
    M: mass [kg]; C: viscous damping [N s/m]. K_G, K_P: geometric and pressure stiffness [N/m] of
    an inflated cell, both without loss; zero at rest.
    n_face: dofs of one section. fixed: (n,) dofs on the rim.
    points: (n / 3, 3) r [m], y [m] and theta [rad] of the cell's nodes.
    of_no_node: (n / 3,) where dofs are unknowns without a node, as brought matrices may have them.
    """

    indptr: IntArray
    indices: IntArray
    K: Mapping[str, FloatArray]
    relaxation: Mapping[str, Relaxation]
    M: FloatArray
    C: FloatArray
    K_G: FloatArray
    K_P: FloatArray
    n_face: int
    fixed: BoolArray
    points: FloatArray
    of_no_node: BoolArray

    @property
    def n_dofs(self) -> int:
        """Dofs of the cell, both sections and fixed ones included."""
        return len(self.fixed)

    @property
    def n_own(self) -> int:
        """Dofs that the cell brings to the ring: all but the right section's."""
        return self.n_dofs - self.n_face

    @property
    def rows(self) -> IntArray:
        """Row of every entry of the pattern (nnz,)."""
        return np.repeat(np.arange(self.n_dofs), np.diff(self.indptr))

    @property
    def static(self) -> FloatArray:
        """Entries (nnz,) of K + K_G + K_P, loss-free."""
        return sum(self.K.values(), start=self.K_G + self.K_P)

    def dynamic_stiffness(self, omega: float) -> ComplexArray:
        """Entries (nnz,) of D = K + K_G + K_P + i omega C - omega^2 M: [1] and below [23].

        K is the sum of (1 + i eta_m) K_m over the materials, or of what else becomes of their K_m.
        """
        D = 1j * omega * self.C - omega**2 * self.M + self.K_G + self.K_P
        for name, K in self.K.items():
            D += self.relaxation[name].stiffness(K, omega)
        return D

    def sparse(self, data: ComplexArray | FloatArray) -> csr_array:
        """A matrix of this pattern (n, n) as scipy knows it."""
        return csr_array((data, self.indices, self.indptr), shape=(self.n_dofs, self.n_dofs))


def assemble_cell(
    mesh: CellMesh, materials: Mapping[str, Material], element: Element, damping: Damping
) -> CellMatrices:
    """Assemble the cell's K per material, M and C = alpha M + beta K.

    materials: by the names in `mesh.materials`. The rim's nodes are marked fixed.
    Raises MeshError where a brick is inverted.
    """
    return CellAssembly(mesh, element).cell(materials, damping)


class CellAssembly:
    """The bricks of a mesh, integrated once for all materials that only differ in size.

    K is linear in Young's modulus at a given form of the elasticity, and M in the density: both
    are integrated for unit size and then scaled, always, so that a cell does not depend to the
    bit on what was assembled before.
    """

    def __init__(self, mesh: CellMesh, element: Element) -> None:
        self.mesh, self.element = mesh, element
        self._X = mesh.cartesian[mesh.bricks]
        self._T = rotations(mesh.points[mesh.bricks, 2])
        self._dofs = dofs_of(mesh.bricks)
        self._pattern = Pattern.of(self._dofs, 3 * mesh.n_nodes)
        self._K: dict[tuple[int, bytes], FloatArray] = {}
        self._M: dict[int, FloatArray] = {}
        self._parts: dict[int, Reassembly] = {}

    def cell(self, materials: Mapping[str, Material], damping: Damping) -> CellMatrices:
        """The cell's matrices; materials by the names in `mesh.materials`."""
        mesh, pattern = self.mesh, self._pattern
        K: dict[str, FloatArray] = {}
        relaxation: dict[str, Relaxation] = {}
        M = np.zeros(pattern.nnz)
        for index, name in enumerate(mesh.materials):
            stuff = constitutive(materials[name])
            K[name] = stuff.size * self._stiffness(index, stuff)
            relaxation[name] = self._relaxation(index, stuff)
            M += stuff.rho * self._mass(index)

        fixed = np.zeros((mesh.n_nodes, 3), dtype=bool)
        fixed[mesh.rim] = True
        return CellMatrices(
            indptr=pattern.indptr,
            indices=pattern.indices,
            K=K,
            relaxation=relaxation,
            M=M,
            C=damping.alpha * M + damping.beta * sum(K.values(), start=np.zeros(pattern.nnz)),
            K_G=np.zeros(pattern.nnz),
            K_P=np.zeros(pattern.nnz),
            n_face=3 * mesh.n_face,
            fixed=fixed.ravel(),
            points=mesh.points,
            of_no_node=np.zeros(mesh.n_nodes, dtype=bool),
        )

    def _stiffness(self, index: int, stuff: Constitutive) -> FloatArray:
        """Entries of K of the material with this index, for its elasticity's form."""
        key = index, stuff.form.tobytes()
        if key not in self._K:
            here = self.mesh.material == index
            C = in_bricks(stuff, stuff.form, self.element, self._X[here])
            self._K[key] = self._add(here, self.element.stiffness(self._X[here], C))
        return self._K[key]

    def _mass(self, index: int) -> FloatArray:
        """Entries of M for unit density."""
        if index not in self._M:
            here = self.mesh.material == index
            self._M[index] = self._add(here, self.element.mass(self._X[here], 1.0))
        return self._M[index]

    def _relaxation(self, index: int, stuff: Constitutive) -> Relaxation:
        """What becomes of K at a frequency."""
        if isinstance(stuff, Scaled):
            return Scaling(stuff.modulus)
        if index not in self._parts:
            here = self.mesh.material == index
            slots = self._pattern.slots(self._dofs[here])
            self._parts[index] = at_rest(stuff, self.element, self._X[here], self._T[here], slots)
        return replace(self._parts[index], stuff=stuff)

    def _add(self, here: BoolArray, A: FloatArray) -> FloatArray:
        """Cartesian matrices of some bricks as entries of the cell's pattern."""
        return self._pattern.add(self._dofs[here], turned(self._T[here], A))


def at_rest(
    stuff: Constitutive, element: Element, X: FloatArray, T: FloatArray, slots: IntArray
) -> Reassembly:
    """The stiffness of bricks X (e, a, 3) whose elasticity changes its form with frequency.

    T: (e, 3a, 3a) `rotations`, slots: (e, 3a, 3a) entries of the pattern, of the bricks' nodes.
    """
    B, dV = element.full_strain(X)
    return Reassembly.of(stuff, B, dV, layer_axes(element.tangents(X)), T, slots)


def dofs_of(nodes: IntArray) -> IntArray:
    """Dofs (e, 3a) of bricks or faces with nodes (e, a): (r, y, theta) node by node."""
    return (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), -1)


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """The sparsity of the cell's matrices: an entry for every two dofs that share a brick.

    keys: (nnz,) row * n + column of the entries, in order.
    """

    n: int
    keys: IntArray

    @classmethod
    def of(cls, dofs: IntArray, n: int) -> Pattern:
        """The pattern of bricks with dofs (e, 3a) among n dofs."""
        return cls(n, np.unique(dofs[:, :, None] * n + dofs[:, None, :]))

    @property
    def nnz(self) -> int:
        """Entries kept."""
        return len(self.keys)

    @property
    def indptr(self) -> IntArray:
        """Where each row's entries begin (n + 1,)."""
        return np.searchsorted(self.keys, np.arange(self.n + 1) * self.n)

    @property
    def indices(self) -> IntArray:
        """Columns of the entries (nnz,)."""
        return self.keys % self.n

    def add(self, dofs: IntArray, A: FloatArray) -> FloatArray:
        """Sum matrices A (e, m, m) of bricks or faces with dofs (e, m) into the entries (nnz,)."""
        total = np.bincount(self.slots(dofs).ravel(), weights=A.ravel(), minlength=self.nnz)
        return total.astype(np.float64, copy=False)  # numpy's stubs take it for integers

    def slots(self, dofs: IntArray) -> IntArray:
        """Where the entries (e, m, m) of bricks or faces with dofs (e, m) stand."""
        return np.searchsorted(self.keys, dofs[:, :, None] * self.n + dofs[:, None, :])
