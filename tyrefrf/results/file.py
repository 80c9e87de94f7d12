"""HDF5 files that appear whole, say where they come from, and are refused where damaged.

What a file holds is its attribute `content`; which datasets, that content's own layout. h5py is
imported when a file is opened.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import fields as attributes
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefrf.errors import ResultsError
from tyrefrf.results.field import Columns, Dataset, Field, Kind
from tyrefrf.results.origin import LAYOUT, PROGRAM, check_origin
from tyrefrf.results.results import Provenance
from tyrefrf.results.seal import BLOCK, check_seal, seal
from tyrefrf.results.whole import whole_file

CONVENTIONS = (
    "exp(+i omega t); ISO 7626-1: mobility = i omega receptance, accelerance = -omega^2 receptance;"
    " axle along y, e_r = (cos t, 0, sin t), e_theta = (-sin t, 0, cos t); SI units, angles in rad"
)


def write_file(
    path: str | Path, content: str, provenance: Provenance, datasets: Sequence[Dataset]
) -> None:
    """Write datasets to an HDF5 file that appears whole or not at all.

    content: what the file holds, by which `load_any` knows how to read it. An existing file is
    replaced. Raises ResultsError where the file cannot be written.
    """
    image = file_image(content, provenance, datasets)
    with whole_file(Path(path)) as temporary:
        temporary.write_bytes(image)


def file_image(content: str, provenance: Provenance, datasets: Sequence[Dataset]) -> memoryview:
    """The bytes of the file that `write_file` would write."""
    with hdf5_image(BLOCK) as (file, image):
        file.attrs.update(attributes_of(content, provenance))
        file.create_group("numbers").attrs.update(provenance.numbers)
        _write_datasets(file, datasets)
    seal(image)
    return image.getbuffer()


@contextmanager
def hdf5_image(block: int = 0) -> Iterator[tuple[Any, BytesIO]]:
    """An HDF5 file to be filled, and the memory that it is in; `block` bytes in front are free.

    HDF5 does not survive a full disk: h5py's close fails, and the process ends with a segmentation
    fault (HDF5 2.0, h5py 3.16). A file made in memory is written in one go by Python, which does.
    """
    import h5py

    image = BytesIO()
    with h5py.File(image, "w", userblock_size=block) as file:
        yield file, image


def attributes_of(content: str, provenance: Provenance) -> dict[str, Any]:
    """The attributes of a file's root."""
    origin = {
        attribute.name: getattr(provenance, attribute.name)
        for attribute in attributes(provenance)
        if attribute.name != "numbers"
    }
    known = {"program": PROGRAM, "layout": LAYOUT, "Conventions": CONVENTIONS}
    return {"content": content, **known, **origin}


@contextmanager
def open_file(path: Path, image: bytes | None = None) -> Iterator[Any]:
    """Open a file that `write_file` wrote, to be read; or the image of one that is in it.

    Raises ResultsError for what is no file, no HDF5, damaged, of another program, or of a
    layout newer than this program knows.
    """
    import h5py

    if image is None and not path.is_file():
        raise ResultsError(f"{path}: no such file")
    if image is None:
        check_seal(path)
    if image is None and not h5py.is_hdf5(path):
        raise ResultsError(f"{path}: not an HDF5 file; expected what tyrefrf wrote")
    try:
        with h5py.File(path if image is None else BytesIO(image), "r") as file:
            check_origin(path, file)
            yield file
    except ResultsError:
        raise
    except Exception as error:  # whatever h5py, or the reader, makes of what is not as it should be
        message = f"{path}: truncated or damaged: {error}; run the case again"
        raise ResultsError(message) from error


def columns_of(file: Any, table: Sequence[Field]) -> Columns:
    """The arrays of the fields of an open file."""
    return {field.name: array_of(file[field.name], field.kind) for field in table}


def array_of(dataset: Any, kind: Kind, here: Any = ...) -> NDArray[Any]:
    """A dataset, or a part of it, as an array; text as Python's own."""
    array: NDArray[Any] = (dataset.asstr() if kind == "text" else dataset)[here]
    return array


def provenance_of(file: Any) -> Provenance:
    """Where an open file's results come from."""
    known = {
        attribute.name: plain(file.attrs[attribute.name])
        for attribute in attributes(Provenance)
        if attribute.name != "numbers"
    }
    numbers = {name: plain(value) for name, value in file["numbers"].attrs.items()}
    return Provenance(**known, numbers=numbers)


def plain(value: Any) -> Any:
    """A number of numpy as Python's own."""
    return value.item() if isinstance(value, np.generic) else value


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
