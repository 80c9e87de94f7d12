"""From results to a file; h5py is imported when one is written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields as attributes
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefrf.errors import ResultsError
from tyrefrf.results.layout import CONVENTIONS, LAYOUT, PROGRAM, Dataset, Field, Kind, fields_of
from tyrefrf.results.results import Provenance, Results
from tyrefrf.results.sweep import SweepResults
from tyrefrf.results.sweep_layout import sweep_datasets
from tyrefrf.results.whole import whole_file


def write_results(path: str | Path, results: Results) -> None:
    """Write results to an HDF5 file that appears whole or not at all.

    An existing file is replaced. Raises ResultsError where the file cannot be written.
    """
    datasets = [(field, field.of(results)) for field in fields_of(results)]
    _write(Path(path), results.provenance, datasets)


def write_sweep(path: str | Path, sweep: SweepResults) -> None:
    """Write a sweep as `write_results` does a run: the same datasets, parameters leading."""
    _write(Path(path), sweep.provenance, sweep_datasets(sweep))


def _write(path: Path, provenance: Provenance, datasets: Sequence[Dataset]) -> None:
    import h5py

    try:
        with whole_file(path) as temporary, h5py.File(temporary, "x") as file:
            _write_attributes(file, provenance)
            _write_datasets(file, datasets)
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written: {error}") from error


def _write_attributes(file: Any, provenance: Provenance) -> None:
    file.attrs["Conventions"] = CONVENTIONS
    file.attrs["program"] = PROGRAM
    file.attrs["layout"] = LAYOUT
    for attribute in attributes(provenance):
        if attribute.name != "numbers":
            file.attrs[attribute.name] = getattr(provenance, attribute.name)
    file.create_group("numbers").attrs.update(provenance.numbers)


def _write_datasets(file: Any, datasets: Sequence[Dataset]) -> None:
    for field, array in datasets:
        _create(file, field, array)
    for field, _ in datasets:
        for axis, name in enumerate(field.axes):
            if not field.is_scale:
                file[field.name].dims[axis].attach_scale(file[name])


def _create(file: Any, field: Field, array: NDArray[Any]) -> None:
    """Create one dataset, a dimension scale if it is its own axis."""
    dataset = file.create_dataset(field.name, data=array, **_storage(field.kind, array))
    dataset.attrs["units"] = field.units
    dataset.attrs["long_name"] = field.long_name
    dataset.attrs.update(field.more)
    if field.is_scale:
        dataset.make_scale(field.name.rpartition("/")[2])


def _storage(kind: Kind, array: NDArray[Any]) -> dict[str, Any]:
    """How HDF5 stores an array: numbers compressed and checked, in chunks along the last axis."""
    import h5py

    if kind == "text":
        return {"dtype": h5py.string_dtype()}
    if array.size == 0:
        return {}
    chunk = (1,) * (array.ndim - 1) + array.shape[-1:] if kind == "complex" else array.shape
    fill = {"complex": complex(np.nan, np.nan), "float": np.nan}.get(kind)
    return {
        "chunks": chunk,
        "compression": "gzip",
        "shuffle": True,
        "fletcher32": True,
        "fillvalue": fill,
    }
