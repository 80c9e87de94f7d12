"""The `[sweep]` table: which values a parameter takes in `tyrefrf sweep` without values."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Discriminator, Field, PlainValidator, Tag, WithJsonSchema

from tyrefrf.case.faults import Fault, refusal, shown
from tyrefrf.case.table import Name, Table

MAX_VALUES = 1000


def _number_or_text(value: object) -> float | str:
    """Take a value as it is written; the parameter that it is for knows its unit and bounds."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise refusal(Fault((), f"{shown(value)} is not a number or text with a unit"))
    if isinstance(value, int | float) and not abs(value) < math.inf:
        raise refusal(Fault((), f"{shown(value)} is not a finite number"))
    return value


Written = Annotated[
    float | str,
    PlainValidator(_number_or_text),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}]}),
]
"""A value as its author wrote it: a bare number in the case's unit, or text with a unit."""


class Range(Table):
    """Values evenly between two ends, both included."""

    range: tuple[Written, ...] = Field(
        strict=False,
        min_length=2,
        max_length=2,
        description="first and last value, bare numbers or with their unit",
    )
    count: int = Field(ge=2, le=MAX_VALUES, description="number of values, both ends included")
    spacing: Literal["linear", "log"] = Field(
        "linear", description="spacing of the values; log needs both ends above 0"
    )


def _form(entry: object) -> str:
    return "range" if isinstance(entry, dict | Range) else "list"


ListOfValues = Annotated[
    tuple[Written, ...], Field(strict=False, min_length=1, max_length=MAX_VALUES)
]
Values = Annotated[
    Annotated[ListOfValues, Tag("list")] | Annotated[Range, Tag("range")], Discriminator(_form)
]
Sweep = dict[Name, Values]
"""Parameters by name, `E_rubber` or "materials.rubber.E", each with its values."""
