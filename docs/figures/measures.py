"""What the figures' scripts measure of responses, and the cases that they change."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.case import Case, build_case, load_case, resolved
from tyrefrf.results import Results

CASES = Path(__file__).parents[2] / "cases" / "paper"


def case_of(number: int, **changes: Mapping[str, object]) -> Case:
    """The case of a figure with other keys in some of its tables, solved by `cyclic`.

    That gives the digits of `recursive` in less time: docs/validation/accuracy.md. In place of
    400 lines and more, as many are solved as the curves need.
    """
    data = resolved(load_case(CASES / f"figure{number:02d}.toml"))
    data["solver"] = {"name": "cyclic"}
    data["frequency"]["adaptive"] = True
    for table, values in changes.items():
        data[table] = {**data.get(table, {}), **values}
    return build_case(data, data["name"])


def decibels(Y: ComplexArray) -> FloatArray:
    """Levels of mobilities [dB re 1 m/(s N)]."""
    return 20.0 * np.log10(np.abs(Y))


def level(results: Results, probe: str, low: float, high: float, load: str = "radial") -> float:
    """Mean level [dB] of a mobility over the lines in a band [Hz]."""
    return float(decibels(results.response(load, probe)[lines(results, low, high)]).mean())


def lines(results: Results, low: float, high: float) -> np.ndarray:
    """Which lines are in a band [Hz]; that at 0 Hz has no level."""
    f = results.frequency
    return (f >= low) & (f <= high) & (f > 0.0)


def first_peak(results: Results, load: str = "radial") -> float:
    """Frequency [Hz] of the driving point's first resonance, by a parabola through three lines."""
    f, Y = results.frequency[1:], decibels(results.driving_point(load)[1:])
    k = int(np.flatnonzero((Y[1:-1] > Y[:-2]) & (Y[1:-1] >= Y[2:]))[0]) + 1
    curve = np.polynomial.Polynomial.fit(f[k - 1 : k + 2], Y[k - 1 : k + 2], 2)
    return float(curve.deriv().roots()[0].real)
