"""A periodic cell from another program's mesh of one sector: blocks, grooves and all.

The cell keeps the file's own angle: theta is counted from x towards z, in the frame with the axle
along y that `OutsideMesh` has, which for a right-handed frame is against the right hand's sense
about +y. The left section is the one from which theta grows into the cell, whatever its name.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tyrefrf.arrays import BoolArray, FloatArray, IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.brick_faces import CORNERS, BrickFaces, face_edges, inwards
from tyrefrf.mesh.bricks import Bricks, check_bricks, listed
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.mesh.cut import Cut, Cutter, Side
from tyrefrf.mesh.free_surface import FreeSurface, Surface, free_surface, profile_edges
from tyrefrf.mesh.outside import OutsideMesh
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.mesh.turning import off_circumference, turned_bricks

EDGE_ON = 1e-3  # sine at which a left face is taken to be seen from its edge
ASKEW = 5.0  # [deg] that a layer's first axis may be off the circumference
"""Cords are laid at their angle from it: `fem.orientation` takes the bricks' own."""


@dataclass(frozen=True, slots=True, eq=False)
class CellSets:
    """What of a mesh is what in the cell.

    rim: nodes that the rim holds. inner: the surface under the pressure, or nodes that hold it.
    left, right: nodes of the two sections; these three are found where None.
    through: (e, 2) direction (r, y) through the layers of every brick, zero where it is to be
    found; None for all. oriented: materials whose axes must lie along the tyre.
    """

    rim: Side
    inner: Side | Surface | None = None
    left: Side | None = None
    right: Side | None = None
    through: FloatArray | None = None
    oriented: Collection[str] = ()


def periodic_cell(
    mesh: OutsideMesh,
    bricks: Bricks,
    sets: CellSets,
    sector_angle: float,
    tolerance: float | None = None,
) -> CellMesh:
    """The cell of `sector_angle` [rad] that bricks of a mesh are.

    tolerance: how far a node of the right section may be from its partner's place [m]; by default
    a thousandth of the shortest edge. Right nodes are put exactly there. Nodes without a brick are
    left out. Raises MeshError, naming nodes or elements, where the bricks are no such cell.
    """
    if sector_angle > np.pi * (1.0 + 1e-9):
        raise MeshError(f"{mesh.path}: a cell cannot be the whole tyre; give a sector of it")
    check_bricks(mesh, bricks)
    faces = BrickFaces.of(bricks.nodes, bricks.numbers, mesh.path)
    left, right = (_of_bricks(mesh, bricks, side) for side in (sets.left, sets.right))
    cutter = Cutter(mesh.points, mesh.numbers, bricks.numbers, faces, mesh.path)
    cut = cutter.cut(sector_angle, left, right, tolerance)
    _in_one_piece(mesh, bricks, cut)
    on_rim = _rim(mesh, bricks, cut, sets.rim)
    surface = free_surface(mesh, faces, bricks.numbers, cut, on_rim, sets.inner)
    through = np.zeros((len(bricks.numbers), 2)) if sets.through is None else sets.through
    turned = turned_bricks(bricks.nodes, mesh.points, faces, surface.inner, through)
    _laid_around(mesh, bricks, turned, sets.oriented)
    parts = _Parts(faces, cut, surface, on_rim)
    return _numbered(mesh, replace(bricks, nodes=turned), parts, sector_angle)


@dataclass(frozen=True, slots=True, eq=False)
class _Parts:
    """What is what in the cell: faces of its bricks, sections, free surfaces, nodes on the rim."""

    faces: BrickFaces
    cut: Cut
    surface: FreeSurface
    on_rim: BoolArray


def _of_bricks(mesh: OutsideMesh, bricks: Bricks, side: Side | None) -> Side | None:
    """The nodes of a set that a brick has."""
    if side is None:
        return None
    nodes = np.intersect1d(side.nodes, bricks.used)
    if not len(nodes):
        raise MeshError(f"{mesh.path}: no node of the set {side.name!r} belongs to a brick")
    return Side(nodes, side.name)


def _rim(mesh: OutsideMesh, bricks: Bricks, cut: Cut, side: Side) -> BoolArray:
    """Whether a node (n,) is on the rim; the same on both sections."""
    on_rim = np.zeros(len(mesh.points), dtype=bool)
    on_rim[np.intersect1d(side.nodes, bricks.used)] = True
    if not np.any(on_rim):
        raise MeshError(f"{mesh.path}: no node of the rim's set {side.name!r} belongs to a brick")
    odd = np.flatnonzero(on_rim[cut.left] != on_rim[cut.right])
    if len(odd):
        a, b = cut.left[odd[0]], cut.right[odd[0]]
        a, b = (a, b) if on_rim[a] else (b, a)
        raise MeshError(
            f"{mesh.path}: node {mesh.numbers[a]} of one face is in the rim's set {side.name!r}, "
            f"its partner {mesh.numbers[b]} on the other is not ({len(odd)} such pairs)"
        )
    return on_rim


def _in_one_piece(mesh: OutsideMesh, bricks: Bricks, cut: Cut) -> None:
    """Check that all bricks hang together, over the cut where they must."""
    own = np.arange(len(mesh.points))
    own[cut.right] = cut.left
    first = np.repeat(own[bricks.nodes[:, 0]], bricks.nodes.shape[1])
    at = first, own[bricks.nodes.ravel()]
    graph = coo_array((np.ones(len(first)), at), shape=(len(own), len(own)))
    label = connected_components(graph, directed=False)[1][own[bricks.nodes[:, 0]]]
    parts, count = np.unique(label, return_counts=True)
    if len(parts) > 1:
        small = bricks.numbers[label == parts[np.argmin(count)]]
        raise MeshError(
            f"{mesh.path}: the bricks are in {len(parts)} parts that share no node; the smallest "
            f"has elements {listed(small)}; join it, or leave it out"
        )


def _laid_around(
    mesh: OutsideMesh, bricks: Bricks, turned: IntArray, oriented: Collection[str]
) -> None:
    """Check that the third axis of bricks of these materials goes around the tyre."""
    index = [k for k, name in enumerate(bricks.materials) if name in oriented]
    laid = np.flatnonzero(np.isin(bricks.material, index))
    askew = np.rad2deg(off_circumference(turned[laid], mesh.points))
    if np.any(askew > ASKEW):
        worst = int(np.argmax(askew))
        name = bricks.materials[bricks.material[laid[worst]]]
        raise MeshError(
            f"{mesh.path}: element {bricks.numbers[laid[worst]]} of {name!r}, whose axes follow "
            f"the mesh, has no edges around the tyre: {askew[worst]:.3g} deg off; mesh it with "
            f"bricks along the circumference (within {ASKEW:g} deg; {np.sum(askew > ASKEW)} are "
            "farther off)"
        )


def _numbered(mesh: OutsideMesh, bricks: Bricks, parts: _Parts, sector_angle: float) -> CellMesh:
    """The cell, its nodes in the ring's order, and first the bricks behind the left section.

    bricks: turned along the tyre.
    """
    faces, cut, on_rim, turned = parts.faces, parts.cut, parts.on_rim, bricks.nodes
    inner_nodes = np.setdiff1d(bricks.used, np.concatenate([cut.left, cut.right]))
    nodes = np.concatenate([cut.left, inner_nodes, cut.right])
    place = np.full(len(mesh.points), -1)
    place[nodes] = np.arange(len(nodes))
    n_face = len(cut.left)

    points = _cylindrical(mesh.points[nodes], mesh.points[cut.left], sector_angle)
    points[-n_face:] = points[:n_face] + np.array([0.0, 0.0, sector_angle])
    left_faces = cut.left_faces[_seen(mesh.points, faces, cut.left_faces)]
    left_faces = left_faces[np.argsort(left_faces // 6, kind="stable")]
    behind = np.unique(left_faces // 6)
    order = np.concatenate([behind, np.setdiff1d(np.arange(len(turned)), behind)])
    quads = _as_quads(inwards(faces.nodes[left_faces]), turned[left_faces // 6])
    edges, on_outer, on_inner = _boundary(faces, cut, parts.surface)
    y = mesh.points[:, 1]
    section = SectionMesh(
        points=points[:n_face, :2].copy(),
        quads=place[quads],
        material=bricks.material[left_faces // 6],
        materials=bricks.materials,
        rim=np.flatnonzero(on_rim[cut.left]),
        outer=place[profile_edges(edges, on_outer, y)],
        inner=place[profile_edges(edges, on_inner, y)],
    )
    return CellMesh(
        points=points,
        bricks=place[turned[order]],
        material=bricks.material[order],
        materials=bricks.materials,
        planes=np.stack([np.arange(n_face), np.arange(len(nodes) - n_face, len(nodes))]),
        rim=np.flatnonzero(on_rim[nodes]),
        inside=place[inwards(faces.nodes[parts.surface.inner])],
        section=section,
        sector_angle=sector_angle,
        numbers=mesh.numbers[nodes],
    )


def _cylindrical(points: FloatArray, left: FloatArray, sector_angle: float) -> FloatArray:
    """r, y, theta (n, 3) of x, y, z; theta within half a turn of the middle of the cell."""
    x, y, z = points.T
    begin = left.mean(axis=0)
    middle = np.arctan2(begin[2], begin[0]) + sector_angle / 2.0
    c, s = np.cos(middle), np.sin(middle)
    theta = middle + np.arctan2(z * c - x * s, x * c + z * s)
    return np.stack([np.hypot(x, z), y, theta], axis=1)


def _seen(points: FloatArray, faces: BrickFaces, left_faces: IntArray) -> BoolArray:
    """Whether left faces (f,) show in (r, y): not those along the ring, at a step of the cut."""
    x = points[faces.corners[left_faces]]
    r, y = np.hypot(x[..., 0], x[..., 2]), x[..., 1]
    a, b = (np.stack([r[:, k + 2] - r[:, k], y[:, k + 2] - y[:, k]], axis=1) for k in (0, 1))
    shown = -(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])  # their normals point against theta
    whole = np.linalg.norm(np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]), axis=1)
    return np.asarray(shown > EDGE_ON * whole)


def _as_quads(faces: IntArray, bricks: IntArray) -> IntArray:
    """Left faces (f, 4) or (f, 8), counter-clockwise in (r, y), as a section wants them.

    Corners 0 and 1 lie along the thickness: corners 0 and 3 are the face's on the brick's inner
    side. bricks: (f, 8) or (f, 20) those of the faces, turned along the tyre.
    """
    inside = np.stack([bricks[:, a] for a in CORNERS[5]], axis=1)
    low = np.any(faces[:, :4, None] == inside[:, None], axis=2)
    begin = np.argmax(low & np.roll(low, 1, axis=1), axis=1)  # of two low ones, the second
    k = (np.arange(4) + begin[:, None]) % 4
    k = k if faces.shape[1] == 4 else np.hstack([k, 4 + k])
    return np.take_along_axis(faces, k, axis=1)


def _boundary(
    faces: BrickFaces, cut: Cut, surface: FreeSurface
) -> tuple[IntArray, BoolArray, BoolArray]:
    """Edges of the left section that one left face has, and which are outer and inner ones."""
    edges = face_edges(faces.nodes[cut.left_faces])
    edges = edges.reshape(-1, edges.shape[2])
    keys = np.sort(edges[:, :2], axis=1)
    _, first, count = np.unique(keys, axis=0, return_index=True, return_counts=True)
    single = first[count == 1]
    edges, keys = edges[single], keys[single]

    def on(chosen: IntArray) -> BoolArray:
        there = np.sort(cut.on_left(face_edges(faces.corners[chosen]).reshape(-1, 2)), axis=1)
        n = int(faces.nodes.max()) + 1
        return np.isin(keys[:, 0] * n + keys[:, 1], there[:, 0] * n + there[:, 1])

    inner = on(surface.inner)
    return edges, on(surface.outer) & ~inner, inner
