"""Frequency responses in universal files: data set 58, ASCII or binary (58b).

Read by pyuff (the extra `uff`), which skips what it does not understand, also a data set that
breaks off; so the file's ends of data sets and numbers of values are counted here.
Source: the format's description, https://www.ceas3.uc.edu/sdrluff/
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.case import Dof, read_bytes
from tyrefrf.case.measured import MOST_BYTES, FRFQuantity
from tyrefrf.errors import ResultsError

FUNCTION, UNITS = 58, 164
FRF, FREQUENCY, FORCE, UNKNOWN = 4, 18, 13, 0
QUANTITIES: dict[int, FRFQuantity] = {8: "receptance", 11: "mobility", 12: "accelerance"}
"""By the ordinate's specific data type: displacement, velocity, acceleration."""

KINDS = {1: "time response", 2: "auto spectrum", 3: "cross spectrum", 4: "FRF", 6: "coherence"}
_MARK = re.compile(rb"    -1(?=[\r\n]| {74}|\Z)")
"""Begins and ends a data set, as pyuff finds it: after binary values, without a line of its own."""


@dataclass(frozen=True, slots=True)
class Record:
    """A data set 58: its number among those of the file, from 1, its line, and what pyuff read."""

    number: int
    line: int
    header: dict[str, Any]

    @property
    def is_frf(self) -> bool:
        """Whether it is a frequency response function."""
        return int(self.header["func_type"]) == FRF

    @property
    def label(self) -> str:
        """What it holds: `2: FRF of 5 z by 1 -x, accelerance`."""
        h = self.header
        kind = KINDS.get(int(h["func_type"]), f"function of type {int(h['func_type'])}")
        what = QUANTITIES.get(int(h["ordinate_spec_data_type"]), "quantity unknown")
        response, reference = (
            f"{int(h[f'{end}_node'])} {_direction(int(h[f'{end}_dir']))}" for end in ("rsp", "ref")
        )
        return f"{self.number}: {kind} of {response} by {reference}, {what}"


def read_uff(
    path: Path, record: int | None, response: Dof | None, reference: Dof | None
) -> tuple[FRFQuantity | None, FloatArray, ComplexArray]:
    """Quantity, where the record says, frequency (f,) [Hz] and response (f,) [SI] of a record.

    Raises ResultsError for what is not so, with what the file holds, OSError for a file that
    cannot be read.
    """
    records, to_si = _records(path)
    chosen = _chosen(path, records, record, response, reference)
    frequency, values = _data(path, chosen)
    return QUANTITIES.get(int(chosen.header["ordinate_spec_data_type"])), frequency, to_si * values


def _records(path: Path) -> tuple[list[Record], float]:
    """All data sets 58, and the factor of responses to SI by the units (164) of the file."""
    uff = _pyuff()
    lines = _set_lines(path, read_bytes(path, MOST_BYTES))
    records: list[Record] = []
    to_si = 1.0
    file = uff.UFF(str(path))
    for k, kind in enumerate(file.get_set_types()):
        if kind not in (FUNCTION, UNITS):
            continue
        try:
            found = file.read_sets(k)
        except Exception as error:  # pyuff raises nothing narrower
            message = f"the data set {kind} that begins here cannot be read: {error}"
            raise ResultsError(f"{path}:{lines[k]}: {message}") from error
        if kind == FUNCTION:
            records.append(Record(len(records) + 1, lines[k], found))
        else:
            to_si = found["force"] / found["length"]
    if not records:
        raise ResultsError(f"{path}: a universal file without a data set 58 (functions)")
    return records, to_si


def _pyuff() -> Any:
    try:
        import pyuff
    except ImportError:
        message = 'universal files need pyuff: `pip install "tyrefrf[uff]"` brings it'
        raise ResultsError(message) from None
    return pyuff


def _set_lines(path: Path, data: bytes) -> list[int]:
    """The line, from 1, at which each data set begins; every one of them has to end."""
    marks = [data.count(b"\n", 0, mark.start()) + 1 for mark in _MARK.finditer(data)]
    if not marks:
        raise ResultsError(f"{path}: not a universal file: no data set begins, by a line of -1")
    if len(marks) % 2:
        message = "the data set that begins here has no end: the file is cut off"
        raise ResultsError(f"{path}:{marks[-1]}: {message}")
    return marks[::2]


def _chosen(
    path: Path,
    records: Sequence[Record],
    number: int | None,
    response: Dof | None,
    reference: Dof | None,
) -> Record:
    """The one record that is meant; without a choice the only frequency response."""
    fitting = [
        record
        for record in records
        if (record.number == number if number is not None else record.is_frf)
        and _is_at(record, "rsp", response)
        and _is_at(record, "ref", reference)
    ]
    if len(fitting) != 1:
        many = f"{len(fitting)} records fit" if fitting else "no record fits"
        held = "; ".join(record.label for record in records)
        raise ResultsError(f"{path}: {many}; name one by record, or response and reference: {held}")
    if not fitting[0].is_frf:
        raise ResultsError(f"{path}: not a frequency response: record {fitting[0].label}")
    return fitting[0]


def _is_at(record: Record, end: str, dof: Dof | None) -> bool:
    """Whether a record's response or reference is at this point and direction."""
    h = record.header
    return dof is None or (int(h[f"{end}_node"]), int(h[f"{end}_dir"])) == (dof.node, dof.code)


def _data(path: Path, record: Record) -> tuple[FloatArray, ComplexArray]:
    """Lines and values of a record, both checked."""
    here, h = f"{path}:{record.line}: record {record.number}", record.header
    f, values, n = np.asarray(h["x"], float), np.asarray(h["data"]), int(h["num_pts"])
    if int(h["abscissa_spec_data_type"]) not in (FREQUENCY, UNKNOWN):
        raise ResultsError(f"{here}: its abscissa is no frequency")
    if int(h["orddenom_spec_data_type"]) not in (FORCE, UNKNOWN):
        raise ResultsError(f"{here}: its reference is no force")
    if not np.iscomplexobj(values):
        raise ResultsError(f"{here}: its values are real; a response has a phase")
    if min(len(f), len(values)) < n or not n:
        found = f"{min(len(f), len(values))} of {n} values"
        raise ResultsError(f"{here}: has {found}: the file is cut off")
    f, values = f[:n], values[:n]
    wrong = np.flatnonzero(~(np.isfinite(f) & np.isfinite(values)))
    if len(wrong):
        raise ResultsError(f"{here}: value {wrong[0] + 1} is not a finite number")
    falls = np.flatnonzero(np.diff(f) <= 0.0)
    if len(falls) or f[0] < 0.0:
        k = int(falls[0]) + 1 if len(falls) else 0
        raise ResultsError(f"{here}: {f[k]:.10g} Hz is out of order; frequencies have to increase")
    return f, values


def _direction(code: int) -> str:
    """A direction's code as the case writes it; rotations and scalars by their numbers."""
    names = get_args(Dof.model_fields["direction"].annotation)
    return names[abs(code) - 1 + (3 if code < 0 else 0)] if 1 <= abs(code) <= 3 else f"({code})"
