"""The angular cell: bricks between two sections, mostly one section revolved."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from tyrefrf.arrays import BoolArray, FloatArray, IntArray
from tyrefrf.mesh.section import SectionMesh


@dataclass(frozen=True, slots=True, eq=False)
class CellMesh:
    """One sector of the tyre between its left section (angle 0) and its right section.

    points: (n, 3) r [m], y [m] and theta [rad]; the left section's nodes first, then the
        interior ones, last the right section's, left and right in the section's own order.
    bricks: (e, 8) or (e, 20) node numbers in Abaqus order, natural axes along (r, y, theta).
    material: (e,) index into `materials`.
    planes: (p, n_section) the node that stands at a plane of constant theta over a section
        node, -1 where none does (quadratic bricks have only corners half-way; grooves none). The
        first is the left section, the last the right one; a cell that was not revolved has no
        others.
    rim: numbers of the nodes on the rim, anywhere in the cell.
    inside: (f, 4) or (f, 8) nodes of the brick faces under the inner pressure, in the order of
        QUAD4 or QUAD8; the product of the first natural axis with the second points out of the
        tyre's cavity, into the wall.
    section: what was revolved; else the left faces of the bricks, which come first in `bricks`.
    sector_angle: [rad].
    numbers: (n,) of the nodes in the file that the whole cell was read from; empty for a revolved
        section.
    quads: (e,) the section's element that each brick stands over, layer after layer of bricks;
        empty for a cell that was not revolved.
    """

    points: FloatArray
    bricks: IntArray
    material: IntArray
    materials: tuple[str, ...]
    planes: IntArray
    rim: IntArray
    inside: IntArray
    section: SectionMesh
    sector_angle: float
    numbers: IntArray = field(default_factory=lambda: np.empty(0, np.int64))
    quads: IntArray = field(default_factory=lambda: np.empty(0, np.int64))

    @classmethod
    def over(
        cls,
        section: SectionMesh,
        points: FloatArray,
        bricks: IntArray,
        planes: IntArray,
        sector_angle: float,
        present: BoolArray | None = None,
    ) -> CellMesh:
        """A revolved section: its materials, rim and inner surface are the cell's.

        bricks: layer after layer, each in the order of the section's elements. present: (layers,
        elements) where there is one; everywhere by default.
        """
        if present is None:
            present = np.ones((len(bricks) // section.n_elements, section.n_elements), dtype=bool)
        quads = np.nonzero(present)[1]
        on_rim = planes[:, section.rim].ravel()
        return cls(
            points=points,
            bricks=bricks,
            material=section.material[quads],
            materials=section.materials,
            planes=planes,
            rim=on_rim[on_rim >= 0],
            inside=faces_over(planes, section.inner),
            section=section,
            sector_angle=sector_angle,
            quads=quads,
        )

    @property
    def is_revolved(self) -> bool:
        """Whether the cell is a section revolved, and not as a file has it."""
        return len(self.numbers) == 0

    @property
    def n_nodes(self) -> int:
        """Nodes of the cell, both sections included."""
        return len(self.points)

    @property
    def n_face(self) -> int:
        """Nodes of one section."""
        return int(np.sum(self.planes[0] >= 0))

    @property
    def n_own(self) -> int:
        """Nodes that the cell brings to the ring: all but the right section's."""
        return self.n_nodes - self.n_face

    @property
    def plane_angles(self) -> FloatArray:
        """Angles (p,) [rad] of the planes of `planes`."""
        return self.points[self.planes.max(axis=1), 2]

    @property
    def present(self) -> BoolArray:
        """Where the cell has a brick: (layers, elements of the section).

        One that was not revolved counts as one layer.
        """
        if not len(self.quads):
            return np.ones((1, self.section.n_elements), dtype=bool)
        low = self.plane_angles[:: 2 if self.bricks.shape[1] == 20 else 1]
        layer = np.searchsorted(low, self.points[self.bricks, 2].mean(axis=1)) - 1
        there = np.zeros((len(low) - 1, self.section.n_elements), dtype=bool)
        there[layer, self.quads] = True
        return there

    @property
    def left_bricks(self) -> IntArray:
        """Numbers of the bricks at the left section, one behind each element of `left`.

        Where the cell has none, as a groove begins there, the one before it at the right section.
        """
        present = self.present
        number = np.where(present, np.cumsum(present).reshape(present.shape) - 1, -1)
        behind: IntArray = np.where(number[0] >= 0, number[0], number[-1])
        return behind[behind >= 0]

    @property
    def left(self) -> SectionMesh:
        """The left section: what was revolved, without what a groove takes away there."""
        ends = self.present[0] | self.present[-1]
        return self.section if ends.all() else self.section.without(~ends)

    @property
    def cartesian(self) -> FloatArray:
        """(n, 3) x, y, z [m] with x = r cos theta, z = r sin theta."""
        r, y, theta = self.points.T
        return np.stack([r * np.cos(theta), y, r * np.sin(theta)], axis=1)


def revolve(section: SectionMesh, sector_angle: float, elements_around: int) -> CellMesh:
    """Revolve a section about the axle into a cell of `elements_around` layers of bricks.

    sector_angle: [rad]. Mid-sides of quadratic bricks lie on the circle.
    """
    step = 2 if section.quads.shape[1] == 8 else 1
    theta = np.linspace(0.0, sector_angle, step * elements_around + 1)
    return _revolved(section, theta, np.ones((elements_around, section.n_elements), dtype=bool))


def revolve_between(section: SectionMesh, theta: FloatArray, present: BoolArray) -> CellMesh:
    """Revolve a section into layers of bricks between planes at angles theta (n + 1,) [rad].

    theta: ascending from 0 to the sector's angle. present: (n, elements) where there is a brick;
    in every layer wherever the section has its rim or its inner surface.
    """
    if section.quads.shape[1] == 8:
        layers = np.arange(2 * len(theta) - 1) / 2.0
        theta = np.interp(layers, np.arange(len(theta)), theta)
    return _revolved(section, theta, present)


def _revolved(section: SectionMesh, theta: FloatArray, present: BoolArray) -> CellMesh:
    """As `revolve_between`; theta of quadratic bricks has the planes of their mid-sides too."""
    quadratic = section.quads.shape[1] == 8
    step = 2 if quadratic else 1
    planes = _number_planes(section, present)
    points = np.empty((planes.max() + 1, 3))
    for plane, angle in zip(planes, theta, strict=True):
        there = plane >= 0
        points[plane[there], :2] = section.points[there]
        points[plane[there], 2] = angle

    layers = []
    for low, there in zip(range(0, len(theta) - 1, step), present, strict=True):
        quads = section.quads[there]
        bottom, top = planes[low][quads], planes[low + step][quads]
        nodes = [bottom[:, :4], top[:, :4], bottom[:, 4:], top[:, 4:]]
        if quadratic:
            nodes.append(planes[low + 1][quads[:, :4]])
        layers.append(np.hstack(nodes))
    return CellMesh.over(section, points, np.vstack(layers), planes, float(theta[-1]), present)


def faces_over(planes: IntArray, edges: IntArray) -> IntArray:
    """Nodes (f, 4) or (f, 8) of the brick faces over edges (k, 2) or (k, 3) of the section.

    In the order of QUAD4 or QUAD8, edge by edge and then layer by layer: the first natural axis
    along the edge, the second around the axle.
    """
    n_layers = (len(planes) - 1) // (edges.shape[1] - 1)
    edge, layer = np.meshgrid(np.arange(len(edges)), np.arange(n_layers), indexing="ij")
    return face_nodes(planes, edges[edge.ravel()], layer.ravel())


def face_nodes(planes: IntArray, edges: IntArray, layer: IntArray) -> IntArray:
    """Nodes (m, 4) or (m, 8) of the face over each edge (m, 2) or (m, 3) in a layer (m,)."""
    ends = edges.T
    if len(ends) == 2:
        low, high = layer, layer + 1
        order = [(low, 0), (low, 1), (high, 1), (high, 0)]
    else:
        low, middle, high = 2 * layer, 2 * layer + 1, 2 * layer + 2
        order = [(low, 0), (low, 1), (high, 1), (high, 0)]
        order += [(low, 2), (middle, 1), (high, 2), (middle, 0)]
    return np.stack([planes[plane, ends[end]] for plane, end in order], axis=1)


def _number_planes(section: SectionMesh, present: BoolArray) -> IntArray:
    """Node numbers (planes, section nodes), left section first and right section last.

    The two have the same nodes: those of the bricks at either, which meet in the ring.
    """
    step = 2 if section.quads.shape[1] == 8 else 1
    there = np.zeros((step * len(present) + 1, section.n_nodes), dtype=bool)
    for layer, some in enumerate(present):
        for plane in (step * layer, step * (layer + 1)):
            there[plane, section.quads[some]] = True
        if step == 2:
            there[step * layer + 1, section.quads[some, :4]] = True
    there[[0, -1]] = there[0] | there[-1]
    return np.where(there, np.cumsum(there.ravel()).reshape(there.shape) - 1, -1)
