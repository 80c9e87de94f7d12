"""A section's quadrilaterals as a file gives them: counter-clockwise, whole, and in one piece."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.shapes import folded

FLAT = 1e-6  # of the largest coordinate: by how much a section may leave its plane
SAME_PLACE = 1e-3  # of the shortest edge: closer nodes are one node, not merged
NO_AREA = 1e-6  # of the square of an element's longest edge


@dataclass(frozen=True, slots=True, eq=False)
class Sheet:
    """Quadrilaterals in (r, y) that their file still knows by number.

    points: (n, 2) r and y [m]. nodes: (n,) numbers of the nodes in the file.
    quads: (e, 4) or (e, 8) places in `points`. numbers: (e,) of the elements in the file.
    """

    path: str
    points: FloatArray
    nodes: IntArray
    quads: IntArray
    numbers: IntArray

    @property
    def edges(self) -> IntArray:
        """(e, 4, 2) or (e, 4, 3) nodes of the edges: first, last, and mid-side."""
        q = self.quads
        ends = [q[:, :4], np.roll(q[:, :4], -1, axis=1)]
        return np.stack([*ends, q[:, 4:]] if q.shape[1] == 8 else ends, axis=2)

    def fault(self, message: str) -> MeshError:
        """An error that names the file."""
        return MeshError(f"{self.path}: {message}")


def in_half_plane(path: str, points: FloatArray, nodes: IntArray) -> FloatArray:
    """Radius and y (n, 2) of points (n, 3) in a half plane through the axle, the y axis.

    Raises MeshError, naming the node, where one is off the plane or not beside the axle.
    """
    across = points[:, [0, 2]]
    towards = across[np.argmax(np.abs(across).max(axis=1))]
    direction = towards / np.linalg.norm(towards)
    r = across @ direction
    off = np.abs(across @ [-direction[1], direction[0]])
    if off.max() > FLAT * np.abs(points).max():
        worst = int(np.argmax(off))
        raise MeshError(
            f"{path}: node {nodes[worst]} is {1e3 * off[worst]:.4g} mm off the section's plane; "
            "is it a cell of bricks (mesh.kind), or is mesh.axis another?"
        )
    if r.min() <= 0.0:
        worst = int(np.argmin(r))
        raise MeshError(
            f"{path}: node {nodes[worst]} is at r = {1e3 * r[worst]:.4g} mm; a section is on one "
            "side of the axle; is mesh.axis another?"
        )
    return np.stack([r, points[:, 1]], axis=1)


def counter_clockwise(sheet: Sheet) -> Sheet:
    """The same quadrilaterals, each counter-clockwise in (r, y).

    Raises MeshError, naming the element, where one is collapsed, has no area or folds over.
    """
    corners = np.sort(sheet.quads[:, :4], axis=1)
    collapsed = np.any(corners[:, 1:] == corners[:, :-1], axis=1)
    if collapsed.any():
        number = sheet.numbers[np.argmax(collapsed)]
        raise sheet.fault(f"element {number} is collapsed to a triangle: a corner is there twice")
    r, y = np.moveaxis(sheet.points[sheet.quads[:, :4]], 2, 0)
    area = 0.5 * np.sum(r * np.roll(y, -1, axis=1) - y * np.roll(r, -1, axis=1), axis=1)
    longest = np.hypot(r - np.roll(r, 1, axis=1), y - np.roll(y, 1, axis=1)).max(axis=1)
    thin = np.abs(area) <= NO_AREA * longest**2
    if thin.any():
        raise sheet.fault(f"element {sheet.numbers[np.argmax(thin)]} has no area")
    backwards = [0, 3, 2, 1, 7, 6, 5, 4][: sheet.quads.shape[1]]
    quads = np.where(area[:, None] > 0.0, sheet.quads, sheet.quads[:, backwards])
    turned = replace(sheet, quads=quads)
    inverted = folded(turned.points, turned.quads)
    if inverted.any():
        number = sheet.numbers[np.argmax(inverted)]
        raise sheet.fault(
            f"element {number} is inverted: it folds over itself (its nodes are not in order, a "
            "corner is above 180 degrees, or a mid-side is far off)"
        )
    return turned


def refuse_cracks(sheet: Sheet) -> None:
    """Raise MeshError where nodes are at one place, mid-sides do not agree, or parts are apart."""
    corners = sheet.edges[:, :, :2]
    lengths = np.linalg.norm(np.diff(sheet.points[corners], axis=2)[:, :, 0], axis=-1)
    pairs = cKDTree(sheet.points).query_pairs(SAME_PLACE * lengths.min(), output_type="ndarray")
    if len(pairs):
        a, b = sheet.nodes[pairs[0]]
        raise sheet.fault(
            f"nodes {a} and {b} are at the same place ({len(pairs)} such pair(s)): a crack; merge "
            "coincident nodes where the mesh is made"
        )
    n, flat = len(sheet.points), sheet.quads
    first = np.repeat(flat[:, 0], flat.shape[1])
    graph = coo_array((np.ones(flat.size), (first, flat.ravel())), shape=(n, n))
    n_parts, part = connected_components(graph, directed=False)
    if n_parts > 1:
        of = part[flat[:, 0]]
        other = sheet.numbers[np.argmax(of != of[0])]
        raise sheet.fault(
            f"the section is in {n_parts} parts: element {other} is not connected to element "
            f"{sheet.numbers[0]}"
        )


def boundary_loop(sheet: Sheet) -> IntArray:
    """Edges (k, 2) or (k, 3) of the boundary, one after the other, counter-clockwise.

    Raises MeshError for edges of three elements, elements that lie on one another, parts that
    touch in a corner only, and holes.
    """
    edges = sheet.edges.reshape(-1, sheet.edges.shape[2])
    element = np.repeat(sheet.numbers, 4)
    _, which, count = np.unique(
        np.sort(edges[:, :2], axis=1), axis=0, return_inverse=True, return_counts=True
    )
    order = np.argsort(which, kind="stable")
    start = np.cumsum(count) - count
    _refuse_overlaps(sheet, edges, element, order, start, count)

    free = edges[order[start[count == 1]]]
    if len(np.unique(free[:, 0])) < len(free):
        values, n = np.unique(free[:, 0], return_counts=True)
        node = sheet.nodes[values[np.argmax(n)]]
        raise sheet.fault(f"parts of the section touch in a corner only, at node {node}")
    after = {int(edge[0]): i for i, edge in enumerate(free)}
    loop = [0]
    while free[loop[-1], 1] != free[0, 0]:
        loop.append(after[int(free[loop[-1], 1])])
    if len(loop) < len(free):
        rest = np.setdiff1d(np.arange(len(free)), loop)
        inside = min(loop, rest.tolist(), key=lambda part: np.ptp(sheet.points[free[part, 0], 1]))
        node = sheet.nodes[free[inside[0], 0]]
        raise sheet.fault(f"the section has a hole, at node {node}; fill it, or merge its nodes")
    return np.asarray(free[loop])


def _refuse_overlaps(
    sheet: Sheet,
    edges: IntArray,
    element: IntArray,
    order: IntArray,
    start: IntArray,
    count: IntArray,
) -> None:
    """Raise MeshError for edges that are not between two neighbours."""

    def words(edge: IntArray) -> str:
        return f"the edge from node {sheet.nodes[edge[0]]} to {sheet.nodes[edge[1]]}"

    if np.any(count > 2):
        edge = edges[order[start[np.argmax(count > 2)]]]
        raise sheet.fault(f"{words(edge)} belongs to more than two elements")
    a, b = order[start[count == 2]], order[start[count == 2] + 1]
    same = edges[a, 0] == edges[b, 0]
    if same.any():
        i = int(np.argmax(same))
        raise sheet.fault(f"elements {element[a[i]]} and {element[b[i]]} lie on one another")
    if edges.shape[1] == 3 and np.any(edges[a, 2] != edges[b, 2]):
        i = int(np.argmax(edges[a, 2] != edges[b, 2]))
        mids = f"{sheet.nodes[edges[a[i], 2]]} and {sheet.nodes[edges[b[i], 2]]}"
        raise sheet.fault(f"{words(edges[a[i]])} has two mid-sides, {mids}")
