"""Measured responses under the computed ones: thin and grey, with markers to tell them apart."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.plots.style import plain
from tyrefrf.results.measured import Measured
from tyrefrf.results.results import Results

MARKERS = "osD^vPX*"
GREYS = ("0.0", "0.45", "0.65")
MARKED = 40
"""So many lines of a curve carry its marker, at most."""


def measured_of(results: Results, load: str, probes: Collection[str]) -> list[Measured]:
    """The measured responses of some probes to a load."""
    return [one for one in results.measured if one.load == load and one.probe in probes]


def shown(results: Results, measured: Measured) -> tuple[FloatArray, ComplexArray]:
    """Frequency [Hz] and mobility of a measured response, within the computed lines."""
    f = measured.frequency
    there = (f >= results.frequency[0]) & (f <= results.frequency[-1])
    return f[there], measured.mobility[there]


def look_of(results: Results, measured: Measured, f: FloatArray) -> dict[str, Any]:
    """How a measured response of lines f (k,) is drawn, the same in every figure of a run."""
    number = next(k for k, one in enumerate(results.measured) if one is measured)
    return {
        "color": GREYS[number % len(GREYS)],
        "linewidth": 0.7,
        "marker": MARKERS[number % len(MARKERS)],
        "markersize": 3.5,
        "markerfacecolor": "white",
        "markeredgewidth": 0.7,
        "markevery": max(1, len(f) // MARKED),
        "zorder": 1.9,
        "label": plain(f"{measured.name}: measured at {measured.probe}"),
    }


def draw_measured(
    axes: Axes,
    results: Results,
    measured: Collection[Measured],
    curve: Callable[[FloatArray, ComplexArray], tuple[FloatArray, FloatArray]],
) -> list[Line2D]:
    """Draw measured responses; curve: from frequency and mobility to x and y."""
    handles: list[Line2D] = []
    for one in measured:
        f, Y = shown(results, one)
        handles += axes.plot(*curve(f, Y), **look_of(results, one, f))
    return handles


def magnitudes(results: Results, measured: Collection[Measured]) -> list[FloatArray]:
    """|Y| of measured responses within the computed lines."""
    return [np.abs(shown(results, one)[1]) for one in measured]
