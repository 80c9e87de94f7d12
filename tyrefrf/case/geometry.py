"""The parametric section of the tyre; its defaults are a 165/65R13.

The wall is one body of `geometry.material`, the carcass and sidewall, unless tables for a tread,
a belt and a bead core say that parts of it are something else: the tread is the outer part of
the wall between the tread's edges, the belt the outer rows of what is under it, the core the
inner rows beside the rim. `thickness` is that of the whole wall, layers included.

Ours, as the paper's figure is lost: everything but the outer and the inner radius.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from tyrefrf.case.faults import Fault, refusal
from tyrefrf.case.table import Name, Table
from tyrefrf.case.units import ANGLE, LENGTH, Quantity

Length = Annotated[float, Quantity(LENGTH, ge=1e-6, le=100)]
"""From what is thinner than any layer to what is wider than any tyre."""


class Thickness(Table):
    """Thickness of the whole wall by region, layers included; it varies smoothly between them."""

    crown: Length = Field(0.014, description="thickness at mid-tread [m]")
    shoulder: Length = Field(0.016, description="thickness at the edge of the tread [m]")
    sidewall: Length = Field(0.006, description="thickness at the widest place [m]")
    bead: Length = Field(0.012, description="thickness at the rim [m]")


def _even(count: int) -> int:
    if count % 2:
        message = f"{count} is odd; must be even, for a node at mid-tread; nearest: {count + 1}"
        raise refusal(Fault((), message))
    return count


class Grooves(Table):
    """Transverse grooves across the tread: what is left between them are the blocks.

    Their walls are planes through the axle, a width apart at mid-tread. In the middle of the cell,
    or of its equal parts where there are several; angle 0 then is the middle of a block.
    """

    width: Length = Field(description="width around the tyre, at outer_radius [m]")
    depth: Length = Field(
        description="depth at mid-tread, at most the tread's thickness; elsewhere the same share "
        "of the tread [m]"
    )
    number: int = Field(1, ge=1, le=100, description="grooves in one cell, evenly spaced")
    offset: Annotated[float, Quantity(ANGLE, ge=-360, le=360)] = Field(
        0.0, description="angle of the grooves from those places in the cell [deg]"
    )
    rib: Annotated[float, Quantity(LENGTH, ge=0, le=100)] = Field(
        0.0, description="width of the rib along mid-tread that they leave whole [m]"
    )
    sides: Literal["both", "y<0", "y>0"] = Field(
        "both", description="sides of the tread that have grooves: both, y<0 or y>0"
    )
    elements_across: int | None = Field(
        None,
        ge=1,
        le=100,
        description="elements across the width of a groove, of the cell's elements_around "
        "(default: those that make them about as long as the blocks', an even rest for these)",
    )


class Tread(Table):
    """The tread: the wall's outer part, from its edge at y < 0 to its edge at y > 0.

    Its outside is the crown's circle, tread_width wide; its foot on the body is wider by the
    buttress on either side, where its end faces lean.
    """

    material: Name = Field(description="name of the tread's material, one of [materials]")
    thickness: Length = Field(0.008, description="thickness at mid-tread, part of the wall's [m]")
    edge_thickness: Length = Field(
        0.008, description="thickness at the edge of the tread, part of the wall's shoulder [m]"
    )
    buttress: Annotated[float, Quantity(LENGTH, ge=0, le=100)] = Field(
        0.010,
        description="how far the tread's foot reaches beyond its edge, along the profile [m]",
    )
    elements_along: Annotated[int, Field(ge=2, le=2000), AfterValidator(_even)] | None = Field(
        None,
        description="elements along the tread, of those along the section; even (default: those "
        "that make them about as long as the others)",
    )
    elements_through: int = Field(
        2, ge=1, le=50, description="elements through the tread, beside those through the body"
    )
    grooves: Grooves | None = Field(None, description="transverse grooves in the tread")

    def _faults(self) -> Iterator[Fault]:
        if self.grooves is None:
            return
        depth, most = self.grooves.depth, f"thickness = {self.thickness:.6g} m"
        if depth > self.thickness:
            message = f"{depth:.6g} m is deeper than the tread; must be at most {most}"
            yield Fault(("grooves", "depth"), message)
        elif depth < self.thickness and self.elements_through == 1:
            message = "1 leaves no element under the grooves; must be at least 2, or grooves.depth"
            yield Fault(("elements_through",), f"{message} the whole {most}")


class Belt(Table):
    """The belt: the outermost elements of the body, under the tread."""

    material: Name = Field(description="name of the belt's material, one of [materials]")
    width: Length = Field(0.115, description="width along the profile [m]")
    thickness: Length = Field(0.003, description="thickness, part of the wall's [m]")
    elements_through: int = Field(
        1, ge=1, le=50, description="elements through the belt, of those through the body"
    )


class Bead(Table):
    """The bead's core: the innermost elements of the body, from the rim up."""

    material: Name = Field(description="name of the core's material, one of [materials]")
    height: Length = Field(0.008, description="height above the rim, in radius [m]")
    thickness: Length = Field(0.005, description="thickness, part of the wall's [m]")
    elements_through: int = Field(
        1, ge=1, le=50, description="elements through the core, of those through the body"
    )


class Geometry(Table):
    """The section: rim seat, bulged sidewall, shoulder, slightly crowned tread."""

    outer_radius: Length = Field(0.278, description="radius at mid-tread [m]")  # the paper's
    inner_radius: Length = Field(0.168, description="radius at the rim [m]")  # the paper's
    section_width: Length = Field(0.170, description="width at the widest place [m]")
    rim_width: Length = Field(0.127, description="width between the rim flanges [m]")
    widest_radius: Length = Field(0.225, description="radius at the widest place [m]")
    tread_width: Length = Field(0.125, description="width of the tread [m]")
    crown_radius: Length = Field(0.4, description="radius of the tread across its width [m]")
    thickness: Thickness = Field(Thickness(), description="thickness of the section by region")
    elements_along: Annotated[int, AfterValidator(_even)] = Field(
        28, ge=4, le=2000, description="elements along the section, rim to rim; even"
    )
    elements_through: int = Field(
        1, ge=1, le=50, description="elements through the thickness (of the body, under a tread)"
    )
    material: Name = Field(description="name of the section's material, one of [materials]")
    tread: Tread | None = Field(None, description="the tread, where it is another material")
    belt: Belt | None = Field(None, description="the belt under the tread")
    bead: Bead | None = Field(None, description="the core of the bead")

    @property
    def body(self) -> Thickness:
        """Thickness of the wall without the tread."""
        if self.tread is None:
            return self.thickness
        return self.thickness.model_copy(
            update={
                "crown": self.thickness.crown - self.tread.thickness,
                "shoulder": self.thickness.shoulder - self.tread.edge_thickness,
            }
        )

    def _faults(self) -> Iterator[Fault]:
        for small, large in (
            ("inner_radius", "widest_radius"),
            ("widest_radius", "outer_radius"),
            ("tread_width", "section_width"),
            ("rim_width", "section_width"),
        ):
            yield from _below((small,), getattr(self, small), large, getattr(self, large))
        if self.crown_radius <= self.tread_width / 2:
            yield Fault(
                ("crown_radius",),
                f"{self.crown_radius:.6g} m is too small; "
                f"must be above tread_width/2 = {self.tread_width / 2:.6g} m",
            )
        yield from self._thick_faults()
        yield from self._layer_faults()
        yield from self._count_faults()

    def _thick_faults(self) -> Iterator[Fault]:
        height = ("outer_radius - widest_radius", self.outer_radius - self.widest_radius)
        for region, (words, room) in {
            "crown": height,
            "shoulder": height,
            "sidewall": ("section_width/2", self.section_width / 2),
            "bead": ("rim_width/2", self.rim_width / 2),
        }.items():
            if room > 0:  # else the radii are at fault, and said so
                yield from _below(
                    ("thickness", region), getattr(self.thickness, region), words, room
                )

    def _layer_faults(self) -> Iterator[Fault]:
        """Layers that the wall has no room for."""
        wall, under = self.thickness, ""
        if self.tread is not None:
            tread, under = ("tread", "thickness"), " - tread.thickness"
            yield from _below(tread, self.tread.thickness, "thickness.crown", wall.crown)
            edge = ("tread", "edge_thickness")
            yield from _below(edge, self.tread.edge_thickness, "thickness.shoulder", wall.shoulder)
        if self.belt is not None and self.body.crown > 0:  # else the tread is at fault
            words = f"thickness.crown{under}"
            yield from _below(("belt", "thickness"), self.belt.thickness, words, self.body.crown)
        if self.bead is not None:
            core = ("bead", "thickness")
            yield from _below(core, self.bead.thickness, "thickness.bead", wall.bead)
            room = self.widest_radius - self.inner_radius
            if room > 0:  # else the radii are at fault
                words = "widest_radius - inner_radius"
                yield from _below(("bead", "height"), self.bead.height, words, room)

    def _count_faults(self) -> Iterator[Fault]:
        """Layers that the elements of the body do not suffice for."""
        rest = {"belt": "under the belt", "bead": "outside the bead's core"}
        for name, where in rest.items():
            layer: Belt | Bead | None = getattr(self, name)
            if layer is not None and layer.elements_through >= self.elements_through:
                yield Fault(
                    ("elements_through",),
                    f"{self.elements_through} leaves no element for the carcass {where}; "
                    f"must be at least {layer.elements_through + 1}, one more than "
                    f"{name}.elements_through",
                )
        if self.tread is not None and self.tread.grooves is not None:
            rib = ("tread", "grooves", "rib")
            yield from _below(rib, self.tread.grooves.rib, "tread_width", self.tread_width)
        if self.tread is not None and self.tread.elements_along is not None:
            most = self.elements_along - (2 if self.bead is None else 4)
            if self.tread.elements_along > most:
                yield Fault(
                    ("tread", "elements_along"),
                    f"{self.tread.elements_along} leaves too few for the sidewalls"
                    f"{'' if self.bead is None else ' and beads'}; must be at most {most} with "
                    f"elements_along = {self.elements_along}",
                )


def _below(key: tuple[str, ...], value: float, words: str, limit: float) -> Iterator[Fault]:
    if value >= limit:
        yield Fault(key, f"{value:.6g} m is too large; must be below {words} = {limit:.6g} m")
