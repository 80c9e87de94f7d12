"""The file of a run: responses by load, probe and frequency, and the tyre.

The one table that writing and reading share.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefrf.mesh.place import Place
from tyrefrf.results.certificate_layout import CERTIFICATE, certificate_of
from tyrefrf.results.field import Columns, Field, Kind
from tyrefrf.results.file import columns_of, provenance_of
from tyrefrf.results.measured_layout import measured_fields, measured_of, n_measured
from tyrefrf.results.proof import passivity, power, reciprocity
from tyrefrf.results.results import Provenance, Results
from tyrefrf.results.tyre_layout import inflation_of, section_of, tyre_fields

PLACE_COLUMNS: tuple[tuple[str, Kind, str, str], ...] = (
    ("kind", "text", "", "node, point, patch (disc) or region (one of its points)"),
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


DERIVED = ("mobility", "passivity", "power", "reciprocity")
"""In the file for its other readers; results derive them from the receptance again."""

RESPONSES = (
    _lines("frequency", "float", "Hz", "frequency", lambda r: r.frequency),
    *_places("load", lambda r: r.loads),
    *_places("probe", lambda r: r.probes),
    _response("mobility", "m/(s N)", "velocity per force"),
    _response("receptance", "m/N", "displacement per force"),
    _lines(
        "solved",
        "bool",
        "1",
        "false where a line failed, was fitted or is missing",
        lambda r: r.solved,
    ),
    _lines("residual", "float", "1", "||F - D q|| / ||F|| of the ring", lambda r: r.residual),
    Field("passivity", ("load", "frequency"), "float", "1", "Re Y / |Y| where it acts", passivity),
    _lines("power", "float", "1", "smallest eigenvalue of (Y + Y^H)/2 over ||Y||", power),
    _lines("reciprocity", "float", "1", "max |H_ij - H_ji| over ||H||", reciprocity),
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

SENSOR_MASS = Field(
    "probe_sensor_mass",
    ("probe",),
    "float",
    "kg",
    "mass of the accelerometer that the response is seen with",
    lambda results: [place.sensor_mass for place in results.probes],
)
"""In the file only where a probe has one."""


def run_fields(
    *,
    with_hub: bool,
    with_inflation: bool,
    with_certificate: bool = False,
    with_sensors: bool = False,
    n_measured: int = 0,
) -> tuple[Field, ...]:
    """Every dataset of a file."""
    return (
        *RESPONSES,
        *(BLOCKED_FORCE if with_hub else ()),
        *((SENSOR_MASS,) if with_sensors else ()),
        *tyre_fields(with_inflation=with_inflation),
        *(CERTIFICATE if with_certificate else ()),
        *measured_fields(n_measured),
    )


def fields_of(results: Results) -> tuple[Field, ...]:
    """Every dataset of a file of these results."""
    return run_fields(
        with_hub=bool(results.hub),
        with_inflation=results.inflation is not None,
        with_certificate=results.certificate is not None,
        with_sensors=any(place.sensor_mass for place in results.probes),
        n_measured=len(results.measured),
    )


def fields_read(
    file: Any, *, with_inflation: bool, with_certificate: bool = False
) -> tuple[Field, ...]:
    """The datasets that results are read from: what is derived is derived again."""
    table = run_fields(
        with_hub="hub" in file,
        with_inflation=with_inflation,
        with_certificate=with_certificate,
        with_sensors=SENSOR_MASS.name in file,
        n_measured=n_measured(file),
    )
    return tuple(field for field in table if field.name not in DERIVED)


def read_run(file: Any) -> Results:
    """The results that an open file holds."""
    table = fields_read(
        file,
        with_inflation="inflation" in file,
        with_certificate="certificate" in file,
    )
    return results_of(columns_of(file, table), provenance_of(file))


def results_of(columns: Columns, provenance: Provenance) -> Results:
    """Results from the arrays of their fields."""
    loads = _places_of(columns, "load")
    return Results(
        frequency=columns["frequency"],
        loads=loads,
        probes=_places_of(columns, "probe"),
        receptance=columns["receptance"],
        blocked_force=columns.get("blocked_force", _no_blocked_force(columns)),
        solved=columns["solved"],
        residual=columns["residual"],
        solve_time=columns["solve_time"],
        remark=tuple(columns["remark"]),
        section=section_of(columns),
        provenance=provenance,
        inflation=inflation_of(columns),
        certificate=certificate_of(columns),
        measured=measured_of(columns),
    )


def _no_blocked_force(columns: Columns) -> NDArray[Any]:
    return np.empty((len(columns["load"]), 0, len(columns["frequency"])), dtype=np.complex128)


def _places_of(columns: Columns, axis: str) -> tuple[Place, ...]:
    """The places along the load or probe axis, from one dataset per attribute."""
    values = {name: columns[f"{axis}_{name}"].tolist() for name, *_ in PLACE_COLUMNS}
    mass = f"{axis}_sensor_mass"
    if mass in columns:
        values["sensor_mass"] = columns[mass].tolist()
    rows = zip(columns[axis].tolist(), *values.values(), strict=True)
    return tuple(Place(name=name, **dict(zip(values, row, strict=True))) for name, *row in rows)
