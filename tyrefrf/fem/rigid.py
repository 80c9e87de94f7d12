"""Rigid motions of a cell in its own dofs."""

from __future__ import annotations

import numpy as np

from tyrefrf.arrays import BoolArray, FloatArray
from tyrefrf.fem.frames import axes

NAMES = tuple(
    f"{kind} {axis}" for kind in ("translation along", "rotation about") for axis in "xyz"
)
"""Of the six, in their order; x is at angle 0 and y the axle."""


def rigid_motions(points: FloatArray, of_no_node: BoolArray) -> FloatArray:
    """(n, 6) unit translations along x, y and z, and rotations about them [m/rad], in the dofs.

    points: (n / 3, 3) r, y, theta of the nodes. of_no_node: (n / 3,) threes of unknowns without a
    node, which do not move.
    """
    r, y, theta = points.T
    R = axes(theta)  # (nodes, local, Cartesian)
    x = r[:, None] * R[:, 0] + y[:, None] * R[:, 1]
    spins = np.stack([np.cross(spin, x) for spin in np.eye(3)], axis=2)
    still = np.tile(np.eye(3), (len(r), 1, 1))
    motions = R @ np.concatenate([still, spins], axis=2)
    motions[of_no_node] = 0.0
    return motions.reshape(-1, 6)
