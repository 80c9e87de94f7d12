"""The tyre's section, or one periodic cell of it, from a mesh file of another program."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal, Protocol

from pydantic import Discriminator, Field, Tag

from tyrefrf.case.faults import Fault
from tyrefrf.case.material import Angle
from tyrefrf.case.table import Name, Table, by_kind
from tyrefrf.case.units import LENGTH, Quantity

Direction = Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=2)]


class HeldMesh(Protocol):
    """A mesh in memory, in place of the file that a case names; what it is, is not read here."""

    def digest(self) -> str:
        """SHA-256 of what it holds."""


class Region(Table):
    """What an element set is made of, and how its layers lie."""

    material: Name = Field(description="name of the set's material, one of [materials]")
    angle: Angle | None = Field(
        None,
        description="angle of the material's axis 1, or of a single ply's cords, in this set, "
        "instead of the material's own [deg]",
    )
    through: Direction | None = Field(
        None,
        description="direction [dr, dy] through the set's layers, from the inside out; default: "
        "found element by element",
    )

    def _faults(self) -> Iterator[Fault]:
        if self.through == (0.0, 0.0):
            yield Fault(
                ("through",), "[0, 0] is no direction; give [1, 0] for a belt, for instance"
            )


def _form(entry: object) -> str:
    return "table" if isinstance(entry, dict | Region) else "name"


SetMaterial = Annotated[
    Annotated[Name, Tag("name")] | Annotated[Region, Tag("table")], Discriminator(_form)
]
"""The name of a material, or a table with more."""


class MeshFile(Table):
    """What every mesh file needs said: nothing about units or axes is guessed."""

    file: str = Field(
        min_length=1,
        description="mesh file, beside the case file: Abaqus or CalculiX .inp; Gmsh .msh and what "
        'else meshlane reads (extra "mesh"); Ansys .cdb (extra "ansys")',
    )
    unit: Literal["m", "mm", "in"] = Field(description="unit of the file's coordinates")
    axis: Literal["x", "y", "z"] = Field("y", description="the axle in the file's coordinates")
    rim: str = Field(description="node set, or set of lines, that the rim holds")
    inner: str | None = Field(
        None,
        description="inner surface, under the pressure: a surface, a node set, or a set of lines; "
        "default: found",
    )
    materials: dict[Name, SetMaterial] = Field(
        min_length=1,
        description="material of each element set or physical group: a name in [materials], or "
        '{ material = "ply", angle = 20.0 }',
    )
    leave_out: tuple[str, ...] = Field(
        (),
        strict=False,
        description="element sets in the file that are no part of the tyre: the rim, the road",
    )

    @property
    def regions(self) -> dict[str, Region]:
        """Every element set with its region, in the order of the table."""
        return {
            name: entry if isinstance(entry, Region) else Region(material=entry)
            for name, entry in self.materials.items()
        }

    def _faults(self) -> Iterator[Fault]:
        for i, name in enumerate(self.leave_out):
            if name in self.materials:
                yield Fault(("leave_out", i), f"'{name}' has a material; give it in one place")


class SectionFile(MeshFile):
    """A section: quadrilaterals in a half plane through the axle, revolved into the cell."""

    kind: Literal["section"] = Field(description="a section, revolved by cell.sector_angle")


class CellFile(MeshFile):
    """One periodic cell: bricks between two faces that match."""

    kind: Literal["cell"] = Field(description="one periodic cell of cell.sector_angle")
    left: str | None = Field(None, description="node set of the cell's left face; default: found")
    right: str | None = Field(None, description="node set of the cell's right face; default: found")
    tolerance: Annotated[float, Quantity(LENGTH, gt=0, le=0.1)] | None = Field(
        None,
        description="how far nodes of the two faces may be apart [m]; default: a small part of "
        "the elements' size",
    )


Mesh = Annotated[
    Annotated[SectionFile, Tag("section")] | Annotated[CellFile, Tag("cell")], by_kind(None)
]
