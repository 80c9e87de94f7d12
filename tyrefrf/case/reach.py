"""The rule that a table of moduli reaches over all frequency lines, and over deflections."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from tyrefrf.case.faults import Fault, number_text
from tyrefrf.case.frequency import Frequency, Hertz
from tyrefrf.case.modulus import TabledModulus
from tyrefrf.case.table import Table
from tyrefrf.errors import Key

AnyTable = TypeVar("AnyTable", bound=Table)


def reach_faults(
    materials: dict[str, Any],
    frequency: object,
    deflections: object = (),
    at: Key = ("materials",),
) -> Iterator[Fault]:
    """Yield the tables of moduli that end short of a line or a deflection, from plain data.

    materials: what has a `modulus`, by name; at: the key of their table.
    """
    lines = _read(Frequency, frequency)
    if lines is None:
        return  # the table's own error says it
    for key, data in _moduli(materials, at):
        modulus = _read(TabledModulus, data)
        if modulus is not None and not modulus.extrapolate:
            message = _short(modulus, lines.lines() + _hertz(deflections))
            if message:
                yield Fault((*key, "frequencies"), message)


def _moduli(materials: dict[str, Any], at: Key) -> Iterator[tuple[Key, object]]:
    """Every `modulus` among the materials, and its place."""
    for name, material in materials.items():
        if isinstance(material, dict):
            yield (*at, name, "modulus"), material.get("modulus")
            rubber = material.get("rubber")
            if isinstance(rubber, dict):
                yield (*at, name, "rubber", "modulus"), rubber.get("modulus")


def _short(modulus: TabledModulus, lines: list[float]) -> str:
    """What is wrong where the first line outside the table is; nothing where all are inside."""
    factor = modulus.shift.factor if modulus.shift else 1.0
    low, high = modulus.frequencies[0], modulus.frequencies[-1]
    outside = [f for f in lines if not low <= f * factor <= high]
    if not outside:
        return ""
    first = outside[0]
    shifted = f", shifted to {number_text(first * factor)} Hz," if modulus.shift else ""
    side = "below" if first * factor < low else "above"
    return (
        f"the frequency line {number_text(first)} Hz{shifted} is {side} the table, which goes from "
        f"{number_text(low)} to {number_text(high)} Hz; add rows, or let extrapolate = true hold "
        "the end values"
    )


def _hertz(data: object) -> list[float]:
    """A list of frequencies from plain data; none where it is not one: its own error says it."""
    try:
        return list(TypeAdapter(tuple[Hertz, ...]).validate_python(data))
    except ValidationError:
        return []


def _read(kind: type[AnyTable], data: object) -> AnyTable | None:
    """A table from plain data, or None where it is not one."""
    try:
        return kind.model_validate(data)
    except ValidationError:
        return None
