"""The two faces of a periodic cell: matched node to node by a rotation about the axle."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import degrees

import numpy as np
from scipy.spatial import KDTree

from tyrefrf.arrays import BoolArray, FloatArray, IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.brick_faces import BrickFaces, face_edges
from tyrefrf.mesh.bricks import SHOWN, listed

STRICT = 1e-3
"""Default tolerance, of the shortest edge of a free face: files of seven digits stay below a tenth
of it, and no brick is distorted by it."""
LOOSE = 0.2  # of the shortest edge: what may be meant to match, for advice
CLOSE = 0.02  # of the shortest edge: what matches at the right angle, and by no accident
FACING = 0.05  # of a face's size: free faces that meet so closely were meant to match
MOST_CELLS = 500  # in a turn, tried to find the angle of a cell
SAMPLED = 300  # free faces that the angle is looked for with


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """Where a cell is cut from the tyre.

    left, right: (n,) nodes of both sections, a node and its partner at the same place; the right
    section is the left one turned towards growing theta. left_faces, right_faces: (f,) numbers of
    the brick faces between them and their neighbours, likewise.
    """

    left: IntArray
    right: IntArray
    left_faces: IntArray
    right_faces: IntArray

    def on_left(self, edges: IntArray) -> IntArray:
        """Edges (k, 2) or (k, 3) with those on the right section taken over to the left one.

        An edge that only ends there stays: it is another than the one that begins on the left.
        """
        partner = np.arange(max(int(edges.max(initial=0)), int(self.right.max())) + 1)
        partner[self.right] = self.left
        whole = np.all(np.isin(edges, self.right), axis=1)
        return np.where(whole[:, None], partner[edges], edges)


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """Nodes (n,) that a section is sought among, and the name of their set; "" for all free."""

    nodes: IntArray
    name: str


class Cutter:
    """Finds the two sections of a cell.

    points: (n, 3) x, y, z [m] with the axle along y. numbers: (n,) of the nodes, and elements:
    (e,) of the bricks, for messages. path: of the file.
    """

    def __init__(
        self,
        points: FloatArray,
        numbers: IntArray,
        elements: IntArray,
        faces: BrickFaces,
        path: str,
    ) -> None:
        self.points, self.numbers, self.elements = points, numbers, elements
        self.faces, self.path = faces, path
        self._free = np.flatnonzero(faces.free)
        self._by_corners = {
            tuple(corners): face
            for corners, face in zip(
                np.sort(faces.corners[self._free], axis=1).tolist(), self._free, strict=True
            )
        }
        ends = face_edges(faces.corners[self._free]).reshape(-1, 2)
        edges = points[ends[:, 1]] - points[ends[:, 0]]
        self.shortest = float(np.linalg.norm(edges, axis=1).min())

    def cut(
        self,
        sector_angle: float,
        left: Side | None = None,
        right: Side | None = None,
        tolerance: float | None = None,
    ) -> Cut:
        """The sections of a cell of `sector_angle` [rad].

        left, right: found where not given. Which of the two leads towards growing theta is found
        from the mesh: their names decide nothing. tolerance: [m] between a node and its partner.
        Raises MeshError, naming nodes, where the sections do not match.
        """
        allowed = STRICT * self.shortest if tolerance is None else tolerance
        anywhere = Side(np.unique(self.faces.nodes[self._free]), "")
        sides = left or anywhere, right or anywhere
        orders = [sides, sides[::-1]] if left or right else [sides]
        tries = [self._match(a, b, sector_angle, allowed) for a, b in orders]
        best = min(tries, key=lambda match: (match.n_lacking, match.distance))
        if best.n_lacking or not len(best.cut.left):
            raise MeshError(f"{self.path}: {self._why(best, sector_angle, allowed)}")
        both = np.intersect1d(best.cut.left, best.cut.right)
        if len(both):
            raise MeshError(
                f"{self.path}: nodes {listed(self.numbers[both])} are on both faces: the cut steps "
                "by a whole cell; make one mesh of two cells, of twice the sector_angle"
            )
        self._no_others(best.cut, sector_angle)
        return best.cut

    def _match(self, a: Side, b: Side, angle: float, tolerance: float) -> _Match:
        """Side a turned by an angle [rad] onto side b."""
        distance, nearest = _nearest(turned(self.points[a.nodes], angle), self.points[b.nodes])
        partner = np.full(len(self.points), -1)
        close = distance <= tolerance
        partner[a.nodes[close]] = b.nodes[nearest[close]]
        left_faces, right_faces = self._faces_between(partner, angle)
        left = np.unique(self.faces.nodes[left_faces])
        cut = Cut(left, partner[left], left_faces, right_faces)
        return _Match(a, b, cut, float(distance.sum()))

    def _faces_between(self, partner: IntArray, angle: float) -> tuple[IntArray, IntArray]:
        """Free faces whose nodes all have partners (n,), -1 for none, and the faces of these.

        Turned by the angle, the two look at each other: the surface of a tyre that is meshed
        evenly around matches itself too, but looks away.
        """
        whole = np.all(partner[self.faces.nodes[self._free]] >= 0, axis=1)
        onto = np.sort(partner[self.faces.corners[self._free[whole]]], axis=1)
        pairs = [
            (face, self._by_corners[tuple(corners)])
            for face, corners in zip(self._free[whole], onto.tolist(), strict=True)
            if tuple(corners) in self._by_corners
        ]
        left, right = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
        normals = turned(self._normals(left), angle), self._normals(right)
        facing = np.einsum("fi,fi->f", *normals) < 0.0
        return left[facing], right[facing]

    def _normals(self, faces: IntArray) -> FloatArray:
        """Area vectors (f, 3) [m2] of faces, out of the brick."""
        corners = self.points[self.faces.corners[faces]]
        return np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2.0

    def _why(self, match: _Match, sector_angle: float, tolerance: float) -> str:
        """What is wrong with the best match, and what would mend it."""
        found = self._angle(match, sector_angle, tolerance)
        if found is not None:
            n = max(1, round(2.0 * np.pi / found))
            return (
                f"the cell's faces are {degrees(found):.8g} deg apart, but cell.sector_angle is "
                f"{degrees(sector_angle):.8g} deg; {n} cells would have {360.0 / n:.10g} deg each"
            )
        if match.n_lacking:
            return self._unmatched(match, sector_angle, tolerance)
        loose = self._match(match.a, match.b, sector_angle, LOOSE * self.shortest)
        advice = "check mesh.axis and cell.sector_angle, or name the faces as mesh.left, mesh.right"
        if len(loose.cut.left):
            a, b = self.points[loose.cut.left], self.points[loose.cut.right]
            off = float(np.linalg.norm(turned(a, sector_angle) - b, axis=1).max())
            advice = (
                f'{len(a)} nodes match to {off:.2g} m: mesh.tolerance = "{1.01e3 * off:.3g} mm"'
            )
        return (
            f"no faces match by a rotation of {degrees(sector_angle):.8g} deg about the axle, "
            f"within {tolerance:.2g} m; {advice}"
        )

    def _angle(self, match: _Match, sector_angle: float, tolerance: float) -> float | None:
        """The angle [rad] between the faces where another than declared makes them match."""
        a, b, loose = match.a, match.b, LOOSE * self.shortest
        if not (a.name and b.name):
            return self._angle_of_free_faces(sector_angle)
        if len(a.nodes) != len(b.nodes):
            return None
        (x, _, z), (u, _, v) = (self.points[side.nodes].mean(axis=0) for side in (a, b))
        found = float(np.arctan2(x * v - z * u, x * u + z * v))
        if found < 0.0:
            a, b, found = b, a, -found
        surely = self._match(a, b, found, tolerance).n_lacking == 0
        likely = self._match(a, b, found, loose).n_lacking == 0
        declared = self._match(a, b, sector_angle, loose).n_lacking == 0
        return found if surely or (likely and not declared) else None

    def _angle_of_free_faces(self, sector_angle: float) -> float | None:
        """The part 2 pi/N of a turn by which most free faces match others, if not as declared."""
        some = self._free[:: max(1, len(self._free) // SAMPLED)]
        a = Side(np.unique(self.faces.nodes[some]), "")
        b = Side(np.unique(self.faces.nodes[self._free]), "")

        def quality(angle: float) -> tuple[int, float]:
            cut = self._match(a, b, angle, CLOSE * self.shortest).cut
            off = turned(self.points[cut.left], angle) - self.points[cut.right]
            return len(cut.left), -float(np.linalg.norm(off))

        angles = 2.0 * np.pi / np.arange(2, MOST_CELLS + 1)
        best = max(angles, key=quality)
        return float(best) if quality(best) > quality(sector_angle) else None

    def _unmatched(self, match: _Match, sector_angle: float, tolerance: float) -> str:
        """The nodes of named sides without a partner, how far off they are, and a tolerance."""
        lines = []
        off = np.zeros(0)
        for side, other, lacking, distance, nearest in match.lacking(self, sector_angle, tolerance):
            shown = [
                f"{self.numbers[node]} ({d:.2g} m from {self.numbers[n]})"
                for node, d, n in list(zip(lacking, distance, nearest, strict=True))[:SHOWN]
            ]
            lines.append(
                f"{len(lacking)} of {len(side.nodes)} nodes of {side.name!r} have no partner on "
                f"{other.name or 'another free face'!r}, turned by {degrees(sector_angle):.8g} deg "
                f"about the axle: {', '.join(shown)}"
            )
            off = np.append(off, distance)
        farthest = float(off.max(initial=0.0))
        advice = "the two faces need the same mesh"
        if off.min(initial=np.inf) <= tolerance:
            advice = "give the nodes of whole faces of bricks, mid-sides included, and no others"
        elif farthest < LOOSE * self.shortest:
            advice = f'mesh.tolerance = "{1.01e3 * farthest:.3g} mm" would match them'
        elif not len(match.cut.left):
            advice = "check mesh.axis and cell.sector_angle"
        return f"{'; '.join(lines)}; tolerance {tolerance:.2g} m; {advice}"

    def _no_others(self, cut: Cut, sector_angle: float) -> None:
        """Check that no other free faces meet when the cell is repeated: they were meant to match.

        Raises MeshError for faces that touch, turned towards each other, but are not joined.
        """
        rest = np.setdiff1d(self._free, np.concatenate([cut.left_faces, cut.right_faces]))
        if not len(rest):
            return
        middle, normal = self.points[self.faces.corners[rest]].mean(axis=1), self._normals(rest)
        area = np.linalg.norm(normal, axis=1)
        normal, size = normal / area[:, None], np.sqrt(area)
        there = turned(middle, sector_angle)
        distance, k = _nearest(there, middle)
        towards = np.einsum("fi,fi->f", turned(normal, sector_angle), normal[k])
        apart = np.abs(np.einsum("fi,fi->f", middle[k] - there, normal[k]))
        torn = (towards < -0.7) & (distance < 0.75 * size) & (apart < FACING * size)
        if np.any(torn):
            elements = np.unique(self.elements[np.concatenate([rest[torn], rest[k[torn]]]) // 6])
            raise MeshError(
                f"{self.path}: faces of elements {listed(elements)} meet when the cell is repeated "
                "but do not match node to node; the two faces need the same mesh, or a larger "
                "mesh.tolerance"
            )


@dataclass(frozen=True, slots=True, eq=False)
class _Match:
    """Side a turned onto side b. distance: of all nodes of a to the nearest of b [m]."""

    a: Side
    b: Side
    cut: Cut
    distance: float

    @property
    def n_lacking(self) -> int:
        """How many nodes of named sides are not matched."""
        return int(
            self._lacks(self.a, self.cut.left).sum() + self._lacks(self.b, self.cut.right).sum()
        )

    @staticmethod
    def _lacks(side: Side, matched: IntArray) -> BoolArray:
        return ~np.isin(side.nodes, matched) & bool(side.name)

    def lacking(
        self, cutter: Cutter, angle: float, tolerance: float
    ) -> Iterator[tuple[Side, Side, IntArray, FloatArray, IntArray]]:
        """For each named side: it, the other, its unmatched nodes, their distance and neighbour.

        Those farther off than the tolerance; where there are none, those without a whole face.
        """
        there = turned(cutter.points, angle)
        for side, other, matched, points, others in (
            (self.a, self.b, self.cut.left, there, cutter.points),
            (self.b, self.a, self.cut.right, cutter.points, there),
        ):
            nodes = side.nodes[self._lacks(side, matched)]
            if len(nodes):
                distance, k = _nearest(points[nodes], others[other.nodes])
                far = distance > tolerance
                far = far if np.any(far) else ~far
                yield side, other, nodes[far], distance[far], other.nodes[k[far]]


def _nearest(points: FloatArray, others: FloatArray) -> tuple[FloatArray, IntArray]:
    """Distance (n,) [m] from points (n, 3) to the nearest of others (m, 3), and which it is."""
    distance, k = KDTree(others).query(points)
    return np.asarray(distance), np.asarray(k)


def turned(vectors: FloatArray, angle: float) -> FloatArray:
    """Vectors (n, 3) in x, y, z turned about the axle by an angle [rad] towards growing theta."""
    c, s = np.cos(angle), np.sin(angle)
    return vectors @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
