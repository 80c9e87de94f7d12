"""Bricks turned so that their natural axes follow the tyre.

The third axis goes along growing theta, the first through the wall from the inside out; the second
follows, from the rim at y < 0 to the rim at y > 0, as bricks stay right-handed. What a brick of an
isotropic material computes does not depend on it; a layer's axes do (`fem.orientation`).

The way through the wall is told from the inner surface: columns of bricks stand on it, and a brick
that no column reaches lies like the neighbour it was reached from.
"""

from __future__ import annotations

from collections import deque
from itertools import product

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.mesh.brick_faces import CORNERS, OPPOSITE, BrickFaces
from tyrefrf.mesh.shapes import HEX8, HEX20

NORMALS = np.array([HEX8[c].mean(axis=0) for c in CORNERS])
"""(6, 3) natural directions of the sides."""


def turned_bricks(
    bricks: IntArray, points: FloatArray, faces: BrickFaces, inner: IntArray, through: FloatArray
) -> IntArray:
    """The same bricks (e, 8) or (e, 20) with their natural axes along the tyre.

    points: (n, 3) x, y, z [m]. inner: numbers of the faces on the inner surface. through: (e, 2)
    direction (r, y) through the wall where it was given, else zero.
    """
    ways, e_r, e_theta = _ways(bricks, points)
    around = np.argmax(np.einsum("esi,ei->es", ways, e_theta), axis=1)
    given = through[:, :1] * e_r + through[:, 1:] * np.array([0.0, 1.0, 0.0])
    outwards = np.where(np.any(through != 0.0, axis=1), _most_along(ways, given, around), -1)
    outwards = _from_inside(bricks, faces, inner, around, outwards)
    outwards = np.where(outwards < 0, _most_along(ways, e_r, around), outwards)
    order = _ORDERS[outwards, around, : bricks.shape[1]]
    return np.take_along_axis(bricks, order, axis=1)


def off_circumference(bricks: IntArray, points: FloatArray) -> FloatArray:
    """The angle (e,) [rad] between the third axis at the middle of bricks and growing theta."""
    ways, _, e_theta = _ways(bricks, points)
    cosine = np.einsum("ei,ei->e", ways[:, 1] - ways[:, 0], e_theta) / 2.0
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _ways(bricks: IntArray, points: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unit vectors (e, 6, 3) from each brick's middle to its sides', and e_r, e_theta (e, 3)."""
    X = points[bricks[:, :8]]
    middle = X.mean(axis=1)
    ways = X[:, CORNERS].mean(axis=2) - middle[:, None]
    ways /= np.linalg.norm(ways, axis=2)[..., None]
    x, _, z = middle.T / np.hypot(middle[:, 0], middle[:, 2])
    o = np.zeros_like(x)
    return ways, np.stack([x, o, z], axis=1), np.stack([-z, o, x], axis=1)


def _most_along(ways: FloatArray, direction: FloatArray, around: IntArray) -> IntArray:
    """The side (e,) that lies most along a direction (e, 3), of those not across the third axis."""
    along = np.einsum("esi,ei->es", ways, direction)
    for sides in (around, OPPOSITE[around]):
        np.put_along_axis(along, sides[:, None], -np.inf, axis=1)
    return np.argmax(along, axis=1)


def _from_inside(
    bricks: IntArray, faces: BrickFaces, inner: IntArray, around: IntArray, given: IntArray
) -> IntArray:
    """The outer side (e,) of every brick that is connected to the inner surface, else -1.

    given: (e,) the outer side where it is known from elsewhere, else -1.
    """
    out = given.copy()
    columns: deque[int] = deque()
    for face in inner.tolist():
        columns.append(_look(out, around, face))
    reached: deque[int] = deque(np.flatnonzero(given >= 0).tolist())
    while columns:
        e = columns.popleft()
        if e < 0:
            continue
        reached.append(e)
        beyond = int(faces.twin[6 * e + out[e]])
        if beyond >= 0:
            columns.append(_look(out, around, beyond))
    while reached:
        e = reached.popleft()
        for side, face in enumerate(faces.twin[6 * e : 6 * e + 6].tolist()):
            if face >= 0 and out[face // 6] < 0:
                _lie_alike(bricks, out, around, (e, side), face)
                if out[face // 6] >= 0:
                    reached.append(face // 6)
    return out


def _look(out: IntArray, around: IntArray, face: int) -> int:
    """Stand a brick on a face of it: its number, -1 if it stood already or cannot."""
    e, side = divmod(face, 6)
    if out[e] >= 0 or side in (around[e], OPPOSITE[around[e]]):
        return -1
    out[e] = OPPOSITE[side]
    return e


def _lie_alike(
    bricks: IntArray, out: IntArray, around: IntArray, told: tuple[int, int], face: int
) -> None:
    """Turn the brick of a face outwards as its neighbour `told` (brick, side) across that face."""
    (e, side), (f, opposite) = told, divmod(face, 6)
    if side in (out[e], OPPOSITE[out[e]]):  # one stands upon the other
        found = opposite if side != out[e] else int(OPPOSITE[opposite])
    else:
        upper = np.intersect1d(bricks[e, CORNERS[out[e]]], bricks[e, CORNERS[side]])
        holds = np.isin(bricks[f], upper)[CORNERS].sum(axis=1) == 2
        holds[opposite] = False
        found = int(np.flatnonzero(holds)[0])
    if found not in (around[f], OPPOSITE[around[f]]):
        out[f] = found


def _orders() -> IntArray:
    """(6, 6, 20) the nodes of a brick whose first axis leads to a side and third to another.

    The first 8 of them are a permutation of a brick's 8 corners; -1 where the sides are opposite
    or the same.
    """
    orders = np.full((6, 6, 20), -1)
    for first, third in product(range(6), repeat=2):
        xi, zeta = NORMALS[first], NORMALS[third]
        if xi @ zeta == 0.0:
            axes = np.stack([xi, np.cross(zeta, xi), zeta])
            orders[first, third] = [
                int(np.flatnonzero(np.all(node @ axes == HEX20, axis=1))[0]) for node in HEX20
            ]
    return orders


_ORDERS = _orders()
