"""Places on the tyre's outer and inner surface, by shape functions."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from tyrefrf.arrays import BoolArray, FloatArray, IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.cell import CellMesh, face_nodes
from tyrefrf.mesh.shapes import LINE2, LINE3, QUAD4, QUAD8, shape

NEWTON_STEPS = 20  # quadratic edges converge in four; linear ones in one
ON_PLANE = 1e-9  # of a layer's angle: closer places count as on the plane, and load one section


@dataclass(frozen=True, slots=True, eq=False)
class Spots:
    """m points of a surface, each interpolated from the a nodes of the brick face it lies on.

    cell: (m,) cell number, 0 .. N-1. nodes: (m, a) numbers in the cell. weights: (m, a), sum 1.
    r, y, angle: (m,) where they are on the mesh [m, m, rad].
    """

    cell: IntArray
    nodes: IntArray
    weights: FloatArray
    r: FloatArray
    y: FloatArray
    angle: FloatArray

    def one(self, k: int) -> Spots:
        """The k-th of them, alone."""
        return Spots(*(getattr(self, field.name)[k : k + 1] for field in fields(self)))


class Surface:
    """The outer or the inner surface of a revolved tyre, blocks and not the floors of grooves.

    A place is a fraction s of the section's arc length, 0 at the rim with y < 0 and 1 at the rim
    with y > 0, and an angle around the axle.
    """

    def __init__(self, mesh: CellMesh, name: str) -> None:
        self.mesh = mesh
        self.edges: IntArray = {"outer": mesh.section.outer, "inner": mesh.section.inner}[name]
        self._line = LINE3 if self.edges.shape[1] == 3 else LINE2
        self._points = mesh.section.points[self.edges]
        lengths = self._arc(np.arange(len(self.edges)), np.ones(len(self.edges)))
        self.length = float(lengths.sum())
        self._knots = np.concatenate([[0.0], np.cumsum(lengths) / self.length])
        self._planes = mesh.plane_angles[:: len(self._line) - 1]  # between layers of bricks
        self._there = self._bricks_under()

    def spots(self, s: FloatArray, angle: FloatArray) -> Spots:
        """The places at arc-length fractions s (m,) in [0, 1] and angles (m,) [rad].

        Raises MeshError where one lies over a groove, with the nearest angle for all at which none
        does.
        """
        edge, xi = self._on_line(s)
        cell, layer, phi = self._beside_walls(edge, *self._in_layer(angle))
        if not self._there[edge, layer].all():
            raise MeshError(self._over_groove(edge, np.asarray(angle)))
        nodes = face_nodes(self.mesh.planes, self.edges[edge], layer)
        zeta = self._around(nodes, xi, phi)
        quad = QUAD8 if len(self._line) == 3 else QUAD4
        N, _ = shape(quad, np.stack([xi, zeta], axis=1))
        x, y, z = np.einsum("ma,mai->im", N, self.mesh.cartesian[nodes])
        there = cell * self.mesh.sector_angle + np.arctan2(z, x)
        return Spots(cell, nodes, N, np.hypot(x, z), y, there)

    def disc(self, s: float, angle: float, diameter: float) -> tuple[Spots, FloatArray]:
        """Quadrature of a disc on the surface: spots (m,) and their shares of its area, sum 1.

        The disc is drawn in arc length along the profile and around the axle, so that its area
        is that of a plane disc. Raises MeshError where it reaches over the rim.
        """
        n_radii, n_angles = 6, 24
        x, w = np.polynomial.legendre.leggauss(n_radii)
        radius = diameter / 2.0 * np.sqrt((1.0 + x) / 2.0)  # even shares of area: exact weights
        psi = (np.arange(n_angles) + 0.5) * 2.0 * np.pi / n_angles
        along = (radius[:, None] * np.cos(psi)).ravel() / self.length
        around = (radius[:, None] * np.sin(psi)).ravel()
        if not 0.0 <= s - diameter / 2.0 / self.length <= s + diameter / 2.0 / self.length <= 1.0:
            raise MeshError(
                f"a disc of {1e3 * diameter:.4g} mm at s = {s:.4g} reaches over the rim; "
                f"keep s within {diameter / 2.0 / self.length:.4g} of the middle's side of it"
            )
        edge, xi = self._on_line(s + along)
        r = np.einsum("ma,ma->m", shape(self._line, xi[:, None])[0], self._points[edge, :, 0])
        share = np.repeat(w / 2.0 / n_angles, n_angles)
        return self.spots(s + along, angle + around / r), share

    def nearest(self, s: float, angle: float) -> tuple[int, int]:
        """The node nearest to a place: its number in the section and its plane in the ring.

        Planes are numbered around the whole ring; only those that hold the node count.
        """
        node = self.nearest_node(s)
        return node, self.nearest_plane(node, angle)

    def nearest_node(self, s: float) -> int:
        """The section node on the surface that is nearest to an arc-length fraction."""
        fractions = self.fractions()
        return min(fractions, key=lambda n: abs(fractions[n] - s))

    def nearest_plane(self, node: int, angle: float) -> int:
        """The plane of the ring nearest to an angle [rad], of those that hold a section node."""
        alpha, theta = self.mesh.sector_angle, self.mesh.plane_angles[:-1]
        planes = np.flatnonzero(self.mesh.planes[:-1, node] >= 0)
        cell, rest = divmod(angle, alpha)
        there = (alpha * np.arange(-1, 2)[:, None] + theta[planes]).ravel()
        turn, k = divmod(int(np.argmin(np.abs(there - rest))), len(planes))
        return (int(cell) + turn - 1) * len(theta) + int(planes[k])

    def fractions(self) -> dict[int, float]:
        """Arc-length fraction s of every section node on the surface."""
        half = [self._knots[:-1], self._knots[1:]]
        if len(self._line) == 3:
            middle = self._arc(np.arange(len(self.edges)), np.zeros(len(self.edges)))
            half.append(self._knots[:-1] + middle / self.length)
        return dict(zip(self.edges.T.ravel().tolist(), np.concatenate(half).tolist(), strict=True))

    def _arc(self, edge: IntArray, xi: FloatArray) -> FloatArray:
        """Arc length (m,) [m] of edges from their start to natural coordinates xi (m,)."""
        x, w = np.polynomial.legendre.leggauss(8)
        t = -1.0 + (xi[:, None] + 1.0) / 2.0 * (x + 1.0)
        return (xi + 1.0) / 2.0 * (self._speed(edge[:, None], t) @ w)

    def _speed(self, edge: IntArray, xi: FloatArray) -> FloatArray:
        """Arc length per natural coordinate [m], of the shape of xi."""
        dN = shape(self._line, xi.reshape(-1, 1))[1].reshape(*xi.shape, -1)
        return np.linalg.norm(np.einsum("...a,...ai->...i", dN, self._points[edge]), axis=-1)

    def _on_line(self, s: FloatArray) -> tuple[IntArray, FloatArray]:
        """Edge and natural coordinate of arc-length fractions."""
        edge = np.clip(np.searchsorted(self._knots, s, side="right") - 1, 0, len(self.edges) - 1)
        target = (s - self._knots[edge]) * self.length
        xi = np.zeros(len(s))
        for _ in range(NEWTON_STEPS):
            xi -= (self._arc(edge, xi) - target) / self._speed(edge, xi)
        return edge, np.clip(xi, -1.0, 1.0)

    def _in_layer(self, angle: FloatArray) -> tuple[IntArray, IntArray, FloatArray]:
        """Cell, layer of bricks in it, and angle from the cell's left section [rad]."""
        alpha, low = self.mesh.sector_angle, self._planes
        n_layers = len(low) - 1
        cell = np.floor(np.asarray(angle) / alpha).astype(np.int64)
        rest = np.asarray(angle) - cell * alpha
        layer = np.clip(np.searchsorted(low, rest, side="right") - 1, 0, n_layers - 1)
        share = (rest - low[layer]) / np.diff(low)[layer]
        nearest = np.round(share)
        layer = np.where(abs(share - nearest) < ON_PLANE, layer + nearest.astype(np.int64), layer)
        phi = np.where(abs(share - nearest) < ON_PLANE, low[layer], rest)
        over = layer == n_layers
        n_cells = round(2.0 * np.pi / alpha)
        return (cell + over) % n_cells, np.where(over, 0, layer), np.where(over, 0.0, phi)

    def _beside_walls(
        self, edge: IntArray, cell: IntArray, layer: IntArray, phi: FloatArray
    ) -> tuple[IntArray, IntArray, FloatArray]:
        """What `_in_layer` found, but the layer before for places where a groove just begins."""
        n_layers = len(self._planes) - 1
        ends = ~self._there[edge, layer] & (phi == self._planes[layer])
        before = np.where(ends, layer - 1, layer) % n_layers
        n_cells = round(2.0 * np.pi / self.mesh.sector_angle)
        cell = np.where(ends & (layer == 0), cell - 1, cell) % n_cells
        return cell, before, np.where(ends, self._planes[before + 1], phi)

    def _bricks_under(self) -> BoolArray:
        """Whether each edge has a brick under it in each layer: (edges, layers)."""
        corners = self.mesh.section.quads[:, :4]
        sides = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2)
        owner = {
            frozenset(side): e for e, quad in enumerate(sides.tolist()) for side in quad
        }  # the surfaces' edges have one element only
        under = [owner[frozenset(edge)] for edge in self.edges[:, :2].tolist()]
        return self.mesh.present[:, under].T

    def _over_groove(self, edge: IntArray, angle: FloatArray) -> str:
        """What is wrong with places over a groove, and where the nearest block is for all."""
        alpha, planes = self.mesh.sector_angle, self._planes
        on_block = np.tile(self._there[np.unique(edge)].all(axis=0), 3)
        theta = np.append((alpha * np.arange(-1, 2)[:, None] + planes[:-1]).ravel(), 2.0 * alpha)
        ends = np.diff(np.concatenate([[False], on_block, [False]]).astype(int))
        middle, reach = (angle.max() + angle.min()) / 2.0, np.ptp(angle) / 2.0
        start = np.floor(middle / alpha) * alpha
        low, high = theta[ends == 1] + start + reach, theta[ends == -1] + start - reach
        low, high = np.ceil(np.rad2deg(low) * 1e4) / 1e4, np.floor(np.rad2deg(high) * 1e4) / 1e4
        here = float(np.rad2deg(middle))
        words = f"at {here % 360.0:.6g} deg there is a groove"
        fits = low <= high
        if not fits.any():
            return f"{words}, and no block that is long enough; take a point or a smaller disc"
        nearest = np.clip(here, low[fits], high[fits])
        best = float(nearest[np.argmin(abs(nearest - here))]) % 360.0
        return f"{words}; the nearest angle on a block is {best:.7g} deg"

    def _around(self, nodes: IntArray, xi: FloatArray, phi: FloatArray) -> FloatArray:
        """Natural coordinate (m,) at which a face stands at angles phi from the cell's left."""
        quad = QUAD8 if len(self._line) == 3 else QUAD4
        x, _, z = np.moveaxis(self.mesh.cartesian[nodes], 2, 0)
        off = x * np.sin(phi)[:, None] - z * np.cos(phi)[:, None]  # zero on the ray at phi
        zeta = np.zeros(len(xi))
        for _ in range(NEWTON_STEPS):
            N, dN = shape(quad, np.stack([xi, zeta], axis=1))
            zeta -= np.sum(N * off, axis=1) / np.sum(dN[:, :, 1] * off, axis=1)
        nearest = np.round(zeta)
        return np.where(abs(zeta - nearest) < ON_PLANE, nearest, zeta)
