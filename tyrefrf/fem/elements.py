"""Solid elements: eight- and twenty-node bricks, all elements of a mesh at once.

Indices: e element, g Gauss point, a b node, i j Cartesian component, v strain component. Element
dofs run node by node: (a, i). Every element answers two questions, `stiffness` and `mass`, from
Cartesian coordinates X (e, a, 3) [m]. What each element is good for, and where it is not, is
measured in tests/fem; the README's limits sum it up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.errors import MeshError
from tyrefrf.fem.elasticity import VOIGT
from tyrefrf.fem.quadrature import gauss
from tyrefrf.mesh.shapes import HEX8, HEX20, shape

Stiffness = TypeVar("Stiffness", FloatArray, ComplexArray)
"""Real, or complex as the elasticity that it comes from."""


class Element(Protocol):
    """A brick family."""

    @property
    def n_nodes(self) -> int:
        """Nodes per brick: 8 or 20."""
        ...

    def stiffness(self, X: FloatArray, C: Stiffness) -> Stiffness:
        """Stiffness matrices (e, 3a, 3a) [N/m]; C: (6, 6) or (e, g, 6, 6) elasticity [Pa]."""
        ...

    def tangents(self, X: FloatArray) -> FloatArray:
        """Rows dx/dxi, dx/deta, dx/dzeta (e, g, 3, 3) [m] at the stiffness's Gauss points."""
        ...

    def full_strain(self, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """B (e, g, 6, 3a + modes) [1/m] of nodes, then incompatible modes; dV (e, g) [m3]."""
        ...

    def mass(self, X: FloatArray, rho: float) -> FloatArray:
        """Consistent mass matrices (e, 3a, 3a) [kg]; rho: density [kg/m3]."""
        ...

    @property
    def finite_strain(self) -> bool:
        """Whether the brick can take part in a Newton iteration on finite strains."""
        ...

    def displacement_gradient(self, X: FloatArray, C: FloatArray) -> tuple[FloatArray, FloatArray]:
        """H (e, g, 3, 3, 3a) [1/m] with du_i/dx_j = H u, and volumes dV (e, g) [m3]."""
        ...

    def stress(self, X: FloatArray, C: FloatArray, u: FloatArray) -> FloatArray:
        """Stress (e, g, 6) [Pa] under small displacements u (e, 3a) [m]."""
        ...


@dataclass(frozen=True, slots=True)
class Isoparametric:
    """Displacement brick: strains straight from the shape functions.

    n_nodes: 8 or 20. points: Gauss points per direction for the stiffness; 2 with 20 nodes is
    the reduced brick. mass_points: likewise for the mass; 3 is exact for straight-sided bricks
    of 8 nodes, where 2 (CalculiX's) misses entries of distorted ones by up to 4e-4.
    """

    n_nodes: int
    points: int
    mass_points: int = 3

    @property
    def natural(self) -> FloatArray:
        """Natural coordinates (a, 3) of the nodes."""
        return HEX8 if self.n_nodes == 8 else HEX20

    def strain(self, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Strain matrices B (e, g, 6, 3a) [1/m] and volumes dV (e, g) [m3] of the Gauss points."""
        xi, w = gauss(self.points, 3)
        grad, det = gradients(X, shape(self.natural, xi)[1])
        return strain_matrix(grad), det * w

    @property
    def finite_strain(self) -> bool:
        """Whether strains are the displacement gradient's, as finite strains need."""
        return True

    def displacement_gradient(self, X: FloatArray, C: FloatArray) -> tuple[FloatArray, FloatArray]:
        """H (e, g, 3, 3, 3a) [1/m] with du_i/dx_j = H u, and volumes dV (e, g) [m3].

        C is used only by bricks whose inner modes depend on it.
        """
        xi, w = gauss(self.points, 3)
        grad, det = gradients(X, shape(self.natural, xi)[1])
        return gradient_matrix(grad), det * w

    def stress(self, X: FloatArray, C: FloatArray, u: FloatArray) -> FloatArray:
        """Stress (e, g, 6) [Pa], Cartesian, under small displacements u (e, 3a) [m]."""
        strain = np.einsum("egvn,en->egv", self.strain(X)[0], u, optimize=True)
        return np.einsum("...vw,...w->...v", C, strain)

    def tangents(self, X: FloatArray) -> FloatArray:
        """Rows dx/dxi, dx/deta, dx/dzeta (e, g, 3, 3) [m] at the stiffness's Gauss points."""
        return jacobian(X, shape(self.natural, gauss(self.points, 3)[0])[1])

    def full_strain(self, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """B and dV: there are no modes."""
        return self.strain(X)

    def stiffness(self, X: FloatArray, C: Stiffness) -> Stiffness:
        """K = sum over g of B^T C B dV."""
        B, dV = self.strain(X)
        return energy(B, C, B, dV)

    def mass(self, X: FloatArray, rho: float) -> FloatArray:
        """M = sum over g of rho N^T N dV."""
        xi, w = gauss(self.mass_points, 3)
        N, dN = shape(self.natural, xi)
        dV = gradients(X, dN)[1] * w
        M = np.einsum("eg,ga,gb->eab", rho * dV, N, N, optimize=True)
        return np.kron(M, np.eye(3))


@dataclass(frozen=True, slots=True)
class MeanDilatation(Isoparametric):
    """Eight-node brick whose volume change is the element's mean: B-bar, no locking at nu -> 1/2.

    Source: Hughes, The Finite Element Method, section 4.5.2 (mean-dilatation formulation).
    """

    n_nodes: int = 8
    points: int = 2

    @property
    def finite_strain(self) -> bool:
        """The mean dilatation has no finite-strain form here."""
        return False

    def strain(self, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """B with its dilatational part replaced by the volume's average."""
        B, dV = Isoparametric.strain(self, X)
        dilatation = B[:, :, :3].sum(axis=2)
        mean = np.einsum("eg,egn->en", dV, dilatation) / dV.sum(axis=1)[:, None]
        B[:, :, :3] += ((mean[:, None] - dilatation) / 3.0)[:, :, None]
        return B, dV


@dataclass(frozen=True, slots=True)
class Incompatible(Isoparametric):
    """Eight-node brick with Wilson's modes 1 - xi^2, 1 - eta^2, 1 - zeta^2, condensed statically.

    corrected: gradients of the modes from the Jacobian at the centre, scaled by det J0 / det J,
    so that distorted bricks pass the patch test. (CalculiX leaves that factor out; only tests do.)
    The condensed K is linear in E at fixed nu and in nothing else. The modes carry no mass.
    Source: Taylor, Beresford & Wilson, A non-conforming element for stress analysis, Int. J.
    Numer. Meth. Engng 10 (1976), 1211-1219.
    """

    n_nodes: int = 8
    points: int = 2
    corrected: bool = True

    @property
    def finite_strain(self) -> bool:
        """The modes are condensed, so they cannot take part in a Newton iteration."""
        return False

    def displacement_gradient(self, X: FloatArray, C: FloatArray) -> tuple[FloatArray, FloatArray]:
        """H of nodes and modes together, the modes following the nodes as in `stiffness`."""
        H, dV = Isoparametric.displacement_gradient(self, X, C)
        B, B_m = self.strain(X)[0], self.mode_strain(X)
        follow = np.linalg.solve(energy(B_m, C, B_m, dV), energy(B_m, C, B, dV))
        H_m = gradient_matrix(self.mode_gradients(X))
        return H - np.einsum("egijm,emn->egijn", H_m, follow, optimize=True), dV

    def stress(self, X: FloatArray, C: FloatArray, u: FloatArray) -> FloatArray:
        """Stress (e, g, 6) [Pa], the incompatible part included."""
        H, _ = self.displacement_gradient(X, C)
        strain = np.einsum("vij,egijn,en->egv", VOIGT, H, u, optimize=True)
        return np.einsum("...vw,...w->...v", C, strain)

    def full_strain(self, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """B of the nodes and of the nine modes, and dV."""
        B, dV = self.strain(X)
        return np.concatenate([B, self.mode_strain(X)], axis=-1), dV

    def stiffness(self, X: FloatArray, C: Stiffness) -> Stiffness:
        """K_uu - K_um K_mm^-1 K_mu, with m the modes' nine amplitudes per brick."""
        B, dV = self.strain(X)
        B_m = self.mode_strain(X)
        K_um = energy(B, C, B_m, dV)
        K_mm = energy(B_m, C, B_m, dV)
        K = energy(B, C, B, dV) - K_um @ np.linalg.solve(K_mm, K_um.transpose(0, 2, 1))
        return (K + K.transpose(0, 2, 1)) / 2.0  # the solve leaves rounding in the symmetry

    def mode_strain(self, X: FloatArray) -> FloatArray:
        """Strain matrices (e, g, 6, 9) [1/m] of the incompatible modes."""
        return strain_matrix(self.mode_gradients(X))

    def mode_gradients(self, X: FloatArray) -> FloatArray:
        """Cartesian gradients (e, g, mode, 3) [1/m] of the three incompatible modes."""
        xi, _ = gauss(self.points, 3)
        dm = -2.0 * xi[:, None, :] * np.eye(3)  # (g, mode, d)
        _, det = gradients(X, shape(self.natural, xi)[1])
        J0 = jacobian(X, shape(self.natural, np.zeros((1, 3)))[1])
        grad = np.linalg.solve(J0, np.broadcast_to(dm.transpose(0, 2, 1), (len(X), *dm.shape)))
        if self.corrected:
            grad = grad * (np.linalg.det(J0) / det)[:, :, None, None]
        return grad.transpose(0, 1, 3, 2)


ELEMENTS: dict[str, Element] = {
    "hex8i": Incompatible(),
    "hex8": MeanDilatation(),
    "hex20": Isoparametric(n_nodes=20, points=3),
    "hex20r": Isoparametric(n_nodes=20, points=2),
}
"""The elements by the names that case files use."""


def jacobian(X: FloatArray, dN: FloatArray) -> FloatArray:
    """J[e, g, k, i] = dx_i / dxi_k [m] from natural gradients dN (g, a, k)."""
    return np.einsum("gak,eai->egki", dN, X, optimize=True)


def gradients(X: FloatArray, dN: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Cartesian gradients (e, g, a, 3) [1/m] of shape functions and det J (e, g) [m3].

    Raises MeshError naming the bricks that are inverted or flat.
    """
    J = jacobian(X, dN)
    det = np.linalg.det(J)
    bad = np.flatnonzero(np.any(det <= 0.0, axis=1))
    if len(bad):
        raise MeshError(f"inverted or flat bricks: {', '.join(map(str, bad[:10]))}")
    grad = np.linalg.solve(J, np.broadcast_to(dN.transpose(0, 2, 1), (*J.shape[:3], dN.shape[1])))
    return grad.transpose(0, 1, 3, 2), det


def strain_matrix(grad: FloatArray) -> FloatArray:
    """B (e, g, 6, 3a) [1/m] from gradients (e, g, a, 3)."""
    B = np.einsum("vij,egaj->egvai", VOIGT, grad, optimize=True)
    return B.reshape(*B.shape[:3], -1)


def gradient_matrix(grad: FloatArray) -> FloatArray:
    """H (e, g, 3, 3, 3a) [1/m] with du_i/dx_j = H u, from gradients (e, g, a, 3)."""
    H = np.einsum("ik,egaj->egijak", np.eye(3), grad, optimize=True)
    return H.reshape(*H.shape[:4], -1)


def energy(B_a: FloatArray, C: Stiffness, B_b: FloatArray, dV: FloatArray) -> Stiffness:
    """Sum over g of B_a^T C B_b dV: (e, n_a, n_b) [N/m]."""
    stress = (C @ B_b) * dV[..., None, None]
    n_elements, n_gauss, n_strains = B_a.shape[:3]
    flat = (n_elements, n_gauss * n_strains, -1)
    return np.matmul(B_a.reshape(flat).transpose(0, 2, 1), stress.reshape(flat))
