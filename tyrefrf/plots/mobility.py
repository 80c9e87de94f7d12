"""The mobilities of one load: magnitude above phase, all probes in one pair of axes."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.mesh.place import REGION, Place
from tyrefrf.plots.measured import draw_measured, magnitudes, measured_of
from tyrefrf.plots.style import (
    DASHES,
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

CURVES = len(DASHES)
"""The most curves in one figure."""


@house_style()
def mobility_figures(results: Results, load: Place) -> list[Figure]:
    """Figures of up to eight probes each, the driving point first and heavier.

    Responses that are zero by symmetry have no curve; the legends name them.
    """
    shown, zero = shown_and_zero(results, load)
    groups = [dict(list(shown.items())[i : i + CURVES]) for i in range(0, len(shown), CURVES)]
    figures = [_figure(results, load, group, zero) for group in groups]
    for number, figure in enumerate(figures, start=1):
        if len(figures) > 1:
            figure.axes[0].set_title(f"{number} of {len(figures)}", loc="right")
    return figures


def shown_and_zero(results: Results, load: Place) -> tuple[dict[Place, ComplexArray], list[Place]]:
    """Mobilities (f,) by probe, the driving point first, and probes that are zero by symmetry.

    The many points of a region are not among them.
    """
    single = [probe for probe in results.probes if probe.kind != REGION]
    probes = sorted(single, key=lambda probe: not is_drive(probe, load))
    response = {probe: results.response(load.name, probe.name) for probe in probes}
    limit = ROUNDING * max(map(_largest, response.values()), default=0.0)
    zero = [probe for probe in probes if _largest(response[probe]) < limit]
    return {probe: Y for probe, Y in response.items() if probe not in zero}, zero


def is_drive(probe: Place, load: Place) -> bool:
    """Whether a probe is the load's own point."""
    return probe.name == f"{load.name}.drive"


def _largest(Y: ComplexArray) -> float:
    """The largest magnitude of the lines that have an answer."""
    return float(np.max(np.abs(Y[~np.isnan(Y)]), initial=0.0))


def _figure(
    results: Results, load: Place, response: dict[Place, ComplexArray], zero: list[Place]
) -> Figure:
    figure = Figure(figsize=(9.0, 6.5))
    magnitude, phase = figure.subplots(2, 1, sharex=True, height_ratios=(2.2, 1.0))
    handles = []
    for index, (probe, Y) in enumerate(response.items()):
        drive = is_drive(probe, load)
        look = curve_style(index) | {"linewidth": 2.4 if drive else 1.2}
        label = plain(probe.label + (" (driving point)" if drive else ""))
        look |= {"label": label, **line_markers(results.frequency)}
        handles += magnitude.plot(results.frequency, positive(np.abs(Y)), **look)
        phase.plot(*wrapped(results.frequency, Y), **look)
    measured = measured_of(results, load.name, {probe.name for probe in (*response, *zero)})
    handles += draw_measured(magnitude, results, measured, lambda f, Y: (f, positive(np.abs(Y))))
    draw_measured(phase, results, measured, wrapped)
    handles += mark_failed(magnitude, results)
    handles += zero_entry([f"{probe.name} ({probe.direction})" for probe in zero])
    set_title(magnitude, results, f"mobility, load {load.label}")
    computed = [np.abs(Y) for Y in response.values()]
    logarithmic(magnitude, computed + magnitudes(results, measured))
    magnitude.set_ylabel("Mobility magnitude [m/(s N)]")
    phase_axes(phase)
    frequency_axis(figure, results.frequency)
    legend_below(figure, handles)
    return figure


def positive(magnitude: FloatArray) -> FloatArray:
    """Zero, as at 0 Hz, has no place on a logarithmic axis."""
    return np.where(magnitude > 0.0, magnitude, np.nan)


def wrapped(frequency: FloatArray, Y: ComplexArray) -> tuple[FloatArray, FloatArray]:
    """Frequency and phase [deg], with a NaN between two lines where the phase wraps around.

    Zero has no phase.
    """
    phase = np.where(Y == 0.0, np.nan, np.degrees(np.angle(Y)))
    wraps = np.flatnonzero(np.abs(np.diff(phase)) > 180.0) + 1
    return np.insert(frequency, wraps, frequency[wraps]), np.insert(phase, wraps, np.nan)


def phase_axes(axes: Axes) -> None:
    """Degrees from -180 to 180."""
    axes.set_ylabel("Phase [deg]")
    axes.set_ylim(-180.0, 180.0)
    axes.set_yticks(np.arange(-180.0, 181.0, 90.0))
