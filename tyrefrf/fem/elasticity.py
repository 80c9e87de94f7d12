"""Elasticity matrices, in the order xx, yy, zz, xy, yz, zx with engineering shear strains."""

from __future__ import annotations

import numpy as np

from tyrefrf.arrays import FloatArray

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
