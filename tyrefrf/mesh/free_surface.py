"""The free surface of a periodic cell: which part is the tyre's outside, and which its cavity's.

The rim divides it: two faces are connected where they share an edge that is not all on the rim,
also over the cut to the next cell. The part that reaches farthest from the axle is the outside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tyrefrf.arrays import BoolArray, FloatArray, IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.brick_faces import BrickFaces, face_edges
from tyrefrf.mesh.bricks import SHOWN, listed
from tyrefrf.mesh.cut import Cut, Side
from tyrefrf.mesh.outside import OutsideMesh


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Faces by element: (k, 2) number of the element and of its face, from 1; 0 for all free ones.

    name: in the file, for messages.
    """

    faces: IntArray
    name: str


@dataclass(frozen=True, slots=True, eq=False)
class FreeSurface:
    """Numbers of the brick faces on the outside of the tyre, and of those on its inner surface."""

    outer: IntArray
    inner: IntArray


def free_surface(
    mesh: OutsideMesh,
    faces: BrickFaces,
    elements: IntArray,
    cut: Cut,
    on_rim: BoolArray,
    inner: Side | Surface | None,
) -> FreeSurface:
    """The outer and the inner surface of a cell.

    elements: (e,) numbers of the bricks. on_rim: (n,) of the points. inner: the inner surface, or
    nodes that hold it; found where None. Raises MeshError where it cannot be told.
    """
    rest = faces.free.copy()
    rest[cut.left_faces] = rest[cut.right_faces] = False
    named = None
    if isinstance(inner, Surface):
        named = _of_elements(mesh, elements, rest, inner)
    elif inner is not None:
        named = _of_nodes(faces, rest, inner)
    rest &= ~np.all(on_rim[faces.corners], axis=1)
    if named is not None:
        named = named[rest[named]]  # free ones; pressure on what the rim holds moves nothing
        rest[named] = False
    parts = _parts(np.flatnonzero(rest), faces, cut, on_rim)
    radius = np.hypot(mesh.points[:, 0], mesh.points[:, 2])
    parts.sort(key=lambda part: -float(radius[faces.corners[part]].max()))
    if named is None:
        if len(parts) != 2:
            raise MeshError(f"{mesh.path}: {_unclear(parts, elements)}")
        named = parts[1]
    if not len(named):
        raise MeshError(f"{mesh.path}: mesh.inner holds no free face of a brick off the rim")
    surface = FreeSurface(outer=parts[0] if parts else np.flatnonzero(rest), inner=named)
    _ends_on_rim(mesh, faces, cut, on_rim, named)
    _blows_up(mesh, faces, surface)
    return surface


def _of_nodes(faces: BrickFaces, rest: BoolArray, side: Side) -> IntArray:
    """The free faces all of whose corners are among some nodes."""
    chosen = np.zeros(max(faces.nodes.max(), side.nodes.max()) + 1, dtype=bool)
    chosen[side.nodes] = True
    return np.flatnonzero(rest & np.all(chosen[faces.corners], axis=1))


def _of_elements(
    mesh: OutsideMesh, elements: IntArray, rest: BoolArray, surface: Surface
) -> IntArray:
    """The faces that a surface names; where it names none of an element, all six of it."""
    number, side = surface.faces.T
    order = np.argsort(elements)
    place = np.minimum(np.searchsorted(elements, number, sorter=order), len(elements) - 1)
    brick = order[place]
    strangers = number[elements[brick] != number]
    if len(strangers):
        raise MeshError(
            f"{mesh.path}: surface {surface.name!r} has element {listed(strangers)}, which is none "
            "of the bricks"
        )
    all_sides = (6 * brick[side == 0][:, None] + np.arange(6)).ravel()
    found = 6 * brick[side > 0] + side[side > 0] - 1
    if not np.all(rest[found]):
        wrong = [f"S{s} of element {e}" for e, s in surface.faces[side > 0][~rest[found]][:SHOWN]]
        raise MeshError(
            f"{mesh.path}: surface {surface.name!r} has faces that are not free, but between "
            f"elements or between cells: {', '.join(wrong)}"
        )
    return np.unique(np.concatenate([found, all_sides]))


def _parts(chosen: IntArray, faces: BrickFaces, cut: Cut, on_rim: BoolArray) -> list[IntArray]:
    """The connected parts of some faces, each by its faces' numbers."""
    edges = np.sort(cut.on_left(face_edges(faces.corners[chosen]).reshape(-1, 2)), axis=1)
    face = np.repeat(np.arange(len(chosen)), 4)
    joined = ~np.all(on_rim[edges], axis=1)
    _, edge = np.unique(edges, axis=0, return_inverse=True)
    n = len(chosen)
    at = face[joined], n + edge.ravel()[joined]
    size = n + len(edges)
    graph = coo_array((np.ones(len(at[0])), at), shape=(size, size))
    label = connected_components(graph, directed=False)[1][:n]
    return [chosen[label == k] for k in np.unique(label)]


def _unclear(parts: list[IntArray], elements: IntArray) -> str:
    """Why the inner surface cannot be found, and what to do."""
    if len(parts) < 2:
        return (
            "the inner surface is not divided from the outer one by the rim: the nodes of "
            "mesh.rim must close off both beads; or name the inner surface as mesh.inner"
        )
    where = [f"{len(part)} faces about element {elements[part[0] // 6]}" for part in parts[:5]]
    return (
        f"the free surface is in {len(parts)} parts ({', '.join(where)}), where an outer and an "
        "inner one were sought; complete the nodes of mesh.rim, or name the inner surface as "
        "mesh.inner"
    )


def _ends_on_rim(
    mesh: OutsideMesh, faces: BrickFaces, cut: Cut, on_rim: BoolArray, inner: IntArray
) -> None:
    """Check that the inner surface ends on the rim: the pressure's stiffness is right only then."""
    edges = face_edges(faces.nodes[inner])
    edges = edges.reshape(-1, edges.shape[2])
    keys = np.sort(cut.on_left(edges[:, :2]), axis=1)
    _, first, count = np.unique(keys, axis=0, return_index=True, return_counts=True)
    ends = edges[first[count == 1]]
    loose = ends[~np.all(on_rim[ends], axis=1)]
    if len(loose):
        a, b = mesh.numbers[loose[0, :2]]
        raise MeshError(
            f"{mesh.path}: the inner surface does not reach from rim to rim: it ends between nodes "
            f"{a} and {b} ({len(loose)} such edges), which are not all in the rim's set; extend "
            "mesh.inner, or the rim's set (with mid-sides)"
        )


def _blows_up(mesh: OutsideMesh, faces: BrickFaces, surface: FreeSurface) -> None:
    """Check that pressure on the inner surface pushes the tyre away from the axle."""
    x = mesh.points[faces.corners[surface.inner]]
    area = -np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]) / 2.0
    if np.sum(_radial(x.mean(axis=1)) * area) <= 0.0:
        raise MeshError(
            f"{mesh.path}: pressure on the inner surface ({len(surface.inner)} faces) would pull "
            "the tyre towards the axle: it is the outside; name the inner one as mesh.inner"
        )


def _radial(points: FloatArray) -> FloatArray:
    """e_r (n, 3) at points (n, 3)."""
    e_r = points * [1.0, 0.0, 1.0]
    return np.asarray(e_r / np.linalg.norm(e_r, axis=1)[:, None])


def profile_edges(edges: IntArray, chosen: BoolArray, y: FloatArray) -> IntArray:
    """The chosen ones of edges (k, 2) or (k, 3), one behind another from y < 0 to y > 0.

    y: (n,) [m]. Of several lines the longest is taken; a closed one begins anywhere.
    """
    lines = _lines(edges[chosen])
    line = max(lines, key=len, default=edges[:0])
    if len(line) and y[line[0, 0]] > y[line[-1, 1]]:
        line = line[::-1].copy()
        line[:, [0, 1]] = line[:, [1, 0]]
    return line


def _lines(edges: IntArray) -> list[IntArray]:
    """Edges that share ends, strung together."""
    left = {k: edge for k, edge in enumerate(edges.tolist())}
    at: dict[int, list[int]] = {}
    for k, (a, b, *_) in left.items():
        at.setdefault(a, []).append(k)
        at.setdefault(b, []).append(k)
    lines = []
    starts = [node for node, there in at.items() if len(there) == 1] + list(at)
    for node in starts:
        line: list[list[int]] = []
        while there := [k for k in at[node] if k in left]:
            a, b, *middle = left.pop(there[0])
            line.append([a, b, *middle] if a == node else [b, a, *middle])
            node = line[-1][1]
        if line:
            lines.append(np.array(line))
    return lines
