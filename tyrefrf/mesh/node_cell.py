"""A cell of which only the nodes are known: where brought matrices have their dofs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.section import SectionMesh

SAME_PLACE = 1e-5
"""Distance of a node from its partner across the cell, relative to the section's size, up to which
they are the same: above what coordinates of seven digits leave."""


@dataclass(frozen=True, slots=True, eq=False)
class NodeCell:
    """The nodes of one sector of the tyre, in the order of `CellMesh`, without its bricks.

    points: (n, 3) r [m], y [m] and theta [rad] as the nodes' own file has it, but for whole cells,
        so that the left section is the one nearest to angle 0; its nodes come first, then the
        interior ones, last the right section's in the order of the left. Unknowns that belong to
        no node stand, by threes, in the middle of the cell.
    numbers: (n,) of the nodes in their file, -1 of what is no node.
    n_face: nodes of one section. rim: places of the nodes on the rim, anywhere in the cell.
    parts: names of the parts that the stiffness comes in. sector_angle: [rad].
    """

    points: FloatArray
    numbers: IntArray
    n_face: int
    rim: IntArray
    parts: tuple[str, ...]
    sector_angle: float

    @property
    def n_nodes(self) -> int:
        """Nodes of the cell, both sections included."""
        return len(self.points)

    @property
    def n_own(self) -> int:
        """Nodes that the cell brings to the ring: all but the right section's."""
        return self.n_nodes - self.n_face

    @property
    def planes(self) -> IntArray:
        """(2, n_face) the nodes over the section's: its own, and the right section's."""
        return np.arange(self.n_face) + np.array([[0], [self.n_own]])

    @property
    def plane_angles(self) -> FloatArray:
        """(2,) angles [rad] of the first of their nodes."""
        return self.points[self.planes[:, 0], 2]

    @property
    def left(self) -> SectionMesh:
        """The left section, as a mesh of bricks calls it."""
        return self.section

    @property
    def section(self) -> SectionMesh:
        """The left section: points without elements or surfaces."""
        nothing = np.empty((0, 2), np.int64)
        return SectionMesh(
            points=self.points[: self.n_face, :2].copy(),
            quads=np.empty((0, 4), np.int64),
            material=nothing[:, 0],
            materials=self.parts,
            rim=self.rim[self.rim < self.n_face],
            outer=nothing,
            inner=nothing,
        )


def cylindrical(points: FloatArray) -> FloatArray:
    """(n, 3) r, y and theta of x, y and z; theta from x towards z."""
    x, y, z = points.T
    return np.stack([np.hypot(x, z), y, np.arctan2(z, x)], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class Matched:
    """The two sections of a cell, node on node.

    left, right: (m,) places of the nodes; right[i] is left[i] turned by the cell's angle.
    theta: (m,) of the left nodes [rad], without a jump at 180 degrees. whole_cells: how many cells
        further they stand nearest to angle 0.
    exchanged: whether the sections were named the other way round. gap: largest distance of a
    node from its partner [m].
    """

    left: IntArray
    right: IntArray
    theta: FloatArray
    whole_cells: int
    exchanged: bool
    gap: float


def matched(
    points: FloatArray, numbers: IntArray, left: IntArray, right: IntArray, sector_angle: float
) -> Matched:
    """Find for every node of the left section the one of the right section, theta growing.

    points: (n, 3) r, y, theta of the nodes, numbers: (n,) theirs; left, right: places in them.
    Raises MeshError, naming a node, where the sections do not fall on each other.
    """
    if len(left) != len(right):
        raise MeshError(
            f"the left section has {len(left)} nodes and the right one {len(right)}; "
            "they must be the same nodes, one cell further"
        )
    if both := np.intersect1d(left, right).tolist():
        raise MeshError(f"node {numbers[both[0]]} is in the left section and in the right one")
    size = max(np.ptp(_cartesian(points[left]), axis=0).max(), points[left, 0].max() * 1e-3)
    tries = [_partners(points, *pair, sector_angle) for pair in ((left, right), (right, left))]
    exchanged = bool(tries[1][0].max() < tries[0][0].max())
    distance, partner = tries[exchanged]
    first, second = (right, left) if exchanged else (left, right)
    if distance.max() > SAME_PLACE * size:
        worst = int(np.argmax(distance))
        raise MeshError(
            f"node {numbers[first[worst]]}, turned by cell.sector_angle = "
            f"{np.rad2deg(sector_angle):.10g} deg about the axle, falls on no node of the other "
            f"section: {1e3 * distance[worst]:.3g} mm from node "
            f"{numbers[second[partner[worst]]]}; see to the sets, the unit and the axis"
        )
    if len(np.unique(partner)) < len(partner):
        raise MeshError("several nodes of a section fall on the same node of the other one")
    theta = points[first, 2]
    theta = theta[0] + np.angle(np.exp(1j * (theta - theta[0])))  # no jump at +-180 degrees
    further = -round(theta.mean() / sector_angle)
    return Matched(first, second[partner], theta, further, exchanged, float(distance.max()))


def _partners(
    points: FloatArray, left: IntArray, right: IntArray, sector_angle: float
) -> tuple[FloatArray, IntArray]:
    """Distance (m,) of every left node, turned, from the nearest right one, and which that is."""
    turned = points[left] + [0.0, 0.0, sector_angle]
    distance, partner = KDTree(_cartesian(points[right])).query(_cartesian(turned))
    return np.asarray(distance), np.asarray(partner)


def _cartesian(points: FloatArray) -> FloatArray:
    r, y, theta = points.T
    return np.stack([r * np.cos(theta), y, r * np.sin(theta)], axis=1)
