"""The mesh of the whole ring, as those who draw it want it: points in space and their bricks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray, IntArray, frozen
from tyrefrf.mesh.brick_faces import BrickFaces
from tyrefrf.mesh.cell import CellMesh


@dataclass(frozen=True, slots=True, eq=False)
class RingMesh:
    """All cells' own nodes, cell after cell, and the bricks between them; arrays are read-only.

    points: (p, 3) x, y, z [m] of the tyre as meshed: x = r cos theta, z = r sin theta.
    theta: (p,) [rad] angle around the axle of every point.
    bricks: (b, 8) or (b, 20) point numbers in Abaqus order.
    cell: (b,) number of the angular cell that a brick is in.
    material: (b,) index into `materials`.
    outer: (f, 4) corners of the brick faces on the outer surface; its normal points outwards.
    """

    points: FloatArray
    theta: FloatArray
    bricks: IntArray
    cell: IntArray
    material: IntArray
    materials: tuple[str, ...]
    outer: IntArray

    def __post_init__(self) -> None:
        for name in ("points", "theta", "bricks", "cell", "material", "outer"):
            frozen(getattr(self, name))

    @classmethod
    def of(cls, mesh: CellMesh, n_cells: int) -> RingMesh:
        """N copies of a cell around the axle: a right section is the next cell's left one."""
        r, y, theta = mesh.points[: mesh.n_own].T
        cells = np.arange(n_cells)
        angle = (theta + cells[:, None] * mesh.sector_angle).ravel()
        r, y = np.tile(r, n_cells), np.tile(y, n_cells)
        bricks = _around(mesh.bricks, mesh, n_cells)
        return cls(
            points=np.stack([r * np.cos(angle), y, r * np.sin(angle)], axis=1),
            theta=angle,
            bricks=bricks,
            cell=np.repeat(cells, len(mesh.bricks)),
            material=np.tile(mesh.material, n_cells),
            materials=mesh.materials,
            outer=_outer(bricks, mesh, n_cells),
        )

    def cartesian(self, u: ComplexArray) -> ComplexArray:
        """Vectors (p, 3) along r, y and theta at their own points, along x, y and z."""
        c, s = np.cos(self.theta), np.sin(self.theta)
        u_r, u_y, u_theta = u.T
        return np.stack([u_r * c - u_theta * s, u_y, u_r * s + u_theta * c], axis=1)


def _outer(bricks: IntArray, mesh: CellMesh, n_cells: int) -> IntArray:
    """Corners (f, 4) of the free faces of the ring's bricks, without those inside or on the rim."""
    faces = BrickFaces.of(bricks, np.arange(len(bricks)), "ring")
    free = faces.corners[faces.free]
    inside = _around(mesh.inside[:, :4], mesh, n_cells)
    _, first, count = np.unique(
        np.sort(np.concatenate([free, inside]), axis=1),
        axis=0,
        return_index=True,
        return_counts=True,
    )
    outside = free[np.sort(first[(count == 1) & (first < len(free))])]
    rim = _around(mesh.rim[:, None], mesh, n_cells).ravel()
    return outside[~np.isin(outside, rim).all(axis=1)]


def _around(nodes: IntArray, mesh: CellMesh, n_cells: int) -> IntArray:
    """A cell's node numbers (k, a) as point numbers (n_cells k, a) of the ring, cell by cell."""
    in_ring = nodes + mesh.n_own * np.arange(n_cells)[:, None, None]
    return (in_ring % (mesh.n_own * n_cells)).reshape(-1, nodes.shape[1])
