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
SensorMass = Annotated[float, Quantity(MASS, gt=0, le=100)]

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
        None, ge=0, le=10**6, description="number of the section's node, from 0"
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

    diameter: Annotated[float, Quantity(LENGTH, gt=0, le=1)] = Field(
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
    | Annotated[HubProbe, Tag("hub")],
    by_kind("point"),
]
