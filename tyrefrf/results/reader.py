"""From a file to results; h5py is imported when one is read."""

from __future__ import annotations

from dataclasses import fields as attributes
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefrf.errors import ResultsError
from tyrefrf.mesh.place import Place
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results.layout import LAYOUT, PLACE_COLUMNS, PROGRAM, Field, fields
from tyrefrf.results.results import Provenance, Results

Columns = dict[str, NDArray[Any]]


def load_results(path: str | Path) -> Results:
    """Read the results that `write_results` wrote.

    Raises ResultsError for what is no file, no HDF5, damaged, of another program, or of a
    layout newer than this program knows.
    """
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


def _read(file: Any) -> Results:
    columns = {field.name: _column(file, field) for field in fields(with_hub="hub" in file)}
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
        provenance=_provenance(file),
    )


def _column(file: Any, field: Field) -> NDArray[Any]:
    dataset = file[field.name]
    array: NDArray[Any] = (dataset.asstr() if field.kind == "text" else dataset)[...]
    return array


def _no_blocked_force(columns: Columns) -> NDArray[Any]:
    return np.empty((len(columns["load"]), 0, len(columns["frequency"])), dtype=np.complex128)


def _places(columns: Columns, axis: str) -> tuple[Place, ...]:
    """The places along the load or probe axis, from one dataset per attribute."""
    values = {name: columns[f"{axis}_{name}"].tolist() for name, *_ in PLACE_COLUMNS}
    rows = zip(columns[axis].tolist(), *values.values(), strict=True)
    return tuple(Place(name=name, **dict(zip(values, row, strict=True))) for name, *row in rows)


def _section(columns: Columns) -> SectionMesh:
    mesh: dict[str, Any] = {
        attribute.name: columns[f"section/{attribute.name}"]
        for attribute in attributes(SectionMesh)
    }
    return SectionMesh(**{**mesh, "materials": tuple(mesh["materials"])})


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
