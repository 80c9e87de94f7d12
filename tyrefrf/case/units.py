"""Quantities: a bare number in SI (angles: degrees), or text with a unit such as "14 mm"."""

from __future__ import annotations

import decimal
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from tyrefrf.case.faults import Fault, did_you_mean, number_text, refusal, shown

Units = Mapping[str, str]
"""A dimension's units and their factors to the first one, the unit of a bare number."""

LENGTH: Units = {"m": "1", "cm": "1e-2", "mm": "1e-3", "um": "1e-6"}
STRESS: Units = {"Pa": "1", "kPa": "1e3", "MPa": "1e6", "GPa": "1e9", "bar": "1e5"}
DENSITY: Units = {"kg/m3": "1", "g/cm3": "1e3", "kg/dm3": "1e3", "t/m3": "1e3"}
ANGLE: Units = {"deg": "1", "rad": "57.2957795130823208768"}  # 180/pi
FREQUENCY: Units = {"Hz": "1", "kHz": "1e3"}
TIME: Units = {"s": "1", "ms": "1e-3", "us": "1e-6"}
RATE: Units = {"1/s": "1"}
MASS: Units = {"kg": "1", "g": "1e-3", "mg": "1e-6"}

_NUMBER = r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]{1,4})?"
_WRITTEN = re.compile(rf"\s*(?P<number>{_NUMBER})\s*(?P<unit>(?![.,_]).*?)\s*", re.DOTALL)
_EXACT = decimal.Context(traps=[])  # "14 mm" is 0.014, not 14 * 0.001; overflow gives infinity

_BOUNDS = {  # JSON schema's word for a bound, what it asks of a number, and ours
    "exclusiveMinimum": (float.__gt__, "above"),
    "minimum": (float.__ge__, "at least"),
    "exclusiveMaximum": (float.__lt__, "below"),
    "maximum": (float.__le__, "at most"),
}


@dataclass(frozen=True, eq=False)
class Quantity:
    """Annotation of a float field that may carry a unit: `Annotated[float, Quantity(...)]`.

    The field's value is in the first unit of `units`; the bounds are in that unit too.
    """

    units: Units
    gt: float | None = None
    ge: float | None = None
    le: float | None = None

    def read(self, value: object) -> float:
        """Return the number in SI (degrees), or raise what is wrong with it."""
        number = self._read_text(value) if isinstance(value, str) else self._read_number(value)
        if not math.isfinite(number):
            raise refusal(Fault((), f"{shown(value)} is not a finite number"))
        for word, limit in self._bounds().items():
            holds, words = _BOUNDS[word]
            if not holds(number, limit):
                raise refusal(Fault((), self._out_of_range(value, words, limit)))
        return number

    @property
    def _unit(self) -> str:
        return next(iter(self.units))

    def _bounds(self) -> dict[str, float]:
        bounds = {"exclusiveMinimum": self.gt, "minimum": self.ge, "maximum": self.le}
        return {word: float(limit) for word, limit in bounds.items() if limit is not None}

    def _read_number(self, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            expected = f"a number [{self._unit}] or text with a unit ({', '.join(self.units)})"
            raise refusal(Fault((), f"{shown(value)} is not {expected}"))
        try:
            return float(value)
        except OverflowError:
            return math.inf

    def _read_text(self, text: str) -> float:
        written = _WRITTEN.fullmatch(text)
        choices = f"use one of {', '.join(self.units)}"
        if written is None:
            raise refusal(Fault((), f"{shown(text)} is not a number with a unit; {choices}"))
        unit = written["unit"]
        if not unit:
            raise refusal(Fault((), f"{shown(text)} has no unit; {choices}"))
        if unit not in self.units:
            hint = did_you_mean(unit, self.units)
            raise refusal(Fault((), f"unknown unit {shown(unit)}; {choices}{hint}"))
        return float(_EXACT.multiply(Decimal(written["number"]), Decimal(self.units[unit])))

    def _out_of_range(self, value: object, words: str, limit: float) -> str:
        found = value if isinstance(value, str) else f"{shown(value)} {self._unit}"
        return f"{found} is out of range; must be {words} {number_text(limit)} {self._unit}"

    def __get_pydantic_core_schema__(
        self, source: type[Any], handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.read, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        units = "|".join(re.escape(unit) for unit in self.units)
        number: dict[str, Any] = {"type": "number", **self._bounds()}
        return {"anyOf": [number, {"type": "string", "pattern": rf"^\s*{_NUMBER}\s*({units})\s*$"}]}


def zero_or_more(least: float, unit: str) -> Callable[[float], float]:
    """What refuses numbers above zero and below the least: slips of the pen near none at all."""

    def accepted(number: float) -> float:
        if 0.0 < number < least:
            limit = f"must be 0 or at least {least:g} {unit}"
            raise refusal(Fault((), f"{number:.6g} {unit} is too near to 0; {limit}"))
        return number

    return accepted


@dataclass(frozen=True, eq=False)
class Level(Quantity):
    """Annotation of a small relative error: a bare number, or decibels such as "0.01 dB".

    x dB change an amplitude by 10^(x/20) - 1 of itself.
    """

    units: Units = field(default_factory=lambda: {"dB": "1"})

    @property
    def _unit(self) -> str:
        return "of the peak"

    def _read_number(self, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise refusal(Fault((), f"{shown(value)} is not a number or text in dB"))
        return super()._read_number(value)

    def _read_text(self, text: str) -> float:
        return math.expm1(super()._read_text(text) * math.log(10.0) / 20.0)
