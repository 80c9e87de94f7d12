"""The faces of bricks: which of them two bricks share, and which are free.

A brick's six sides are numbered from 0 in the order of Abaqus' S1 to S6: zeta = -1, zeta = +1,
eta = -1, xi = +1, eta = +1, xi = -1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tyrefrf.arrays import BoolArray, IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.shapes import HEX20

CORNERS = np.array(
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [3, 7, 6, 2], [0, 4, 7, 3]]
)
"""(6, 4) corners of the sides, so ordered that the normal points out of the brick."""
OPPOSITE = np.array([1, 0, 4, 5, 2, 3])
"""(6,) the side across."""


def _between(a: int, b: int) -> int:
    """The mid-side between two corners of a brick."""
    return int(np.flatnonzero(np.all((HEX20[a] + HEX20[b]) / 2.0 == HEX20, axis=1))[0])


MID_SIDES = np.array(
    [[_between(a, b) for a, b in zip(s, np.roll(s, -1), strict=True)] for s in CORNERS]
)
"""(6, 4) mid-sides of the sides, the first between corners 0 and 1: the order of QUAD8."""


@dataclass(frozen=True, slots=True, eq=False)
class BrickFaces:
    """Every side of every brick, (6 e,) in all: side s of brick e has the number 6 e + s.

    nodes: (6 e, 4) or (6 e, 8) in the order of QUAD4 or QUAD8, the normal out of the brick.
    twin: (6 e,) number of the same face in the brick beyond it, -1 where it is free.
    """

    nodes: IntArray
    twin: IntArray

    @classmethod
    def of(cls, bricks: IntArray, numbers: IntArray, path: str) -> BrickFaces:
        """The faces of bricks (e, 8) or (e, 20); numbers (e,) and the file's path for messages.

        Raises MeshError where three bricks share a face.
        """
        of_side = CORNERS if bricks.shape[1] == 8 else np.hstack([CORNERS, MID_SIDES])
        nodes = bricks[:, of_side].reshape(6 * len(bricks), -1)
        _, face, count = np.unique(
            np.sort(nodes[:, :4], axis=1), axis=0, return_inverse=True, return_counts=True
        )
        face = face.ravel()
        if np.any(count > 2):
            crowd = numbers[np.flatnonzero(face == np.argmax(count > 2)) // 6]
            raise MeshError(f"{path}: elements {', '.join(map(str, crowd))} all share one face")
        order = np.argsort(face, kind="stable")
        first = order[:-1][face[order][:-1] == face[order][1:]]
        second = order[1:][face[order][:-1] == face[order][1:]]
        twin = np.full(len(nodes), -1)
        twin[first], twin[second] = second, first
        return cls(nodes, twin)

    @property
    def free(self) -> BoolArray:
        """(6 e,) whether no other brick has the face."""
        return self.twin < 0

    @property
    def corners(self) -> IntArray:
        """(6 e, 4) corners of the faces."""
        return self.nodes[:, :4]


def face_edges(nodes: IntArray) -> IntArray:
    """Edges (f, 4, 2) or (f, 4, 3) of faces (f, 4) or (f, 8): first, last, and the mid-side."""
    corners = nodes[:, :4]
    ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2)
    return ends if nodes.shape[1] == 4 else np.concatenate([ends, nodes[:, 4:, None]], axis=2)


def inwards(nodes: IntArray) -> IntArray:
    """The same faces with their normal into the brick."""
    return nodes[:, [0, 3, 2, 1] if nodes.shape[1] == 4 else [0, 3, 2, 1, 7, 6, 5, 4]]
