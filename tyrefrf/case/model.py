"""The case: everything that a run depends on, as plain frozen data.

A `Case` mirrors its file: SI, and angles in degrees. Its lists are tuples; `materials` is a
plain dict (picklable), not to be changed.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, PrivateAttr

from tyrefrf.case.cell import Cell
from tyrefrf.case.cross import cross_faults
from tyrefrf.case.faults import Fault, number_text, refusal, shown
from tyrefrf.case.frequency import Frequency, Hertz
from tyrefrf.case.geometry import Geometry
from tyrefrf.case.inflation import Inflation
from tyrefrf.case.laid import laid_materials
from tyrefrf.case.material import Material
from tyrefrf.case.matrices import Matrices
from tyrefrf.case.measured import MeasuredFile
from tyrefrf.case.mesh import HeldMesh, Mesh
from tyrefrf.case.places import Load, Probe
from tyrefrf.case.solver import Solver
from tyrefrf.case.sweep import Sweep
from tyrefrf.case.table import Name, Table
from tyrefrf.case.units import RATE, TIME, Quantity

DEVICES = {"CON", "PRN", "AUX", "NUL"} | {
    f"{port}{n}" for port in ("COM", "LPT") for n in range(10)
}
"""What Windows takes for devices, whatever the ending."""

PlotFormat = Literal["png", "pdf", "svg"]
ExportFormat = Literal["uff58", "csv", "mat"]


class Damping(Table):
    """Viscous damping in Rayleigh's form, C = alpha M + beta K, beside the loss factors."""

    alpha: Annotated[float, Quantity(RATE, ge=0, le=1e9)] = Field(
        0.0, description="factor of M [1/s]"
    )
    beta: Annotated[float, Quantity(TIME, ge=0, le=1e3)] = Field(0.0, description="factor of K [s]")


class Output(Table):
    """What is written beside the results."""

    plots: tuple[PlotFormat, ...] = Field(
        ("png",), strict=False, description="formats of the plots; an empty list draws none"
    )
    deflections: tuple[Hertz, ...] = Field(
        (),
        strict=False,
        max_length=1000,
        description="run: frequencies [Hz] at which the motion of the whole tyre under every load "
        "is written for ParaView and drawn; they need not be frequency lines",
    )
    export: tuple[ExportFormat, ...] = Field(
        (),
        strict=False,
        description="formats that `tyrefrf run` and `sweep` write the responses in beside the "
        "results: universal file (uff58), csv, MATLAB (mat)",
    )

    def _faults(self) -> Iterator[Fault]:
        listed = {"plots": self.plots, "export": self.export}
        for key, formats in listed.items():
            for i, form in enumerate(formats):
                if form in formats[:i]:
                    yield Fault((key, i), f"'{form}' is listed twice")
        for i, frequency in enumerate(self.deflections):
            if frequency in self.deflections[:i]:
                yield Fault(("deflections", i), f"{number_text(frequency)} Hz is listed twice")


def _portable(name: str) -> str:
    """Refuse names of files that Windows has not."""
    if name.partition(".")[0].upper() in DEVICES or name.endswith("."):
        raise refusal(Fault((), f"{shown(name)} is no file name on Windows; take another"))
    return name


class Case(Table):
    """A tyre, its loads and probes, and what is computed."""

    name: Annotated[str, AfterValidator(_portable)] = Field(
        pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,99}$",
        description="name of the case and its results (default: the file's); up to 100 letters, "
        "digits, '.', '_' and '-', beginning with a letter or digit",
    )
    title: str = Field(
        "", pattern=r"^[^\x00-\x1f\x7f]{0,200}$", description="title of the plots, one line"
    )
    geometry: Geometry | None = Field(
        None,
        description="the section of the tyre; or a mesh from a file, as [mesh], or one cell's "
        "matrices, as [matrices]",
    )
    mesh: Mesh | None = Field(
        None, description="the section of the tyre, or one cell, from a mesh file"
    )
    matrices: Matrices | None = Field(
        None, description="one cell as matrices from files, in place of geometry and materials"
    )
    materials: dict[Name, Material] = Field(
        {}, description="materials by name, as [materials.rubber]; none with [matrices]"
    )
    cell: Cell = Field(description="the angular cell that repeats around the axle")
    frequency: Frequency = Field(description="the frequency lines")
    damping: Damping = Field(Damping(), description="viscous damping")
    inflation: Inflation = Field(Inflation(), description="internal pressure")
    loads: tuple[Load, ...] = Field(
        strict=False, min_length=1, max_length=1000, description="the loads, each as [[loads]]"
    )
    probes: tuple[Probe, ...] = Field(
        (), strict=False, max_length=10_000, description="the probes, each as [[probes]]"
    )
    sensors: Literal["roving", "mounted"] = Field(
        "roving",
        description="sensors with a sensor_mass: roving: one at a time, each seen by its own probe "
        "alone; mounted: all at once, seen by every probe and driving point",
    )
    measured: tuple[MeasuredFile, ...] = Field(
        (), strict=False, max_length=1000, description="measured responses, each as [[measured]]"
    )
    solver: Solver = Field(Solver(), description="how the ring is solved")
    output: Output = Field(Output(), description="what is written beside the results")
    sweep: Sweep = Field(
        {},
        description="values that `tyrefrf sweep --param NAME` takes: a list, or "
        '{ range = [first, last], count = n, spacing = "linear" }',
    )

    _directory: Path = PrivateAttr(default_factory=Path)
    _held_mesh: HeldMesh | None = PrivateAttr(None)

    @property
    def directory(self) -> Path:
        """Where the files that the case names are: beside its own."""
        return self._directory

    def beside(self, directory: Path) -> Self:
        """The same case with its files in another directory; it is no part of the case's data."""
        moved = self.model_copy()
        moved._directory = directory
        return moved

    @property
    def held_mesh(self) -> HeldMesh | None:
        """The mesh in memory that is taken in place of the file of [mesh]."""
        return self._held_mesh

    def holding(self, mesh: HeldMesh | None) -> Self:
        """The same case with a mesh in memory in place of the file of [mesh]."""
        changed = self.model_copy()
        changed._held_mesh = mesh
        return changed

    def with_files_of(self, other: Case) -> Self:
        """The same case with the directory and the mesh in memory of another."""
        return self.beside(other.directory).holding(other.held_mesh)

    @property
    def laid_materials(self) -> dict[str, Material]:
        """[materials], and those that sets of elements lay at an angle of their own."""
        return {**self.materials, **laid_materials(self.materials, self.mesh)}

    def _faults(self) -> Iterator[Fault]:
        yield from cross_faults(self.model_dump())
