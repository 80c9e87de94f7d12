"""The results file, dataset by dataset: the one table that writer and reader share.

Every dataset names its axes; an axis is itself a dataset of that name, an HDF5 dimension scale.
A dataset whose only axis is itself is such a scale.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.mesh.place import Place
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results.results import STRESS, Results, StaticState

PROGRAM = "tyrefrf"

LAYOUT = 1
"""Counts up where an older program would misread a newer file."""

CONVENTIONS = (
    "exp(+i omega t); ISO 7626-1: mobility = i omega receptance, accelerance = -omega^2 receptance;"
    " axle along y, e_r = (cos t, 0, sin t), e_theta = (-sin t, 0, cos t); SI units, angles in rad"
)

Kind = Literal["text", "complex", "float", "int", "bool"]

DTYPES: dict[Kind, Any] = {
    "text": object,
    "complex": np.complex128,
    "float": np.float64,
    "int": np.int64,
    "bool": np.bool_,
}


@dataclass(frozen=True, slots=True)
class Field:
    """One dataset: its path, the paths of its axes, and how it is taken from the results.

    more: attributes of its own, beside units and long_name.
    """

    name: str
    axes: tuple[str, ...]
    kind: Kind
    units: str
    long_name: str
    value: Callable[[Results], ArrayLike]
    more: tuple[tuple[str, str], ...] = ()

    def of(self, results: Results) -> NDArray[Any]:
        """The dataset's array."""
        return np.asarray(self.value(results), dtype=DTYPES[self.kind])

    @property
    def group(self) -> str:
        """The group that the dataset is in; "" for the file's root."""
        return self.name.rpartition("/")[0]

    @property
    def is_scale(self) -> bool:
        """Whether this dataset is itself an axis."""
        return self.axes == (self.name,)


Dataset = tuple[Field, NDArray[Any]]
"""A dataset and its array."""


PLACE_COLUMNS: tuple[tuple[str, Kind, str, str], ...] = (
    ("kind", "text", "", "node, point (interpolated) or patch (disc with uniform traction)"),
    ("surface", "text", "", "outer, inner, or empty for a node on neither"),
    ("s", "float", "1", "fraction of the surface's arc length, 0 at the rim with y < 0"),
    ("r", "float", "m", "distance from the axle"),
    ("y", "float", "m", "position along the axle"),
    ("angle", "float", "rad", "angle around the axle"),
    ("direction", "text", "", "r, y or theta, local to the place's own angle"),
    ("diameter", "float", "m", "diameter of a patch, else 0"),
)
"""What the file holds of a `Place` beside its name, along the axis of the names."""


def _places(axis: str, places: Callable[[Results], tuple[Place, ...]]) -> tuple[Field, ...]:
    """The datasets of the loads or the probes."""

    def column(attribute: str) -> Callable[[Results], ArrayLike]:
        return lambda results: [getattr(place, attribute) for place in places(results)]

    return (
        Field(axis, (axis,), "text", "", f"name of the {axis}", column("name")),
        *(
            Field(f"{axis}_{name}", (axis,), kind, units, f"{axis}: {meaning}", column(name))
            for name, kind, units, meaning in PLACE_COLUMNS
        ),
    )


def _lines(
    name: str, kind: Kind, units: str, long_name: str, value: Callable[[Results], ArrayLike]
) -> Field:
    """What each frequency line has one of."""
    return Field(name, ("frequency",), kind, units, long_name, value)


def _response(name: str, units: str, long_name: str, inner: str = "probe") -> Field:
    """A complex array of the results, per load, per probe or component, and per line."""
    axes = ("load", inner, "frequency")
    return Field(name, axes, "complex", units, long_name, lambda r: getattr(r, name))


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


RESPONSES = (
    _lines("frequency", "float", "Hz", "frequency", lambda r: r.frequency),
    *_places("load", lambda r: r.loads),
    *_places("probe", lambda r: r.probes),
    _response("mobility", "m/(s N)", "velocity per force"),
    _response("receptance", "m/N", "displacement per force"),
    _lines("solved", "bool", "1", "false where a line failed or was fitted", lambda r: r.solved),
    _lines("residual", "float", "1", "||F - D q|| / ||F|| of the ring", lambda r: r.residual),
    _lines("solve_time", "float", "s", "time spent on the line", lambda r: r.solve_time),
    _lines("remark", "text", "", "what was special, or why it failed", lambda r: r.remark),
)

BLOCKED_FORCE = (
    Field("hub", ("hub",), "text", "", "component about the wheel's centre", lambda r: r.hub),
    _response(
        "blocked_force",
        "N/N (Fx, Fy, Fz), N m/N (Mx, My, Mz)",
        "force and moment of the tyre on the blocked hub per unit load",
        inner="hub",
    ),
)
"""In the file only where the case asks for them."""

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

    def of(results: Results) -> ArrayLike:
        assert results.inflation is not None  # `fields_of` saw to it
        return value(results.inflation)

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


def fields(*, with_hub: bool, with_inflation: bool) -> tuple[Field, ...]:
    """Every dataset of a file."""
    hub = BLOCKED_FORCE if with_hub else ()
    return RESPONSES + hub + SECTION + (INFLATION if with_inflation else ())


def fields_of(results: Results) -> tuple[Field, ...]:
    """Every dataset of a file of these results."""
    return fields(with_hub=bool(results.hub), with_inflation=results.inflation is not None)
