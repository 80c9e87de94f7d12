"""Which way a section's elements lie in the wall: their corners 0 and 1 from the inside out.

The direction through the wall is the gradient of a potential that is 0 on the inner surface and 1
on the outer one and flows through the wall between (Laplace's equation, by the mesh's own corners
as bilinear elements). It needs no layers to follow, so that free meshes are turned too.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from tyrefrf.arrays import FloatArray
from tyrefrf.mesh.shapes import QUAD4, shape
from tyrefrf.mesh.sheet import Sheet
from tyrefrf.mesh.surfaces import Surfaces

CLEAR = 0.15
"""By how much the cosine of the best edge's angle with the direction through the wall exceeds that
of the second: 0.15 is 6 degrees from the diagonal of a square."""


def outwards(sheet: Sheet, surfaces: Surfaces) -> FloatArray:
    """Unit vectors (e, 2) in (r, y) through the wall, from the inside out, at element centres."""
    corners = sheet.quads[:, :4]
    X = sheet.points[corners]
    gauss = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / np.sqrt(3.0)
    G, dV = _gradients(X, gauss)
    K = np.einsum("egai,egbi,eg->eab", G, G, dV)
    n = len(sheet.points)
    rows = np.broadcast_to(corners[:, :, None], K.shape)
    cols = np.broadcast_to(corners[:, None, :], K.shape)
    A = csc_array((K.ravel(), (rows.ravel(), cols.ravel())), shape=(n, n))

    phi, known = np.zeros(n), np.ones(n, dtype=bool)
    known[corners] = False  # mid-sides stay out of it
    phi[surfaces.outer[:, :2]] = 1.0
    known[surfaces.outer[:, :2]] = True
    known[surfaces.inner[:, :2]] = True
    free = np.flatnonzero(~known)
    if len(free):
        phi[free] = splu(A[free][:, free].tocsc()).solve(-(A[free] @ phi))
    slope = np.einsum("eai,ea->ei", _gradients(X, np.zeros((1, 2)))[0][:, 0], phi[corners])
    return slope / np.linalg.norm(slope, axis=1)[:, None]


def turn(sheet: Sheet, through: FloatArray) -> tuple[Sheet, FloatArray]:
    """The quadrilaterals started where corners 0 and 1 run along `through` (e, 2), unit vectors.

    Also how clear that was (e,): the cosine for the chosen edge less that for the next best.
    """
    P = sheet.points[sheet.quads[:, :4]]
    edge = np.roll(P, -1, axis=1) - P  # of corners k and k + 1
    along = edge - np.roll(edge, -2, axis=1)  # with the opposite one, in the same sense
    cosine = np.einsum("eki,ei->ek", along, through) / np.linalg.norm(along, axis=2)
    best = np.argmax(cosine, axis=1)
    ranked = np.sort(cosine, axis=1)
    corner = (best[:, None] + np.arange(4)) % 4
    places = np.hstack([corner, 4 + corner]) if sheet.quads.shape[1] == 8 else corner
    quads = np.take_along_axis(sheet.quads, places, axis=1)
    return (
        Sheet(sheet.path, sheet.points, sheet.nodes, quads, sheet.numbers),
        ranked[:, -1] - ranked[:, -2],
    )


def _gradients(X: FloatArray, xi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gradients (e, g, 4, 2) [1/m] of the bilinear functions of X (e, 4, 2), and areas (e, g)."""
    _, dN = shape(QUAD4, xi)
    J = np.einsum("gak,eai->egki", dN, X)
    G = np.linalg.solve(J, np.broadcast_to(dN.transpose(0, 2, 1), (len(X), len(xi), 2, 4)))
    return G.transpose(0, 1, 3, 2), np.linalg.det(J)
