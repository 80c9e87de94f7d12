"""The parametric section of the tyre; its defaults are a 165/65R13.

Ours, as the paper's figure is lost: everything but the outer and the inner radius.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import AfterValidator, Field

from tyrefrf.case.faults import Fault, refusal
from tyrefrf.case.table import Name, Table
from tyrefrf.case.units import LENGTH, Quantity

Length = Annotated[float, Quantity(LENGTH, gt=0, le=100)]


class Thickness(Table):
    """Thickness of the section by region; it varies smoothly between them."""

    crown: Length = Field(0.014, description="thickness at mid-tread [m]")
    shoulder: Length = Field(0.016, description="thickness at the edge of the tread [m]")
    sidewall: Length = Field(0.006, description="thickness at the widest place [m]")
    bead: Length = Field(0.012, description="thickness at the rim [m]")


def _even(count: int) -> int:
    if count % 2:
        message = f"{count} is odd; must be even, for a node at mid-tread; nearest: {count + 1}"
        raise refusal(Fault((), message))
    return count


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
    elements_through: int = Field(1, ge=1, le=50, description="elements through the thickness")
    material: Name = Field(description="name of the section's material, one of [materials]")

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


def _below(key: tuple[str, ...], value: float, words: str, limit: float) -> Iterator[Fault]:
    if value >= limit:
        yield Fault(key, f"{value:.6g} m is too large; must be below {words} = {limit:.6g} m")
