"""The built-in tyre: a parametric section of a 165/65R13.

The profile's centre line is a curve with continuous tangent through four places of each half -
rim, widest place, tread edge, crown - whose tangents are known: radial at the rim and at the
widest place, along the crown's circle at the tread edge, axial at the crown. The section is the
centre line thickened by half the local thickness to either side along its normal, so that
inner and outer radius, section width, rim width and thicknesses come out exactly.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.mesh.shapes import QUAD4, QUAD8, shape

if TYPE_CHECKING:
    from tyrefrf.case import Geometry

SAMPLES = 4001  # of each half of the centre line: stations are placed to 1e-9 of its length


def tyre_section(geometry: Geometry, quadratic: bool) -> SectionMesh:
    """Mesh the section of the built-in tyre, mirror-symmetric about y = 0.

    quadratic: eight-node quadrilaterals with mid-sides on the curves, else four-node ones.
    Nodes are numbered along the profile from the rim at y < 0, and from the inside out.
    Raises MeshError where the thickness exceeds what the profile's curvature leaves room for.
    """
    step = 2 if quadratic else 1
    n_stations = step * geometry.elements_along + 1
    n_offsets = step * geometry.elements_through + 1
    centre, normal, thickness = _stations(geometry, n_stations)
    offset = np.linspace(-0.5, 0.5, n_offsets)
    grid = centre[:, None] + (thickness[:, None] * offset)[..., None] * normal[:, None]
    section = _grid_section(grid, step, geometry.material)
    if _folded(section):
        raise MeshError(
            "the section folds over itself: it is thicker than twice the radius of its bends; "
            "make geometry.thickness smaller, or section_width or widest_radius larger"
        )
    return section


def _stations(geometry: Geometry, n: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Centre line (n, 2), outward unit normal (n, 2) and thickness (n,), even in arc length."""
    from scipy.interpolate import PchipInterpolator

    curve, knots = _half_centre_line(geometry)
    t = np.linspace(0.0, knots[-1], SAMPLES)
    speed = np.linalg.norm(curve(t, 1), axis=1)
    arc = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2.0 * np.diff(t))])
    half = np.interp(np.linspace(0.0, arc[-1], n // 2 + 1), arc, t)

    s = np.interp(knots, t, arc)
    d = geometry.thickness
    keys = np.array([d.bead, d.sidewall, d.shoulder, d.crown])
    profile = PchipInterpolator(  # of the whole section, so that the crown is smooth too
        np.concatenate([s, 2.0 * s[-1] - s[-2::-1]]), np.concatenate([keys, keys[-2::-1]])
    )
    tangent = curve(half, 1)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    return (
        _mirrored(curve(half), 0.0),
        _mirrored(-_rotated(tangent), 0.0),
        _mirrored(profile(np.interp(half, t, arc))),
    )


def _half_centre_line(geometry: Geometry):  # type: ignore[no-untyped-def]  # a lazy scipy type
    """The centre line's half at y <= 0 as a spline of (r, y), and its four knots [m].

    Segments are as long in the parameter as they are in space, so that the unit tangents bend
    it neither too little nor too much.
    """
    from scipy.interpolate import CubicHermiteSpline

    g, d = geometry, geometry.thickness
    phi = np.arcsin(g.tread_width / 2.0 / g.crown_radius)
    hub = g.outer_radius - g.crown_radius  # the crown circle's centre
    edge = g.crown_radius - d.shoulder / 2.0
    points = np.array(
        [
            [g.inner_radius, -(g.rim_width - d.bead) / 2.0],
            [g.widest_radius, -(g.section_width - d.sidewall) / 2.0],
            [hub + edge * np.cos(phi), -edge * np.sin(phi)],
            [g.outer_radius - d.crown / 2.0, 0.0],
        ]
    )
    tangents = np.array([[1.0, 0.0], [1.0, 0.0], [np.sin(phi), np.cos(phi)], [0.0, 1.0]])
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    for _ in range(20):
        knots = np.concatenate([[0.0], np.cumsum(lengths)])
        curve = CubicHermiteSpline(knots, points, tangents)
        fine = np.array([curve(np.linspace(a, b, 200)) for a, b in pairwise(knots)])
        lengths = np.linalg.norm(np.diff(fine, axis=1), axis=2).sum(axis=1)
    return curve, knots


def _mirrored(half: FloatArray, *mid_plane_y: float) -> FloatArray:
    """A half's stations and their mirror images about y = 0, the crown once and exactly on it."""
    other = half[-2::-1].copy()
    crown = half.copy()
    if half.ndim == 2:
        other[:, 1] *= -1.0
        crown[-1, 1] = mid_plane_y[0]
    return np.concatenate([crown, other])


def _rotated(v: FloatArray) -> FloatArray:
    """Vectors (n, 2) turned by a quarter: at the crown the normal (1, 0) into +y, the tangent."""
    return np.stack([-v[:, 1], v[:, 0]], axis=1)


def _grid_section(grid: FloatArray, step: int, material: str) -> SectionMesh:
    """Quadrilaterals over a grid (stations, offsets, 2) of nodes; step 2: eight nodes each."""
    n_stations, n_offsets = grid.shape[:2]
    k, j = np.meshgrid(np.arange(n_stations), np.arange(n_offsets), indexing="ij")
    used = ~((k % 2 == 1) & (j % 2 == 1)) if step == 2 else np.ones_like(k, dtype=bool)
    number = np.where(used, np.cumsum(used.ravel()).reshape(used.shape) - 1, -1)

    low_k, low_j = np.meshgrid(
        np.arange(0, n_stations - 1, step), np.arange(0, n_offsets - 1, step), indexing="ij"
    )
    corners = [(0, 0), (0, step), (step, step), (step, 0)]
    mids = [(0, 1), (1, 2), (2, 1), (1, 0)] if step == 2 else []
    quads = np.stack([number[low_k + dk, low_j + dj].ravel() for dk, dj in corners + mids], axis=1)
    return SectionMesh(
        points=grid[used],
        quads=quads,
        material=np.zeros(len(quads), dtype=np.int64),
        materials=(material,),
        rim=np.concatenate([number[0], number[-1]]),
        outer=_edges(number[:, -1], step),
        inner=_edges(number[:, 0], step),
    )


def _folded(section: SectionMesh) -> bool:
    """Whether a quadrilateral is turned inside out anywhere: on a grid of 5 x 5 natural points."""
    nodes = QUAD4 if section.quads.shape[1] == 4 else QUAD8
    line = np.linspace(-1.0, 1.0, 5)
    _, dN = shape(nodes, np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2))
    J = np.einsum("gak,eai->egki", dN, section.points[section.quads], optimize=True)
    return bool(np.any(np.linalg.det(J) <= 0.0))


def _edges(line: IntArray, step: int) -> IntArray:
    """A surface's edges from its line of nodes: first, last and, if quadratic, the mid-side."""
    ends = [line[:-1:step], line[step::step]]
    return np.stack(ends + ([line[1::2]] if step == 2 else []), axis=1)
