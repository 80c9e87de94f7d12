"""Measured responses: curves in files of a laboratory, to be held against the computed ones."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import Annotated, Literal

from pydantic import Field, PlainValidator, WithJsonSchema

from tyrefrf.case.faults import Fault, refusal, shown
from tyrefrf.case.table import Name, Table

FRFQuantity = Literal["receptance", "mobility", "accelerance"]
UFF_ENDINGS = (".uff", ".unv", ".uf", ".ufb")
MOST_COLUMNS = 10_000
LEAST_SCALE = 1e-30
MOST_BYTES = 100_000_000  # of a file: a million lines of three columns take 40 MB


def _number_or_header(value: object) -> int | str:
    """A column by its number, from 1, or by the word in the file's header."""
    if isinstance(value, str) and value.strip():
        return value.strip()
    if isinstance(value, bool) or not isinstance(value, int):
        raise refusal(Fault((), f"{shown(value)} is not a column's number or name"))
    if not 1 <= value <= MOST_COLUMNS:
        limit = f"must be from 1 to {MOST_COLUMNS}"
        raise refusal(Fault((), f"{shown(value)} is out of range; {limit}"))
    return value


Column = Annotated[
    int | str,
    PlainValidator(_number_or_header),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "integer", "minimum": 1, "maximum": MOST_COLUMNS},
                {"type": "string", "minLength": 1},
            ]
        }
    ),
]
"""A column of a table in a text file."""


class Columns(Table):
    """Which columns of a CSV file hold what: real and imag, or magnitude or level, and phase."""

    frequency: Column = Field(1, description="column of the frequency [Hz], from 1 or by its name")
    real: Column | None = Field(None, description="column of the real part")
    imag: Column | None = Field(None, description="column of the imaginary part")
    magnitude: Column | None = Field(None, description="column of the magnitude")
    level: Column | None = Field(None, description="column of 20 log10 of the magnitude [dB]")
    phase: Column | None = Field(None, description="column of the phase [deg]")

    @property
    def parts(self) -> tuple[str, str]:
        """The two keys beside `frequency` that are given, in their order here."""
        names = ("real", "imag", "magnitude", "level", "phase")
        first, second = (name for name in names if getattr(self, name) is not None)
        return first, second

    def _faults(self) -> Iterator[Fault]:
        given = {name for name in type(self).model_fields if getattr(self, name) is not None}
        if given - {"frequency"} not in ({"real", "imag"}, {"magnitude", "phase"}, _LEVEL):
            found = ", ".join(sorted(given - {"frequency"})) or "none of them"
            choices = "real and imag, magnitude and phase, or level and phase"
            yield Fault((), f"has {found}; give {choices}")
            return
        taken = [getattr(self, name) for name in ("frequency", *self.parts)]
        if len(set(taken)) < len(taken):
            yield Fault((), "names a column twice; each part of a response has its own")


_LEVEL = {"level", "phase"}


class Dof(Table):
    """A measured point and direction, by the numbers of the laboratory's own model."""

    node: int = Field(ge=0, description="number of the node in the UFF file")
    direction: Literal["x", "y", "z", "-x", "-y", "-z"] = Field(
        description="direction in the UFF file's axes, as there: -x is not x"
    )

    @property
    def code(self) -> int:
        """The direction as data set 58 writes it: 1, 2, 3 or -1, -2, -3."""
        number = "xyz".index(self.direction[-1]) + 1
        return -number if self.direction.startswith("-") else number


class MeasuredFile(Table):
    """A measured frequency response, in a UFF 58 or CSV file, of a load and a probe."""

    file: Annotated[str, Field(pattern=r"^[^\x00-\x1f\x7f]+$")] = Field(
        description="UFF or CSV file, relative to the directory of the case"
    )
    load: Name = Field(description="name of the load that excited the tyre")
    probe: Name = Field(
        description="name of the probe that was measured; the load's own point is <load>.drive"
    )
    name: Name | None = Field(None, description="name in legends (default: that of the file)")
    format: Literal["uff", "csv"] | None = Field(
        None, description="format of the file (default: uff for .uff, .unv, .uf; else csv)"
    )
    record: int | None = Field(
        None, ge=1, description="UFF: number of the record among those of the file, from 1"
    )
    response: Dof | None = Field(None, description="UFF: the record with this response")
    reference: Dof | None = Field(None, description="UFF: the record with this reference")
    quantity: FRFQuantity | None = Field(
        None,
        description="receptance [m/N], mobility [m/(s N)] or accelerance [m/(s^2 N)]; CSV: has to "
        "be given; UFF: given where the record does not say, or says wrongly",
    )
    columns: Columns | None = Field(
        None, description="CSV: columns (default: frequency 1, real 2, imag 3)"
    )
    scale: float = Field(
        1.0, description="factor of the response [-]: -1 for a sensor the other way, or a unit's"
    )

    @property
    def is_uff(self) -> bool:
        """Whether the file is a universal file, by `format` or by its ending."""
        if self.format is not None:
            return self.format == "uff"
        return PurePosixPath(self.file).suffix.lower() in UFF_ENDINGS

    @property
    def label(self) -> str:
        """The curve's name, or the file's with what was chosen of it."""
        chosen = [f"#{self.record}"] if self.record else []
        chosen += [f"{dof.node} {dof.direction}" for dof in (self.response, self.reference) if dof]
        return self.name or " ".join([PurePosixPath(self.file).stem, *chosen])

    def _faults(self) -> Iterator[Fault]:
        if self.is_uff:
            if self.columns is not None:
                yield Fault(("columns",), "belongs to CSV files; this one is a UFF")
            if self.record is not None and (self.response or self.reference):
                yield Fault(("record",), "not together with response or reference")
        else:
            for key in ("record", "response", "reference"):
                if getattr(self, key) is not None:
                    yield Fault((key,), "belongs to UFF files; this one is a CSV")
            if self.quantity is None:
                choices = "receptance, mobility or accelerance"
                yield Fault((), f"has no quantity, which a CSV file does not say; give {choices}")
        if self.scale == 0.0:
            yield Fault(("scale",), "0 leaves nothing of the response")
        elif not LEAST_SCALE <= abs(self.scale) <= 1.0 / LEAST_SCALE:
            limit = f"its size must be from {LEAST_SCALE:g} to {1.0 / LEAST_SCALE:g}"
            yield Fault(("scale",), f"{self.scale:g} is out of range; {limit}")
