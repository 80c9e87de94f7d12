"""Shape functions of lines, quadrilaterals and bricks, linear and quadratic serendipity.

One formula serves 1, 2 and 3 dimensions: a node is known by its natural coordinates, each -1, 0
or +1 (0 for a mid-side). Node order is that of Abaqus: corners of the low face counter-clockwise,
corners of the high face, then the mid-sides of the low face, of the high face, and between them.
Source: Zienkiewicz & Taylor, The Finite Element Method, vol. 1, chapter 6 (serendipity family).
"""

from __future__ import annotations

import numpy as np

from tyrefrf.arrays import BoolArray, FloatArray, IntArray

LINE2 = np.array([[-1.0], [1.0]])
LINE3 = np.array([[-1.0], [1.0], [0.0]])
QUAD4 = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
QUAD8 = np.vstack([QUAD4, [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]]])


def _extrude(plane: FloatArray, z: float) -> FloatArray:
    """Natural coordinates of a plane's nodes at height z."""
    return np.column_stack([plane, np.full(len(plane), z)])


HEX8 = np.vstack([_extrude(QUAD4, -1.0), _extrude(QUAD4, 1.0)])
HEX20 = np.vstack([HEX8, _extrude(QUAD8[4:], -1.0), _extrude(QUAD8[4:], 1.0), _extrude(QUAD4, 0.0)])


def shape(nodes: FloatArray, xi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Values (g, a) and natural gradients (g, a, d) of the shape functions at points xi (g, d).

    nodes: (a, d) one of the tables above; the family follows from whether it has mid-sides.
    """
    n_dims = nodes.shape[1]
    p = 1.0 + xi[:, None, :] * nodes  # (g, a, d); 1 in a mid-side's own direction
    others = np.stack([np.prod(np.delete(p, k, axis=2), axis=2) for k in range(n_dims)], axis=2)
    P = np.prod(p, axis=2)
    if len(nodes) == 2**n_dims:
        return P / 2**n_dims, nodes * others / 2**n_dims

    corner = np.all(nodes != 0.0, axis=1)
    S = xi @ nodes.T - (n_dims - 1)  # (g, a)
    N = np.where(corner, P * S / 2**n_dims, 0.0)
    dN = np.where(corner[:, None], nodes * (others * S[..., None] + P[..., None]) / 2**n_dims, 0.0)
    for a in np.flatnonzero(~corner):
        m = int(np.flatnonzero(nodes[a] == 0.0)[0])
        bubble = 1.0 - xi[:, m] ** 2
        N[:, a] = bubble * P[:, a] / 2 ** (n_dims - 1)
        dN[:, a] = bubble[:, None] * nodes[a] * others[:, a] / 2 ** (n_dims - 1)
        dN[:, a, m] = -2.0 * xi[:, m] * P[:, a] / 2 ** (n_dims - 1)
    return N, dN


def folded(points: FloatArray, quads: IntArray) -> BoolArray:
    """Whether each quadrilateral (e,) is turned inside out: anywhere on 13 x 13 natural points.

    points: (n, 2). quads: (e, 4) or (e, 8).
    """
    nodes = QUAD4 if quads.shape[1] == 4 else QUAD8
    line = np.linspace(-1.0, 1.0, 13)
    _, dN = shape(nodes, np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2))
    J = np.einsum("gak,eai->egki", dN, points[quads], optimize=True)
    return np.asarray(np.any(~(np.linalg.det(J) > 0.0), axis=1))
