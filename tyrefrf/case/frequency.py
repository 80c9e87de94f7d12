"""Frequency lines: a list, or a linear or logarithmic range."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from tyrefrf.case.faults import Fault
from tyrefrf.case.table import Table
from tyrefrf.case.units import FREQUENCY, Level, Quantity, zero_or_more

MAX_LINES = 1_000_000
MIN_SPACING = 1e-3  # Hz; keeps neighbouring lines apart at 1 MHz
ROUND_OFF = 1e-6  # of a step: how near to `stop` the last line counts as `stop`

Hertz = Annotated[
    float, Quantity(FREQUENCY, ge=0, le=1e6), AfterValidator(zero_or_more(1e-6, "Hz"))
]


class Frequency(Table):
    """The frequency lines: `values`, or a range `start` to `stop` by `step` or `count`."""

    values: Annotated[tuple[Hertz, ...], Field(strict=False, min_length=1)] | None = Field(
        None, max_length=MAX_LINES, description="frequency lines [Hz], increasing"
    )
    start: Hertz = Field(0.0, description="first line of a range [Hz]")
    stop: Hertz | None = Field(None, description="end of a range [Hz]")
    step: Annotated[float, Quantity(FREQUENCY, ge=MIN_SPACING)] | None = Field(
        None, description="distance between the lines of a linear range [Hz]"
    )
    count: int | None = Field(
        None, ge=2, le=MAX_LINES, description="number of lines of a range, both ends included"
    )
    spacing: Literal["linear", "log"] = Field(
        "linear", description="spacing of a range's lines; log needs count and start > 0"
    )

    adaptive: bool = Field(
        False,
        description="solve as many of the lines as a rational fit needs, and fit the others; all "
        "are solved where the fit is not trusted",
    )
    tolerance: Annotated[float, Level(ge=1e-9, le=0.1)] = Field(
        1e-5,
        description="adaptive: error of the fit, of the peak of each load's driving point; or in "
        'decibels at that peak, "0.01 dB"',
    )

    def lines(self) -> list[float]:
        """Return the frequency lines [Hz], increasing; `stop` is one if `step` reaches it."""
        if self.values is not None:
            return list(self.values)
        assert self.stop is not None  # `_faults` saw to it
        n = self._n_lines(self.stop)
        if self.spacing == "log":
            shares = (k / (n - 1) for k in range(n))
            return [self.start ** (1 - share) * self.stop**share for share in shares]
        step = self.step or (self.stop - self.start) / (n - 1)
        lines = [self.start + k * step for k in range(n)]
        if abs(lines[-1] - self.stop) < ROUND_OFF * step:
            lines[-1] = self.stop
        return lines

    def _n_lines(self, stop: float) -> int:
        if self.step is None:
            assert self.count is not None
            return self.count
        return math.floor((stop - self.start) / self.step + ROUND_OFF) + 1

    def _faults(self) -> Iterator[Fault]:
        if self.values is not None:
            yield from self._list_faults(self.values)
        elif self.stop is None:
            yield Fault((), "has no lines; give values = [...], or stop with step or count")
        elif self.stop <= self.start:
            limit = f"must be above start = {self.start:.10g} Hz"
            yield Fault(("stop",), f"{self.stop:.10g} Hz is too small; {limit}")
        else:
            yield from self._range_faults(self.stop)

    def _list_faults(self, values: tuple[float, ...]) -> Iterator[Fault]:
        for key in ("start", "stop", "step", "count", "spacing"):
            if getattr(self, key) != type(self).model_fields[key].default:
                yield Fault((key,), "belongs to a range; values stands alone")
        for i, (before, here) in enumerate(pairwise(values), start=1):
            if here <= before:
                found = f"{here:.10g} Hz after {before:.10g} Hz"
                yield Fault(("values", i), f"{found}; list the lines in increasing order")
                return

    def _range_faults(self, stop: float) -> Iterator[Fault]:
        if self.spacing == "log":
            yield from self._log_faults()
        if self.step is not None and self.count is not None:
            yield Fault(("count",), "not together with step; give one of the two")
        elif self.step is None and self.count is None:
            yield Fault((), "has no step; give step [Hz] or count")
        elif self.step is not None and self.step > (stop - self.start) * (1 + ROUND_OFF):
            limit = f"must be at most stop - start = {stop - self.start:.10g} Hz"
            yield Fault(("step",), f"{self.step:.10g} Hz is too large; {limit}")
        elif self._n_lines(stop) > MAX_LINES:
            found = f"makes {self._n_lines(stop)} lines"
            yield Fault(("step",), f"{found}; must make at most {MAX_LINES}")
        elif (stop - self.start) / (self._n_lines(stop) - 1) < MIN_SPACING / (1 + ROUND_OFF):
            yield Fault(("count",), f"puts lines closer than {MIN_SPACING:g} Hz; use fewer")

    def _log_faults(self) -> Iterator[Fault]:
        if self.start == 0:
            yield Fault(("start",), "0 Hz has no logarithm; must be above 0 Hz")
        if self.step is not None:
            yield Fault(("step",), "belongs to linear spacing; a log range takes count")
