"""Where a load acts or a probe reads: the place actually used."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees
from typing import Protocol

from tyrefrf.arrays import FloatArray, IntArray

HUB = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
"""The blocked hub's components, in Cartesian axes about the wheel's centre."""

REGION = "region"
"""The kind of the points of a region; they are named "<region>.1", "<region>.2" and so on."""


class Nodes(Protocol):
    """What loads and probes need of a cell: its nodes, the left section's first.

    points: (n, 3) r [m], y [m] and theta [rad]. rim: places of those that are held.
    sector_angle: [rad]. n_own: nodes that the cell brings to the ring, all but the right section's.
    """

    @property
    def points(self) -> FloatArray:
        """See above."""
        ...

    @property
    def rim(self) -> IntArray:
        """See above."""
        ...

    @property
    def sector_angle(self) -> float:
        """See above."""
        ...

    @property
    def n_own(self) -> int:
        """See above."""
        ...


@dataclass(frozen=True, slots=True)
class Place:
    """A named place on the tyre, and the direction that counts there.

    name: the load's or probe's own name.
    kind: "node" (one node), "point" (interpolated), "patch" (disc with uniform traction),
        "region" (interpolated, one of the points of a region).
    surface: "outer", "inner", or "" for a node that lies on neither.
    s: fraction of the surface's arc length, 0 at the rim with y < 0; NaN off the surfaces.
    r, y: [m]; angle: [rad].
    direction: "r", "y" or "theta", local to the place's own angle.
    diameter: of a patch [m], else 0.
    sensor_mass: of the accelerometer that a probe's response is seen with [kg], else 0.
    """

    name: str
    kind: str
    surface: str
    s: float
    r: float
    y: float
    angle: float
    direction: str
    diameter: float = 0.0
    sensor_mass: float = 0.0

    @property
    def label(self) -> str:
        """The place in a legend: `mid-tread: r at outer 0.500, 0 deg`."""
        where = f"{self.surface} {self.s:.3f}" if self.surface else f"r {self.r:.3f} m"
        sensor = f", sensor {1e3 * self.sensor_mass:.4g} g" if self.sensor_mass else ""
        return (
            f"{self.name}: {self.direction} at {where}, "
            f"{degrees(self.angle):.4g}\N{DEGREE SIGN}{sensor}"
        )
