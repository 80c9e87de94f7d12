"""Pressure on a surface that moves: nodal forces and the stiffness they bring.

Indices: f face, a b node, i k Cartesian component. With natural coordinates (xi, zeta) of a face
and tangents g_1 = dx/dxi, g_2 = dx/dzeta, the pressure p on it gives f_a = p int N_a (g_1 x g_2):
it pushes along g_1 x g_2 and follows the surface.
Source: Hibbitt, Some follower forces and load stiffness, Int. J. Numer. Meth. Engng 14 (1979),
937-941.
"""

from __future__ import annotations

import numpy as np

from tyrefrf.arrays import FloatArray
from tyrefrf.fem.quadrature import gauss
from tyrefrf.mesh.shapes import QUAD4, QUAD8, shape

LEVI_CIVITA = np.zeros((3, 3, 3))
for _i, _j, _k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    LEVI_CIVITA[_i, _j, _k], LEVI_CIVITA[_j, _i, _k] = 1.0, -1.0


def _at_points(x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """N (g, a), dN (g, a, 2), weights (g,) and tangents (f, g, 2, 3) of faces x (f, a, 3)."""
    nodes, n = (QUAD4, 2) if x.shape[1] == 4 else (QUAD8, 3)
    xi, w = gauss(n, 2)
    N, dN = shape(nodes, xi)
    return N, dN, w, np.einsum("gad,fai->fgdi", dN, x, optimize=True)


def pressure_forces(x: FloatArray) -> FloatArray:
    """Forces (f, 3a) [N] of a unit pressure on faces with corners and mid-sides x (f, a, 3) [m]."""
    N, _, w, g = _at_points(x)
    normal = np.cross(g[:, :, 0], g[:, :, 1])
    return np.einsum("g,ga,fgi->fai", w, N, normal, optimize=True).reshape(len(x), -1)


def pressure_stiffness(x: FloatArray) -> FloatArray:
    """-df/du (f, 3a, 3a) [N/m per Pa] of `pressure_forces`, symmetrised.

    The raw matrix is unsymmetric face by face; over a closed surface, or one whose edges are
    fixed, its skew part cancels, and the symmetrised one is exact.
    """
    N, dN, w, g = _at_points(x)
    turn = np.einsum("ikm,fgm,gb->fgikb", LEVI_CIVITA, g[:, :, 1], dN[:, :, 0], optimize=True)
    turn -= np.einsum("ikm,fgm,gb->fgikb", LEVI_CIVITA, g[:, :, 0], dN[:, :, 1], optimize=True)
    K = -np.einsum("g,ga,fgikb->faibk", w, N, turn, optimize=True)
    K = K.reshape(len(x), 3 * x.shape[1], -1)
    return (K + K.transpose(0, 2, 1)) / 2.0
