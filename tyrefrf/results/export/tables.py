"""CSV that spreadsheets, pandas and MATLAB's readtable take as it is: of lines and of bands.

Comment lines that begin with "#" come first and name case, version, units and what is where; then
one line of column names, all quoted, then numbers with all their digits and a decimal point. A
value that is not there (a line without an answer, a band that the lines do not cover) is an empty
cell. Rows end with CR LF, fields follow RFC 4180. The text is UTF-8; where it is not all ASCII it
begins with a byte order mark, by which Excel knows.

    pandas.read_csv(path, comment="#")

Both tables have a row for every line or band and columns for every response; the parameters of a
sweep are leading columns, its points follow one another. Regions have their rms; the responses of
their many points are in the HDF5, MATLAB and universal files.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray, IntArray
from tyrefrf.results.derived import (
    UNITS,
    Bands,
    Reference,
    band_mean_square,
    bands_of,
    level,
    lines_in,
    regions_of,
    single_probes,
    space_mean_square,
)
from tyrefrf.results.results import Quantity, Results
from tyrefrf.results.sweep import SweepResults

Column = tuple[str, FloatArray | IntArray]
"""A name and its values, one per row."""

CONVENTION = "phasor exp(+i omega t); r y theta local to the probe's own angle; unit force"


def write_responses(path: Path, results: Results | SweepResults, quantity: Quantity) -> None:
    """Every response at every line: real and imaginary part, magnitude and phase.

    Regions: the root of the mean square over the region. Blocked forces follow.
    """
    notes = [f"{quantity} [{UNITS[quantity]}] load -> probe; phase in degrees; {CONVENTION}"]
    notes += [f"load {place.label}" for place in results.loads]
    notes += [f"probe {results.probes[j].label}" for j in single_probes(results.probes)]
    notes += _region_notes(results)
    blocks = [_lines(point, quantity) for point in _points(results)]
    _write(path, results, notes, blocks)


def write_bands(
    path: Path, results: Results | SweepResults, quantity: Quantity, reference: Reference
) -> None:
    """Every response in one-third-octave bands: root mean square and level."""
    notes = [
        f"{quantity} [{UNITS[quantity]}] load -> probe in one-third-octave bands (IEC 61260-1; "
        "base ten): root of the mean of |X|^2 over the band's width; "
        f"level in dB re {reference.name}; {CONVENTION}",
        "empty: the lines do not cover the band or none is in it or one of them has no answer",
        *_region_notes(results),
    ]
    bands = bands_of(results.frequency)
    blocks = [_bands(point, quantity, bands, reference) for point in _points(results)]
    _write(path, results, notes, blocks)


def _points(results: Results | SweepResults) -> tuple[Results, ...]:
    return (results,) if isinstance(results, Results) else results.points


def _region_notes(results: Results | SweepResults) -> list[str]:
    return [
        f"region {name}: root of the mean of |X|^2 over its area; {len(probes)} points"
        for name, probes in regions_of(results.probes).items()
    ]


def _lines(point: Results, quantity: Quantity) -> list[Column]:
    columns: list[Column] = [("frequency [Hz]", point.frequency)]
    response, units = getattr(point, quantity), UNITS[quantity]
    regions = {
        name: np.sqrt(space_mean_square(point, name, quantity)) for name in regions_of(point.probes)
    }
    for i, load in enumerate(point.loads):
        for j in single_probes(point.probes):
            name = f"{quantity} {load.name} -> {point.probes[j].name}"
            columns += _parts(name, units, response[i, j])
        for region, rms in regions.items():
            columns.append((f"{quantity} {load.name} -> {region} rms [{units}]", rms[i]))
        for component, force in zip(point.hub, point.blocked_force[i], strict=True):
            name = f"blocked force {load.name} -> {component}"
            columns += _parts(name, "N m/N" if component.startswith("M") else "N/N", force)
    return columns


def _parts(name: str, units: str, response: ComplexArray) -> list[Column]:
    return [
        (f"{name} real [{units}]", response.real),
        (f"{name} imag [{units}]", response.imag),
        (f"{name} magnitude [{units}]", np.abs(response)),
        (f"{name} phase [deg]", np.degrees(np.angle(response))),
    ]


def _bands(point: Results, quantity: Quantity, bands: Bands, reference: Reference) -> list[Column]:
    columns: list[Column] = [
        ("band [Hz]", bands.nominal),
        ("centre [Hz]", bands.centre),
        ("lower edge [Hz]", bands.lower),
        ("upper edge [Hz]", bands.upper),
        ("lines", lines_in(bands, point.frequency)),
    ]
    square = np.abs(getattr(point, quantity)) ** 2
    regions = {name: space_mean_square(point, name, quantity) for name in regions_of(point.probes)}
    for i, load in enumerate(point.loads):
        single = {point.probes[j].name: square[i, j] for j in single_probes(point.probes)}
        for name, values in [*single.items(), *((n, r[i]) for n, r in regions.items())]:
            mean = band_mean_square(point.frequency, values, bands)
            title = f"{quantity} {load.name} -> {name}"
            columns += [
                (f"{title} rms [{UNITS[quantity]}]", np.sqrt(mean)),
                (f"{title} level [dB]", level(mean, reference)),
            ]
    return columns


def _write(
    path: Path,
    results: Results | SweepResults,
    notes: Iterable[str],
    blocks: Sequence[list[Column]],
) -> None:
    """Comments, column names, and the rows of each block with the parameters before them."""
    lines = [_comment(line) for line in (*_origin(results), *notes)]
    parameters = _parameters(results)
    names = [*(name for name, _ in parameters), *(name for name, _ in blocks[0])]
    encoding = "utf-8" if "".join([*lines, *names]).isascii() else "utf-8-sig"
    with path.open("w", encoding=encoding, newline="") as file:
        file.writelines(f"# {line}\r\n" for line in lines)
        writer = csv.writer(file, quoting=csv.QUOTE_NONNUMERIC)
        writer.writerow(names)
        plain = csv.writer(file)
        for k, block in enumerate(blocks):
            own = [values[k] for _, values in parameters]
            plain.writerows([*own, *row] for row in _rows([values for _, values in block]))


def _origin(results: Results | SweepResults) -> list[str]:
    origin = results.provenance
    return [
        f"{origin.title}; case {origin.case_name}; {origin.case_hash[:12]}",
        f"tyrefrf {origin.version}; solver {origin.solver}; {origin.created}",
    ]


def _parameters(results: Results | SweepResults) -> list[tuple[str, list[float]]]:
    """Columns of a sweep's parameters, one value per point."""
    if isinstance(results, Results):
        return []
    return [
        (f"{axis.name} [{axis.units}]", [axis.values[index[n]] for index in results.indices])
        for n, axis in enumerate(results.axes)
    ]


def _rows(columns: Sequence[FloatArray | IntArray]) -> Iterator[list[float | str]]:
    """Rows of Python's own numbers, of which csv writes every digit; an empty cell for NaN."""
    for row in zip(*(column.tolist() for column in columns), strict=True):
        yield ["" if value != value else value for value in row]


def _comment(text: str) -> str:
    """A comment in one cell: commas would divide it."""
    return text.replace("\N{DEGREE SIGN}", " deg").replace(",", ";")
