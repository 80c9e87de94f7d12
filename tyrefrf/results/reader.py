"""From a file to results; h5py is imported when one is read."""

from __future__ import annotations

from dataclasses import fields as attributes
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefrf.case.axis import Axis
from tyrefrf.errors import ResultsError
from tyrefrf.mesh.place import Place
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results.layout import LAYOUT, PLACE_COLUMNS, PROGRAM, Field, fields
from tyrefrf.results.results import Provenance, Results, StaticState
from tyrefrf.results.sweep import SweepResults
from tyrefrf.results.sweep_layout import POINT, has_group, stored_name

Columns = dict[str, NDArray[Any]]


def load_results(path: str | Path) -> Results:
    """Read the results that `write_results` wrote.

    Raises ResultsError for what is no file, no HDF5, damaged, of another program, or of a
    layout newer than this program knows; and for a sweep.
    """
    results = load_any(path)
    if isinstance(results, SweepResults):
        raise ResultsError(f"{path}: a sweep; read it with load_sweep")
    return results


def load_sweep(path: str | Path) -> SweepResults:
    """Read the sweep that `write_sweep` wrote. Raises ResultsError as `load_results`."""
    results = load_any(path)
    if isinstance(results, Results):
        raise ResultsError(f"{path}: a single run; read it with load_results")
    return results


def load_any(path: str | Path) -> Results | SweepResults:
    """Read the results of a run or of a sweep. Raises ResultsError as `load_results`."""
    import h5py

    path = Path(path)
    if not path.is_file():
        raise ResultsError(f"{path}: no such file")
    if not h5py.is_hdf5(path):
        raise ResultsError(f"{path}: not an HDF5 file; expected what `tyrefrf run` wrote")
    try:
        with h5py.File(path, "r") as file:
            _check_origin(path, file)
            return _read(file)
    except (OSError, KeyError, RuntimeError, ValueError) as error:
        message = f"{path}: truncated or damaged: {error}; run the case again"
        raise ResultsError(message) from error


def _check_origin(path: Path, file: Any) -> None:
    program = file.attrs.get("program", "an unknown program")
    if program != PROGRAM:
        raise ResultsError(f"{path}: HDF5 of {program}; expected results of tyrefrf")
    layout, version = file.attrs["layout"], file.attrs["version"]
    if layout > LAYOUT:
        raise ResultsError(
            f"{path}: layout {layout}, written by tyrefrf {version}; this tyrefrf reads layouts"
            f" up to {LAYOUT}: upgrade it with `pip install --upgrade tyrefrf`"
        )


def _read(file: Any) -> Results | SweepResults:
    axes = _axes(file)
    provenance = _provenance(file)
    if not axes:
        return _results(_columns(file, ()), provenance)
    shape = tuple(len(axis.values) for axis in axes)
    points = [
        _results(_columns(file, point), _provenance_at(file, point))
        for point in product(*map(range, shape))
    ]
    return SweepResults(axes, tuple(points), provenance)


def _axes(file: Any) -> tuple[Axis, ...]:
    """The parameters of a sweep, or none: what leads a run's own dimensions."""
    mobility = file["mobility"]
    return tuple(_axis(mobility.dims[n][0]) for n in range(mobility.ndim - 3))


def _axis(scale: Any) -> Axis:
    return Axis(
        name=scale.attrs["parameter"],
        place=scale.attrs["place"],
        units=scale.attrs["units"],
        meaning=scale.attrs["long_name"],
        values=tuple(scale[...].tolist()),
    )


def _columns(file: Any, point: tuple[int, ...]) -> Columns:
    """Every array of a run (point is ()), or of a point of a sweep."""
    table = fields(with_hub="hub" in file, with_inflation=has_group(file, "inflation", point))
    return {field.name: _column(file, field, point) for field in table}


def _results(columns: Columns, provenance: Provenance) -> Results:
    loads = _places(columns, "load")
    return Results(
        frequency=columns["frequency"],
        loads=loads,
        probes=_places(columns, "probe"),
        receptance=columns["receptance"],
        blocked_force=columns.get("blocked_force", _no_blocked_force(columns)),
        solved=columns["solved"],
        residual=columns["residual"],
        solve_time=columns["solve_time"],
        remark=tuple(columns["remark"]),
        section=_section(columns),
        provenance=provenance,
        inflation=_static_state(columns),
    )


def _column(file: Any, field: Field, point: tuple[int, ...]) -> NDArray[Any]:
    dataset = file[stored_name(file, field, point)]
    here = point if dataset.ndim > len(field.axes) else ...
    array: NDArray[Any] = (dataset.asstr() if field.kind == "text" else dataset)[here]
    return array


def _no_blocked_force(columns: Columns) -> NDArray[Any]:
    return np.empty((len(columns["load"]), 0, len(columns["frequency"])), dtype=np.complex128)


def _places(columns: Columns, axis: str) -> tuple[Place, ...]:
    """The places along the load or probe axis, from one dataset per attribute."""
    values = {name: columns[f"{axis}_{name}"].tolist() for name, *_ in PLACE_COLUMNS}
    rows = zip(columns[axis].tolist(), *values.values(), strict=True)
    return tuple(Place(name=name, **dict(zip(values, row, strict=True))) for name, *row in rows)


def _static_state(columns: Columns) -> StaticState | None:
    if "inflation/pressure" not in columns:
        return None
    values: dict[str, Any] = {
        attribute.name: columns[f"inflation/{attribute.name}"]
        for attribute in attributes(StaticState)
    }
    return StaticState(**{**values, "pressure": float(values["pressure"][0])})


def _section(columns: Columns) -> SectionMesh:
    mesh: dict[str, Any] = {
        attribute.name: columns[f"section/{attribute.name}"]
        for attribute in attributes(SectionMesh)
    }
    return SectionMesh(**{**mesh, "materials": tuple(mesh["materials"])})


def _provenance_at(file: Any, point: tuple[int, ...]) -> Provenance:
    """The case's provenance with what is the point's own."""
    known = {attribute.name for attribute in attributes(Provenance)}
    own = {name: _value(dataset, point) for name, dataset in file[POINT].items()}
    numbers = {name: value for name, value in own.items() if name not in known}
    changed = {name: value for name, value in own.items() if name in known}
    return replace(_provenance(file), numbers=numbers, **changed)


def _value(dataset: Any, point: tuple[int, ...]) -> Any:
    """One value of a dataset, as Python's own type."""
    value = dataset[point]
    return value.decode() if isinstance(value, bytes) else _plain(value)


def _provenance(file: Any) -> Provenance:
    known = {
        attribute.name: _plain(file.attrs[attribute.name])
        for attribute in attributes(Provenance)
        if attribute.name != "numbers"
    }
    numbers = {name: _plain(value) for name, value in file["numbers"].attrs.items()}
    return Provenance(**known, numbers=numbers)


def _plain(value: Any) -> Any:
    """A number of numpy as Python's own."""
    return value.item() if isinstance(value, np.generic) else value
