"""The driving points: the real part of their mobility, the power that a unit force puts in."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tyrefrf.arrays import ComplexArray
from tyrefrf.plots.measured import draw_measured, measured_of
from tyrefrf.plots.style import (
    curve_style,
    frequency_axis,
    house_style,
    legend_below,
    line_markers,
    mark_failed,
    plain,
    set_title,
)
from tyrefrf.results.results import Results

PASSIVE = 1e-10
"""Re Y below minus this share of |Y| is more than rounding: no passive tyre does that."""


@house_style()
def driving_figures(results: Results) -> list[Figure]:
    """One figure of Re Y at every load's driving point; none where no load has its probe."""
    names = {probe.name for probe in results.probes}
    loads = [load for load in results.loads if f"{load.name}.drive" in names]
    if not loads:
        return []
    figure = Figure(figsize=(9.0, 4.8))
    axes = figure.subplots()
    handles = []
    for index, load in enumerate(loads):
        Y = results.driving_point(load.name)
        look = curve_style(index) | line_markers(results.frequency)
        handles += axes.plot(results.frequency, Y.real, **look, label=plain(load.label))
        handles += _mark_negative(axes, results, Y, load.name)
        measured = measured_of(results, load.name, {f"{load.name}.drive"})
        handles += draw_measured(axes, results, measured, lambda f, Y: (f, Y.real))
    handles += mark_failed(axes, results)
    axes.axhline(0.0, color="0.5", linewidth=0.8)
    set_title(axes, results, "driving points")
    axes.set_ylabel("Re Y [m/(s N)]")
    axes.ticklabel_format(axis="y", scilimits=(-2, 3), useMathText=True)
    frequency_axis(figure, results.frequency)
    legend_below(figure, handles)
    return [figure]


def _mark_negative(axes: Axes, results: Results, Y: ComplexArray, load: str) -> list[Line2D]:
    """Mark the lines at which the tyre would give power."""
    negative = Y.real < -PASSIVE * np.abs(Y)
    if not negative.any():
        return []
    return axes.plot(
        results.frequency[negative],
        Y.real[negative],
        "v",
        color="red",
        zorder=5,
        label=plain(f"{load}: negative at {negative.sum()} lines, not passive"),
    )
