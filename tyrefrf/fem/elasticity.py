"""Elasticity matrices, in the order xx, yy, zz, xy, yz, zx with engineering shear strains."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray

Elasticity = TypeVar("Elasticity", FloatArray, ComplexArray)

VOIGT = np.zeros((6, 3, 3))
"""Strain number v = sum over i, j of VOIGT[v, i, j] du_i/dx_j."""
for _v, (_i, _j) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]):
    VOIGT[_v, _i, _j] = VOIGT[_v, _j, _i] = 1.0


def isotropic(E: float, nu: float) -> FloatArray:
    """Elasticity matrix (6, 6) [Pa] of an isotropic material (Hooke's law).

    E: Young's modulus [Pa]; nu: Poisson's ratio, -1 < nu < 1/2.
    """
    G = E / (2.0 * (1.0 + nu))
    lam = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    C = np.diag([2.0 * G] * 3 + [G] * 3)
    C[:3, :3] += lam
    return C


def orthotropic(
    E: tuple[float, float, float], nu: tuple[float, float, float], G: tuple[float, float, float]
) -> FloatArray:
    """Elasticity matrix (6, 6) [Pa] of an orthotropic material in its own axes.

    E: E_1, E_2, E_3 [Pa]; nu: nu_12, nu_13, nu_23, with nu_ij the contraction along j over the
    stretch along i under stress along i; G: G_12, G_13, G_23 [Pa].
    """
    S = np.diag(1.0 / np.array(E))
    for (i, j), nu_ij in zip([(0, 1), (0, 2), (1, 2)], nu, strict=True):
        S[i, j] = S[j, i] = -nu_ij / E[i]
    G_12, G_13, G_23 = G
    C = np.diag([0.0, 0.0, 0.0, G_12, G_23, G_13])
    direct = np.linalg.solve(S, np.eye(3))
    C[:3, :3] = (direct + direct.T) / 2.0  # the solve leaves rounding in the symmetry
    return C


def strain_rotation(Q: FloatArray) -> FloatArray:
    """Bond's matrix T (..., 6, 6): strains along the axes Q are T times those along x, y, z.

    Q: (..., 3, 3) orthonormal, its rows the axes, right- or left-handed.
    Source: Bond, The mathematics of the physical properties of crystals, Bell Syst. Tech. J. 22
    (1943), 1-72.
    """
    halved = VOIGT * np.where(np.arange(6) < 3, 1.0, 0.5)[:, None, None]
    return np.einsum("vkl,...ki,...lj,wij->...vw", VOIGT, Q, Q, halved, optimize=True)


def rotated(C: Elasticity, Q: FloatArray) -> Elasticity:
    """Elasticity (..., 6, 6) along x, y, z of a material whose elasticity along the axes Q is C."""
    T = strain_rotation(Q)
    return np.swapaxes(T, -1, -2) @ C @ T
