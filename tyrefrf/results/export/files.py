"""Which files an export writes, and where.

A run gives one file of a kind; so does a sweep, with the parameters as columns (CSV) or leading
dimensions (MATLAB), but for universal files, which know no parameters: they are one per point.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any, get_args

from tyrefrf.errors import ResultsError
from tyrefrf.results.derived import Reference, reference_of
from tyrefrf.results.export.matlab import write_mat
from tyrefrf.results.export.tables import write_bands, write_responses
from tyrefrf.results.export.uff import write_uff
from tyrefrf.results.results import Quantity, Results, index_of
from tyrefrf.results.sweep import SweepResults
from tyrefrf.results.whole import whole_file

Exported = Results | SweepResults
Task = tuple[Path, Callable[[Path], None]]
"""A file, and what writes it under a temporary name."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is exported: the results, as which quantity, levels relative to what."""

    results: Exported
    quantity: Quantity
    reference: Reference


def _uff(stem: Path, wanted: Wanted) -> Iterator[Task]:
    """A universal file of a run, or one per point of a sweep."""
    results, quantity = wanted.results, wanted.quantity
    if isinstance(results, Results):
        yield _named(stem, ".uff"), partial(write_uff, results=results, quantity=quantity)
        return
    points = zip(results.labels, results.points, strict=True)
    for number, (label, point) in enumerate(points, start=1):
        write = partial(write_uff, results=point, quantity=quantity, point=label)
        yield _named(stem, f"_{number}.uff"), write


def _csv(stem: Path, wanted: Wanted) -> Iterator[Task]:
    """A table of the lines, and one of the bands."""
    results, quantity, reference = wanted.results, wanted.quantity, wanted.reference
    yield _named(stem, ".csv"), partial(write_responses, results=results, quantity=quantity)
    yield (
        _named(stem, "_bands.csv"),
        partial(write_bands, results=results, quantity=quantity, reference=reference),
    )


def _mat(stem: Path, wanted: Wanted) -> Iterator[Task]:
    """One MAT-file with everything."""
    results, quantity, reference = wanted.results, wanted.quantity, wanted.reference
    yield (
        _named(stem, ".mat"),
        partial(write_mat, results=results, quantity=quantity, reference=reference),
    )


FORMATS: dict[str, Callable[[Path, Wanted], Iterator[Task]]] = {
    "uff58": _uff,
    "csv": _csv,
    "mat": _mat,
}
"""The files of each format, by its name."""


def check_formats(formats: Sequence[str]) -> None:
    """Raise ResultsError where a format is unknown, or needs a library that is not there."""
    for form in formats:
        index_of(form, tuple(FORMATS), "format")
    if "uff58" in formats and find_spec("pyuff") is None:
        raise ResultsError('universal files need pyuff; install it: pip install "tyrefrf[uff]"')


def planned_files(
    results: Any, stem: Path, formats: Sequence[str], quantity: Quantity = "mobility"
) -> list[Path]:
    """The files that `export` would write."""
    wanted = _wanted(results, quantity, None)
    return [path for path, _ in _tasks(stem, formats, wanted)]


def export(
    results: Any,
    stem: str | Path,
    formats: Sequence[str],
    quantity: Quantity = "mobility",
    reference: Reference | None = None,
) -> list[Path]:
    """Write responses in formats of `FORMATS`; the files written, in order.

    results: a run's or a sweep's. stem: the files' path without what is after the name;
    "_receptance" or "_accelerance" follows where the quantity is that. reference: of levels in
    the tables of bands; 1 in SI by default. Files of the same names are replaced.
    Raises ResultsError for another kind of results, an unknown format, a library that is not
    there, or a file that cannot be written.
    """
    check_formats(formats)
    wanted = _wanted(results, quantity, reference)
    written = []
    for path, write in _tasks(Path(stem), formats, wanted):
        with whole_file(path, make_directory=True) as temporary:
            write(temporary)
        written.append(path)
    return written


def _wanted(results: Any, quantity: Quantity, reference: Reference | None) -> Wanted:
    if not isinstance(results, Exported):
        kind = type(results).__name__.lower()
        raise ResultsError(f"holds {kind}, no responses; give results of a run or a sweep")
    index_of(quantity, get_args(Quantity), "quantity")
    return Wanted(results, quantity, reference or reference_of(quantity))


def _tasks(stem: Path, formats: Sequence[str], wanted: Wanted) -> Iterator[Task]:
    """Every file of every format, each format once."""
    name = stem.name if wanted.quantity == "mobility" else f"{stem.name}_{wanted.quantity}"
    for form in dict.fromkeys(formats):
        yield from FORMATS[form](stem.with_name(name), wanted)


def _named(stem: Path, end: str) -> Path:
    """The stem's name with an end; a name may have dots."""
    return stem.with_name(stem.name + end)
