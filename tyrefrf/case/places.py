"""Loads and probes: where the tyre is excited, and where its response is taken."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, Tag

from tyrefrf.case.faults import Fault, refusal
from tyrefrf.case.table import Name, Table, by_kind
from tyrefrf.case.units import ANGLE, LENGTH, MASS, Quantity

Direction = Literal["r", "y", "theta"]
Surface = Literal["outer", "inner"]
ArcFraction = Annotated[float, Field(ge=0, le=1)]
SensorMass = Annotated[float, Quantity(MASS, ge=1e-12, le=100)]

MOST_POINTS = 10_000
"""The most points of a region."""

_NAME = "name, unique among the loads or the probes; one line of up to 100 characters"
_SURFACE = "surface of the tyre: outer or inner"
_S = (
    "place along the surface as a fraction of its length [-], from 0 at the rim with y < 0 "
    "by 0.5 at mid-tread to 1 at the rim with y > 0"
)
_SENSOR_MASS = (
    "mass of an accelerometer at the place [kg], which takes part in the motion in all three "
    "directions: the response is what the sensor sees"
)


def _within_one_turn(angle: float) -> float:
    if not 0 <= angle < 360:
        same = f"{float(f'{angle % 360:.10g}') % 360:.10g} deg"
        raise refusal(Fault((), f"{angle:.10g} deg is not in 0 <= angle < 360; the same: {same}"))
    return angle


class Point(Table):
    """A named place and direction on the tyre."""

    name: Name = Field(description=_NAME)
    angle: Annotated[float, Quantity(ANGLE), AfterValidator(_within_one_turn)] = Field(
        0.0, description="angle around the axle [deg], 0 <= angle < 360"
    )
    direction: Direction = Field(
        description="local direction: r (radial, outwards), y (along the axle) or theta"
    )


class AtNode(Point):
    """A node of the mesh: the nearest to a place, or a section's node by its number."""

    node: int | None = Field(
        None,
        ge=0,
        le=10**9,
        description="number of the section's node, from 0; of a node of the cell as its file has "
        "it with [mesh] and [matrices]",
    )
    surface: Surface = Field("outer", description=_SURFACE)
    s: ArcFraction | None = Field(None, description=_S)

    def _faults(self) -> Iterator[Fault]:
        if self.node is None and self.s is None:
            yield Fault((), "has no place; give s (0 to 1 along the surface) or node")
        if self.node is not None and self.s is not None:
            yield Fault(("node",), "not together with s; give one of the two")
        elif self.node is not None and self.surface == "inner":
            yield Fault(("surface",), "not together with node; node has a surface of its own")


class OnSurface(Point):
    """A place on a surface of the tyre."""

    surface: Surface = Field("outer", description=_SURFACE)
    s: ArcFraction = Field(description=_S)


class OnPatch(OnSurface):
    """A disc on a surface of the tyre, under uniform traction."""

    diameter: Annotated[float, Quantity(LENGTH, ge=1e-6, le=1)] = Field(
        0.010, description="diameter of the disc [m]"
    )


class NodeLoad(AtNode):
    """A unit force at a node. Its mobility does not converge as the mesh is refined."""

    kind: Literal["node"] = Field("node", description="a force at a node of the mesh")


class PatchLoad(OnPatch):
    """A unit force spread over a disc."""

    kind: Literal["patch"] = Field(description="a force spread over a disc")


class PointProbe(OnSurface):
    """The response at a point, interpolated in the mesh."""

    kind: Literal["point"] = Field("point", description="response at a point, interpolated")
    sensor_mass: SensorMass | None = Field(None, description=_SENSOR_MASS)


class NodeProbe(AtNode):
    """The response of a node."""

    kind: Literal["node"] = Field(description="response of a node of the mesh")
    sensor_mass: SensorMass | None = Field(None, description=_SENSOR_MASS)


class PatchProbe(OnPatch):
    """The response averaged over a disc."""

    kind: Literal["patch"] = Field(description="response averaged over a disc")
    sensor_mass: SensorMass | None = Field(None, description=_SENSOR_MASS)


class RegionProbe(Table):
    """Points spread evenly over a part of a surface, for means over it."""

    kind: Literal["region"] = Field(description="points that sample a region, for its mean square")
    name: Name = Field(
        max_length=90,
        description="name, unique among the probes; its points are <name>.1, <name>.2",
    )
    surface: Surface = Field("outer", description=_SURFACE)
    s: tuple[ArcFraction, ...] = Field(
        strict=False, min_length=2, max_length=2, description="first and last " + _S
    )
    angle: tuple[Annotated[float, Quantity(ANGLE, ge=-360, le=360)], ...] = Field(
        (0.0, 360.0),
        strict=False,
        min_length=2,
        max_length=2,
        description="first and last angle around the axle [deg], at most a turn apart",
    )
    direction: Direction = Field(
        description="local direction: r (radial, outwards), y (along the axle) or theta"
    )
    count: tuple[Annotated[int, Field(ge=1, le=1000)], ...] = Field(
        (8, 36),
        strict=False,
        min_length=2,
        max_length=2,
        description="points along the section, and around the axle",
    )

    def _faults(self) -> Iterator[Fault]:
        if not self.s[0] < self.s[1]:
            yield Fault(("s",), "first and last are not in order; give first < last")
        if not 0.0 < self.angle[1] - self.angle[0] <= 360.0:
            yield Fault(("angle",), "give first < last, at most 360 deg apart")
        if self.count[0] * self.count[1] > MOST_POINTS:
            message = f"{self.count[0] * self.count[1]} points; at most {MOST_POINTS} in a region"
            yield Fault(("count",), message)

    def points(self) -> Iterator[PointProbe]:
        """The points, in the middle of equal parts, along the section fastest.

        Named "<region>.1", "<region>.2" and so on.
        """
        along, around = self.count
        for k in range(along * around):
            j, i = divmod(k, along)
            yield PointProbe(
                name=f"{self.name}.{k + 1}",
                surface=self.surface,
                s=_middle(self.s, i, along),
                angle=_middle(self.angle, j, around) % 360.0,
                direction=self.direction,
            )


def _middle(ends: tuple[float, ...], k: int, n: int) -> float:
    """The middle of the k-th of n equal parts."""
    return ends[0] + (k + 0.5) / n * (ends[1] - ends[0])


class HubProbe(Table):
    """The blocked force and moment at the rim: six components about the wheel's centre."""

    kind: Literal["hub"] = Field(description="blocked force [N] and moment [N m] at the hub")
    name: Name = Field("hub", description=_NAME)


Load = Annotated[
    Annotated[NodeLoad, Tag("node")] | Annotated[PatchLoad, Tag("patch")], by_kind("node")
]
Probe = Annotated[
    Annotated[PointProbe, Tag("point")]
    | Annotated[NodeProbe, Tag("node")]
    | Annotated[PatchProbe, Tag("patch")]
    | Annotated[RegionProbe, Tag("region")]
    | Annotated[HubProbe, Tag("hub")],
    by_kind("point"),
]
