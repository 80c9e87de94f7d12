"""What reaches the wheel: force and moment on the blocked hub per unit load."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tyrefrf.arrays import FloatArray
from tyrefrf.plots.style import (
    ROUNDING,
    curve_style,
    frequency_axis,
    house_style,
    legend_below,
    line_markers,
    logarithmic,
    mark_failed,
    plain,
    set_title,
    zero_entry,
)
from tyrefrf.results.results import Results

UNITS = {"F": "N/N", "M": "N m/N"}


@house_style()
def hub_figures(results: Results) -> list[Figure]:
    """One figure of magnitudes, forces above moments; none where the case asks for no hub.

    Components that are zero by symmetry have no curve; the legend names them.
    """
    if not results.hub:
        return []
    curves, zero = components(results)
    figure = Figure(figsize=(9.0, 6.5))
    panels = dict(zip("FM", figure.subplots(2, 1, sharex=True), strict=True))
    handles = []
    for index, (name, magnitude) in enumerate(curves.items()):
        look = curve_style(index) | line_markers(results.frequency)
        axes = panels[name[-2]]
        handles += axes.plot(results.frequency, magnitude, **look, label=plain(name))
    handles += mark_failed(panels["F"], results) + zero_entry(zero)
    for kind, axes in panels.items():
        _decorate(axes, kind, [Y for name, Y in curves.items() if name[-2] == kind])
    set_title(panels["F"], results, "blocked hub, per unit load")
    frequency_axis(figure, results.frequency)
    legend_below(figure, handles)
    return [figure]


def components(results: Results) -> tuple[dict[str, FloatArray], list[str]]:
    """Magnitudes (f,) by "load: component", and the names of those that are zero by symmetry.

    A moment is compared with a force at the tyre's outer radius: all moments of a load may be
    zero, or all forces.
    """
    radius = float(results.section.points[:, 0].max())
    arm = np.array([1.0, 1.0, 1.0, radius, radius, radius])
    curves: dict[str, FloatArray] = {}
    zero = []
    for load, components in zip(results.loads, np.abs(results.blocked_force), strict=True):
        largest = np.max(components[:, ~results.failed], axis=1, initial=0.0) / arm
        rounding = largest < ROUNDING * largest.max()
        names = np.array(results.hub)
        for name, magnitude in zip(names[~rounding], components[~rounding], strict=True):
            curves[f"{load.name}: {name}"] = magnitude
        if rounding.any():
            zero.append(f"{load.name}: {' '.join(names[rounding])}")
    return curves, zero


def _decorate(axes: Axes, kind: str, curves: list[FloatArray]) -> None:
    axes.set_ylabel(f"{'Force' if kind == 'F' else 'Moment'} magnitude [{UNITS[kind]}]")
    if curves:
        logarithmic(axes, curves)
    else:
        axes.set_yticks([])
        axes.text(0.5, 0.5, "all zero by symmetry", ha="center", transform=axes.transAxes)
