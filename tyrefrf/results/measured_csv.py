"""Frequency responses in text files: columns of numbers under whatever header.

Columns are separated by semicolons, tabs, commas or blanks, whichever a line has first in this
order; between semicolons and tabs, numbers may have a decimal comma. What stands above the first
line of numbers is the header; lines that begin with #, %, ! or // are comments.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.case import Columns, read_bytes
from tyrefrf.case.faults import did_you_mean, shown
from tyrefrf.case.measured import MOST_BYTES
from tyrefrf.errors import ResultsError

DEFAULT = Columns.model_validate({"real": 2, "imag": 3})
COMMENT = ("#", "%", "!", "//")


@dataclass(frozen=True, slots=True)
class Row:
    """A line of the file that is not empty and no comment: its number from 1, and its cells."""

    number: int
    cells: tuple[str, ...]

    @property
    def is_numeric(self) -> bool:
        """Whether all cells are numbers or empty, and some are numbers."""
        numbers = [number_of(cell) for cell in self.cells if cell]
        return bool(numbers) and None not in numbers


def read_csv(path: Path, columns: Columns | None) -> tuple[FloatArray, ComplexArray]:
    """Frequency (f,) [Hz] and response (f,) of a text file.

    Raises ResultsError with the file's line for what is not so, OSError for a file that cannot be
    read.
    """
    columns = columns or DEFAULT
    rows = list(rows_of(_text(read_bytes(path, MOST_BYTES))))
    first = next((n for n, row in enumerate(rows) if row.is_numeric), None)
    if first is None:
        raise ResultsError(f"{path}: has no line of numbers")
    header = rows[first - 1].cells if first else ()
    wanted = [_column(path, getattr(columns, key), header) for key in ("frequency", *columns.parts)]
    table = np.array([_values(path, row, wanted) for row in rows[first:]])
    _increasing(path, rows[first:], table[:, 0])
    return table[:, 0], response_of(columns.parts, table[:, 1], table[:, 2])


def response_of(parts: tuple[str, str], a: FloatArray, b: FloatArray) -> ComplexArray:
    """The complex response (f,) of two columns: `real`, `imag`; `magnitude` or `level`, `phase`."""
    if parts == ("real", "imag"):
        return a + 1j * b
    magnitude = 10.0 ** (a / 20.0) if parts[0] == "level" else a
    return np.asarray(magnitude * np.exp(1j * np.radians(b)))


def rows_of(text: str) -> Iterator[Row]:
    """The lines of a text that hold something, cut into cells."""
    for number, line in enumerate(text.splitlines(), start=1):
        line = line.strip(" \ufeff")
        if line.strip() and not line.startswith(COMMENT):
            yield Row(number, tuple(cell.strip(" \t\"'") for cell in _cut(line)))


def number_of(cell: str) -> float | None:
    """A cell's number, with a decimal point or comma; None where it is none."""
    if "_" in cell:  # Python's own 1_000
        return None
    try:
        return float(cell.replace(",", ".") if cell.count(",") == 1 and "." not in cell else cell)
    except ValueError:
        return None


def _text(data: bytes) -> str:
    """UTF-8, or Latin-1 of older programs, as a header with a degree sign may be."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _cut(line: str) -> Sequence[str]:
    for separator in (";", "\t", ","):
        if separator in line:
            return line.split(separator)
    return re.split(r" +", line.strip())


def _column(path: Path, column: int | str, header: Sequence[str]) -> int:
    """Index from 0 of a column by its number from 1, or by its name in the header."""
    if isinstance(column, int):
        return column - 1
    if column not in header:
        there = ", ".join(filter(None, header)) or "no header above its numbers"
        hint = did_you_mean(column, filter(None, header)) or f"; the file has {there}"
        raise ResultsError(f"{path}: no column {shown(column)}{hint}")
    return list(header).index(column)


def _values(path: Path, row: Row, wanted: Sequence[int]) -> list[float]:
    """The wanted cells of a row as finite numbers."""
    values = []
    for column in wanted:
        cell = row.cells[column] if column < len(row.cells) else ""
        if not cell:
            n = len(row.cells)
            message = f"no column {column + 1}, the line has {n}; wrong columns, or a file cut off"
            raise ResultsError(f"{path}:{row.number}: {message}")
        value = number_of(cell)
        if value is None or not np.isfinite(value):
            message = f"{shown(cell)} in column {column + 1} is not a finite number"
            raise ResultsError(f"{path}:{row.number}: {message}")
        values.append(value)
    return values


def _increasing(path: Path, rows: Sequence[Row], frequency: FloatArray) -> None:
    if frequency[0] < 0.0:
        raise ResultsError(f"{path}:{rows[0].number}: a frequency of {frequency[0]:g} Hz")
    falls = np.flatnonzero(np.diff(frequency) <= 0.0)
    if len(falls):
        k = int(falls[0])
        found = f"{frequency[k + 1]:.10g} Hz after {frequency[k]:.10g} Hz"
        line = rows[k + 1].number
        raise ResultsError(f"{path}:{line}: {found}; frequencies have to increase")
