"""The centre line of the tyre's body: a parametric section of a 165/65R13.

The line is a curve with continuous tangent through four places of each half - rim, widest place,
tread edge, crown - whose tangents are known: radial at the rim and at the widest place, along the
crown's circle at the tread edge, axial at the crown. The body is the centre line thickened by half
the local thickness to either side along its normal, so that inner and outer radius, rim width
and thicknesses come out exactly; the section width is exact at the widest radius, and 1.3 um more
beyond it, where the wall thickens. A tread stands on the body.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefrf.arrays import FloatArray

if TYPE_CHECKING:
    from tyrefrf.case import Geometry

SAMPLES = 4001  # of each half of the centre line: stations are placed to 1e-9 of its length


@dataclass(frozen=True, slots=True, eq=False)
class CentreLine:
    """The half of the body's centre line at y <= 0, by arc length from the rim.

    curve: (r, y) over the parameter. t, arc: samples of the parameter and their arc lengths [m].
    profile: the body's thickness over arc length, both in m.
    widest, shoulder: arc lengths [m] of the widest place and of the tread's edge.
    """

    curve: Any  # splines: scipy is imported when it is first used
    t: FloatArray
    arc: FloatArray
    profile: Any
    widest: float
    shoulder: float

    @property
    def length(self) -> float:
        """Arc length [m] of the half, from the rim to the crown."""
        return float(self.arc[-1])

    def stations(self, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Centre (n, 2), outward unit normal (n, 2), thickness (n,) at arc lengths s (n,) [m]."""
        t = np.interp(s, self.arc, self.t)
        tangent = self.curve(t, 1)
        tangent /= np.linalg.norm(tangent, axis=1)[:, None]
        normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
        return self.curve(t), normal, self.thickness(np.interp(t, self.t, self.arc))

    def thickness(self, s: FloatArray) -> FloatArray:
        """The body's thickness [m] at arc lengths s [m]."""
        return np.asarray(self.profile(s))

    def at_radius(self, r: float) -> float:
        """The arc length [m] at which the line first reaches a radius [m]."""
        radii = np.maximum.accumulate(self.curve(self.t)[:, 0])
        return float(np.interp(r, radii, self.arc))


def centre_line(geometry: Geometry) -> CentreLine:
    """The centre line of the body, and its thickness along it."""
    from scipy.interpolate import PchipInterpolator

    curve, knots = _half_curve(geometry)
    t = np.linspace(0.0, knots[-1], SAMPLES)
    speed = np.linalg.norm(curve(t, 1), axis=1)
    arc = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2.0 * np.diff(t))])

    s = np.interp(knots, t, arc)
    d = geometry.body
    keys = np.array([d.bead, d.sidewall, d.shoulder, d.crown])
    profile = PchipInterpolator(  # of the whole section, so that the crown is smooth too
        np.concatenate([s, 2.0 * s[-1] - s[-2::-1]]), np.concatenate([keys, keys[-2::-1]])
    )
    return CentreLine(curve, t, arc, profile, widest=float(s[1]), shoulder=float(s[2]))


def _half_curve(geometry: Geometry) -> tuple[Any, FloatArray]:
    """The centre line's half at y <= 0 as a spline of (r, y), and its four knots [m].

    Segments are as long in the parameter as they are in space, so that the unit tangents bend
    it neither too little nor too much.
    """
    from scipy.interpolate import CubicHermiteSpline

    g, d, tread = geometry, geometry.body, geometry.tread
    on_crown, on_edge = (tread.thickness, tread.edge_thickness) if tread else (0.0, 0.0)
    phi = np.arcsin(g.tread_width / 2.0 / g.crown_radius)
    hub = g.outer_radius - g.crown_radius  # the crown circle's centre
    edge = g.crown_radius - on_edge - d.shoulder / 2.0
    points = np.array(
        [
            [g.inner_radius, -(g.rim_width - d.bead) / 2.0],
            [g.widest_radius, -(g.section_width - d.sidewall) / 2.0],
            [hub + edge * np.cos(phi), -edge * np.sin(phi)],
            [g.outer_radius - on_crown - d.crown / 2.0, 0.0],
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
