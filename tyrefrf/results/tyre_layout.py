"""The tyre in a results file: the mesh of its section, and its state under pressure.

For whatever is stored with a `section`, and an `inflation` that may be None.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields as attributes
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results.field import Columns, Field, Kind
from tyrefrf.results.results import STRESS, StaticState


def _mesh(
    name: str,
    axes: tuple[str, ...],
    kind: Kind,
    long_name: str,
    value: Callable[[SectionMesh], ArrayLike],
    units: str = "1",
) -> Field:
    """A dataset of the section."""
    paths = tuple(f"section/{axis}" for axis in axes)
    return Field(f"section/{name}", paths, kind, units, long_name, lambda r: value(r.section))


def _numbers(name: str, long_name: str, count: Callable[[SectionMesh], int]) -> Field:
    """An axis of the section that only counts."""
    return _mesh(name, (name,), "int", long_name, lambda section: np.arange(count(section)))


SECTION = (
    _numbers("node", "node number", lambda s: s.n_nodes),
    _numbers("element", "element number", lambda s: s.n_elements),
    _numbers("corner", "node of an element: corners, then mid-sides", lambda s: s.quads.shape[1]),
    _numbers("outer_edge", "edge of the outer surface, from y < 0", lambda s: len(s.outer)),
    _numbers("inner_edge", "edge of the inner surface, from y < 0", lambda s: len(s.inner)),
    _numbers("edge_node", "node of an edge: first, last, mid-side", lambda s: s.outer.shape[1]),
    _mesh("coordinate", ("coordinate",), "text", "coordinate", lambda _: ["r", "y"], ""),
    _mesh("materials", ("materials",), "text", "material names", lambda s: s.materials, ""),
    _mesh("rim", ("rim",), "int", "numbers of the nodes on the rim", lambda s: s.rim),
    _mesh("points", ("node", "coordinate"), "float", "place of a node", lambda s: s.points, "m"),
    _mesh("quads", ("element", "corner"), "int", "node numbers", lambda s: s.quads),
    _mesh("material", ("element",), "int", "index into materials", lambda s: s.material),
    _mesh("outer", ("outer_edge", "edge_node"), "int", "node numbers", lambda s: s.outer),
    _mesh("inner", ("inner_edge", "edge_node"), "int", "node numbers", lambda s: s.inner),
)


def _static(
    name: str,
    axes: tuple[str, ...],
    kind: Kind,
    units: str,
    long_name: str,
    value: Callable[[StaticState], ArrayLike],
) -> Field:
    """A dataset of the inflated state."""

    def of(stored: Any) -> ArrayLike:
        assert stored.inflation is not None  # `tyre_fields` saw to it
        return value(stored.inflation)

    paths = tuple(f"inflation/{axis}" for axis in axes)
    return Field(f"inflation/{name}", paths, kind, units, long_name, of)


INFLATION = (
    _static("node", ("node",), "int", "1", "node of the section", lambda s: _count(s.displacement)),
    _static("element", ("element",), "int", "1", "element", lambda s: _count(s.stress)),
    _static("step", ("step",), "int", "1", "load step", lambda s: _count(s.share)),
    _static("axis", ("axis",), "text", "", "direction", lambda _: ["r", "y", "theta"]),
    _static("along", ("along",), "text", "", "direction in the section", lambda _: ["r", "y"]),
    _static("component", ("component",), "text", "", "of the stress", lambda _: STRESS),
    _static("state", ("state",), "int", "1", "the one state", lambda _: [0]),
    _static("pressure", ("state",), "float", "Pa", "internal pressure", lambda s: [s.pressure]),
    _static(
        "displacement", ("node", "along"), "float", "m", "static shape", lambda s: s.displacement
    ),
    _static("stress", ("element", "component"), "float", "Pa", "mean stress", lambda s: s.stress),
    _static(
        "resultant", ("axis",), "float", "N", "pressure force on one cell", lambda s: s.resultant
    ),
    _static("share", ("step",), "float", "1", "share of the pressure", lambda s: s.share),
    _static("iterations", ("step",), "int", "1", "Newton iterations", lambda s: s.iterations),
    _static("lack", ("step",), "float", "1", "||f - f_int|| / ||f||", lambda s: s.lack),
)
"""In the file only of a tyre under pressure."""


def _count(array: FloatArray) -> IntArray:
    return np.arange(len(array))


def tyre_fields(*, with_inflation: bool) -> tuple[Field, ...]:
    """The datasets of the section, and of the state under pressure where there is one."""
    return SECTION + (INFLATION if with_inflation else ())


def section_of(columns: Columns) -> SectionMesh:
    """The section, read back."""
    mesh: dict[str, Any] = {
        attribute.name: columns[f"section/{attribute.name}"]
        for attribute in attributes(SectionMesh)
        if attribute.name != "numbers"  # of the mesh file: they are not kept
    }
    return SectionMesh(**{**mesh, "materials": tuple(mesh["materials"])})


def inflation_of(columns: Columns) -> StaticState | None:
    """The state under pressure, read back, or none."""
    if "inflation/pressure" not in columns:
        return None
    values: dict[str, Any] = {
        attribute.name: columns[f"inflation/{attribute.name}"]
        for attribute in attributes(StaticState)
    }
    return StaticState(**{**values, "pressure": float(values["pressure"][0])})
