"""The angular cell: bricks between two sections, mostly one section revolved."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.mesh.section import SectionMesh


@dataclass(frozen=True, slots=True, eq=False)
class CellMesh:
    """One sector of the tyre between its left section (angle 0) and its right section.

    points: (n, 3) r [m], y [m] and theta [rad]; the left section's nodes first, then the
        interior ones, last the right section's, left and right in the section's own order.
    bricks: (e, 8) or (e, 20) node numbers in Abaqus order, natural axes along (r, y, theta).
    material: (e,) index into `materials`.
    planes: (p, n_section) the node that stands at a plane of constant theta over a section
        node, -1 where none does (quadratic bricks have only corners half-way). The first is the
        left section, the last the right one; a cell that was not revolved has no others.
    rim: numbers of the nodes on the rim, anywhere in the cell.
    inside: (f, 4) or (f, 8) nodes of the brick faces under the inner pressure, in the order of
        QUAD4 or QUAD8; the product of the first natural axis with the second points out of the
        tyre's cavity, into the wall.
    section: what was revolved; else the left faces of the bricks, which come first in `bricks`.
    sector_angle: [rad].
    numbers: (n,) of the nodes in the file that the whole cell was read from; empty for a revolved
        section.
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

    @classmethod
    def over(
        cls,
        section: SectionMesh,
        points: FloatArray,
        bricks: IntArray,
        planes: IntArray,
        sector_angle: float,
    ) -> CellMesh:
        """A revolved section: its materials, rim and inner surface are the cell's.

        bricks: layer after layer, each in the order of the section's elements.
        """
        on_rim = planes[:, section.rim].ravel()
        return cls(
            points=points,
            bricks=bricks,
            material=np.tile(section.material, len(bricks) // section.n_elements),
            materials=section.materials,
            planes=planes,
            rim=on_rim[on_rim >= 0],
            inside=faces_over(planes, section.inner),
            section=section,
            sector_angle=sector_angle,
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
        return self.section.n_nodes

    @property
    def n_own(self) -> int:
        """Nodes that the cell brings to the ring: all but the right section's."""
        return self.n_nodes - self.n_face

    @property
    def cartesian(self) -> FloatArray:
        """(n, 3) x, y, z [m] with x = r cos theta, z = r sin theta."""
        r, y, theta = self.points.T
        return np.stack([r * np.cos(theta), y, r * np.sin(theta)], axis=1)


def revolve(section: SectionMesh, sector_angle: float, elements_around: int) -> CellMesh:
    """Revolve a section about the axle into a cell of `elements_around` layers of bricks.

    sector_angle: [rad]. Mid-sides of quadratic bricks lie on the circle.
    """
    quadratic = section.quads.shape[1] == 8
    step = 2 if quadratic else 1
    n_planes = step * elements_around + 1
    planes = _number_planes(section, n_planes, step)
    theta = np.linspace(0.0, sector_angle, n_planes)
    points = np.empty((planes.max() + 1, 3))
    for plane, angle in zip(planes, theta, strict=True):
        there = plane >= 0
        points[plane[there], :2] = section.points[there]
        points[plane[there], 2] = angle

    layers = []
    for low in range(0, n_planes - 1, step):
        bottom, top = planes[low][section.quads], planes[low + step][section.quads]
        nodes = [bottom[:, :4], top[:, :4], bottom[:, 4:], top[:, 4:]]
        if quadratic:
            nodes.append(planes[low + 1][section.quads[:, :4]])
        layers.append(np.hstack(nodes))
    return CellMesh.over(section, points, np.vstack(layers), planes, sector_angle)


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


def _number_planes(section: SectionMesh, n_planes: int, step: int) -> IntArray:
    """Node numbers (planes, section nodes), left section first and right section last."""
    there = np.ones((n_planes, section.n_nodes), dtype=bool)
    if step == 2:
        corner = np.zeros(section.n_nodes, dtype=bool)
        corner[section.quads[:, :4]] = True
        there[1::2] = corner
    return np.where(there, np.cumsum(there.ravel()).reshape(there.shape) - 1, -1)
