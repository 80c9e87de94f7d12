"""The axes of a layer in every brick, from the brick's own shape.

Bricks stand in the tyre with xi through the thickness, from the inside out, eta along the profile,
from the rim at y < 0 to the rim at y > 0, and zeta around (`mesh.profile`, `mesh.cell`). At every
Gauss point axis 1 is the direction of zeta, axis 3 the outward normal of the surface that eta and
zeta span, and axis 2 lies in that surface across axis 1, on the side of eta. (1, 2, 3) is
left-handed; nothing depends on it, as a layer is its own mirror image about its own plane.
"""

from __future__ import annotations

import numpy as np

from tyrefrf.arrays import FloatArray
from tyrefrf.fem.constitutive import Constitutive
from tyrefrf.fem.elasticity import rotated
from tyrefrf.fem.elements import Element


def layer_axes(tangents: FloatArray) -> FloatArray:
    """Axes 1, 2, 3 as rows (e, g, 3, 3) in x, y, z; tangents: rows dx/dxi, dx/deta, dx/dzeta."""
    _, along, around = np.moveaxis(tangents, -2, 0)
    one = around / np.linalg.norm(around, axis=-1)[..., None]
    normal = np.cross(along, around)
    three = normal / np.linalg.norm(normal, axis=-1)[..., None]
    return np.stack([one, np.cross(one, three), three], axis=-2)


def in_bricks(stuff: Constitutive, C: FloatArray, element: Element, X: FloatArray) -> FloatArray:
    """A material's elasticity C (6, 6) in x, y, z: (6, 6) if isotropic, else (e, g, 6, 6).

    X: (e, a, 3) the bricks' nodes [m]; g: the Gauss points of the element's stiffness.
    """
    if stuff.is_isotropic:
        return C
    return rotated(C, layer_axes(element.tangents(X)))
