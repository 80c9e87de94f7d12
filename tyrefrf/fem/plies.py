"""Plies of cords in rubber: a ply from its constituents, and a layer from its plies.

Every formula is rational in the rubber's modulus, and holds for a complex one: the correspondence
principle. Source: Hashin, Complex moduli of viscoelastic composites, Int. J. Solids Struct. 6
(1970), 539-552 and 797-807.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.fem.elasticity import rotated

Elasticity = TypeVar("Elasticity", FloatArray, ComplexArray)

IN_PLANE = [0, 1, 3]
"""Strains that plies share: 11, 22, 12."""
OUT_OF_PLANE = [2, 4, 5]
"""Stresses that plies share: 33, 23, 31."""


@dataclass(frozen=True, slots=True)
class Solid:
    """An isotropic constituent: Young's modulus E [Pa], complex if lossy, and Poisson's ratio."""

    E: complex
    nu: float

    @property
    def G(self) -> complex:
        """Shear modulus [Pa]."""
        return self.E / (2.0 * (1.0 + self.nu))

    @property
    def k(self) -> complex:
        """Plane-strain bulk modulus lambda + G [Pa]."""
        return self.G / (1.0 - 2.0 * self.nu)


def halpin_tsai(P_f: complex, P_m: complex, v_f: float, zeta: float) -> complex:
    """P of the composite: P_m (1 + zeta chi v_f)/(1 - chi v_f), chi = (P_f - P_m)/(P_f + zeta P_m).

    zeta = 0 is the Reuss bound, zeta -> infinity the Voigt bound.
    """
    chi = (P_f - P_m) / (P_f + zeta * P_m)
    return P_m * (1.0 + zeta * chi * v_f) / (1.0 - chi * v_f)


def ply_elasticity(cord: Solid, rubber: Solid, v_f: float) -> ComplexArray:
    """Elasticity (6, 6) [Pa] of parallel cords in rubber, axis 1 along the cords.

    v_f: volume fraction of the cords. E_1 and nu_12 by mixture; the plane-strain bulk modulus k
    and both shear moduli by Halpin and Tsai's equations with the zeta that makes them Hermans'
    (for k and G_12 also Hashin and Rosen's exact ones of an assemblage of cylinders). E_2 and nu_23
    follow from these five, so that the elasticity is positive definite, and passive, as its
    constituents are; with cords of rubber it is the rubber's.
    Source: Halpin & Kardos, The Halpin-Tsai equations: a review, Polym. Eng. Sci. 16 (1976),
    344-352.
    """
    bulk_to_shear = 1.0 / (1.0 - 2.0 * rubber.nu)  # k/G of the rubber
    E_1 = v_f * cord.E + (1.0 - v_f) * rubber.E
    nu_12 = v_f * cord.nu + (1.0 - v_f) * rubber.nu
    k = halpin_tsai(cord.k, rubber.k, v_f, 1.0 / bulk_to_shear)
    G_12 = halpin_tsai(cord.G, rubber.G, v_f, 1.0)
    G_23 = halpin_tsai(cord.G, rubber.G, v_f, bulk_to_shear / (bulk_to_shear + 2.0))

    C = np.diag(np.array([E_1 + 4.0 * nu_12**2 * k, k + G_23, k + G_23, G_12, G_23, G_12]))
    C[0, 1:3] = C[1:3, 0] = 2.0 * nu_12 * k
    C[1, 2] = C[2, 1] = k - G_23
    return C


def in_layer(C: Elasticity, angle: float) -> Elasticity:
    """Elasticity in the layer's axes, of a material whose axis 1 is turned by angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return rotated(C, np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]))


def homogenised(plies: Sequence[Elasticity], shares: Sequence[float]) -> Elasticity:
    """Elasticity (6, 6) [Pa] of a stack of thin plies in the stack's axes, 3 across the plies.

    shares: of the thickness, their sum 1. Strains in the plane and stresses across it are the
    same in all plies. The order of the plies is lost: a layer has no coupling of its own between
    stretching and bending.
    Source: Sun & Li, Three-dimensional effective elastic constants for thick laminates,
    J. Compos. Mater. 22 (1988), 629-639; Chou, Carleone & Hsu, Elastic constants of layered media,
    J. Compos. Mater. 6 (1972), 80-93.
    """
    a, b = IN_PLANE, OUT_OF_PLANE
    compliance, follows, reduced = np.zeros((3, 3, 3), plies[0].dtype)
    for C, share in zip(plies, shares, strict=True):
        C_aa, C_ba, C_bb = C[np.ix_(a, a)], C[np.ix_(b, a)], C[np.ix_(b, b)]
        X = np.linalg.solve(C_bb, np.hstack([C_ba, np.eye(3)]))
        follows = follows + share * X[:, :3]
        compliance = compliance + share * X[:, 3:]
        reduced = reduced + share * (C_aa - C_ba.T @ X[:, :3])
    stiff = np.linalg.solve(compliance, np.hstack([follows, np.eye(3)]))
    whole = np.empty_like(plies[0])
    whole[np.ix_(a, a)] = reduced + follows.T @ stiff[:, :3]
    whole[np.ix_(b, a)] = stiff[:, :3]
    whole[np.ix_(a, b)] = stiff[:, :3].T
    whole[np.ix_(b, b)] = stiff[:, 3:]
    return (whole + whole.T) / 2.0  # the solves leave rounding in the symmetry
