"""Free waves: circumferential order above decay, both against frequency."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axes._secondary_axes import SecondaryAxis
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from tyrefrf.arrays import FloatArray
from tyrefrf.plots.style import (
    frequency_axis,
    house_style,
    legend_below,
    mark_lines,
    set_title,
)
from tyrefrf.results.dispersion import NEPER, Dispersion

MOTION = ("mainly radial", "mainly lateral (y)", "mainly circumferential")
FAINTEST = 0.12
"""Opacity of a wave that decays as fast as the bound."""
CLOSED = np.log(10.0) / (2.0 * np.pi)
"""Decay [Np/rad] up to which a wave comes round with a tenth of its amplitude or more."""


@house_style()
def dispersion_figures(dispersion: Dispersion) -> Iterator[tuple[str, Figure]]:
    """The one figure, with the stem of its file's name."""
    yield "dispersion", dispersion_figure(dispersion)


@house_style()
def dispersion_figure(dispersion: Dispersion) -> Figure:
    """Order with what decays strongly drawn faint, and decay; colours tell the motion.

    Circles stand where a wave that comes round meets itself in phase: resonances of the ring.
    """
    figure = Figure(figsize=(9.0, 9.0))
    order, decay = figure.subplots(2, 1, sharex=True, height_ratios=(2.0, 1.0))
    _curves(order, dispersion, dispersion.order, fade=True)
    _curves(decay, dispersion, dispersion.decay, fade=False)
    handles = [Line2D([], [], color=f"C{i}", label=label) for i, label in enumerate(MOTION)]
    handles += _resonances(order, dispersion)
    handles += mark_lines(order, dispersion.frequency, dispersion.failed)
    bound = dispersion.bound * NEPER
    set_title(order, dispersion, f"free waves that decay by up to {bound:.3g} dB/rad")
    _order_axis(order, dispersion)
    _decay_axis(decay, dispersion)
    frequency_axis(figure, dispersion.frequency)
    legend_below(figure, handles)
    return figure


def _curves(axes: Axes, dispersion: Dispersion, y: FloatArray, *, fade: bool) -> None:
    """One line for each branch of y (b, f), coloured and faded from line to line."""
    colours = np.array([to_rgb(f"C{i}") for i in range(len(MOTION))])
    motion = np.argmax(np.nan_to_num(dispersion.share), axis=1)
    for curve, mainly, lost in zip(y, motion, dispersion.decay / dispersion.bound, strict=True):
        there = np.flatnonzero(~np.isnan(curve))
        opacity = 1.0 - (1.0 - FAINTEST) * lost[there] if fade else np.ones(len(there))
        rgba = np.column_stack([colours[mainly[there]], opacity])
        points = np.column_stack([dispersion.frequency[there], curve[there]])
        segments = np.stack([points[:-1], points[1:]], axis=1)
        axes.add_collection(LineCollection(list(segments), colors=rgba[1:], linewidths=1.4))
        if len(points) == 1:
            axes.scatter(points[:, 0], points[:, 1], s=6.0, color=rgba, linewidths=0.0)


def _resonances(axes: Axes, dispersion: Dispersion) -> list[Line2D]:
    """Circles where the order of a weakly decaying wave is an integer; a legend's handle."""
    places = resonances(dispersion)
    if not len(places):
        return []
    label = "resonance: a whole order, under 20 dB lost on a turn"
    return axes.plot(
        places[:, 0],
        places[:, 1],
        "o",
        color="black",
        markersize=5.0,
        markerfacecolor="none",
        label=label,
    )


def resonances(dispersion: Dispersion) -> FloatArray:
    """Frequency and order (k, 2) where a wave that comes round meets itself in phase.

    The order is interpolated between lines; a wave comes round where its decay is below CLOSED.
    """
    places = []
    for order, decay in zip(dispersion.order, dispersion.decay, strict=True):
        weak = decay < CLOSED
        for line in np.flatnonzero(weak[:-1] & weak[1:]):
            a, b = order[line], order[line + 1]
            for n in np.arange(np.ceil(min(a, b)), np.floor(max(a, b)) + 1.0):
                share = (n - a) / (b - a) if b != a else 0.0
                f = dispersion.frequency
                places.append((f[line] + share * (f[line + 1] - f[line]), n))
    return np.array(sorted(set(places))).reshape(-1, 2)


def _order_axis(axes: Axes, dispersion: Dispersion) -> None:
    """Order at the left, wavenumber at the outer radius at the right."""
    low, high = np.nanmin(dispersion.order, initial=0.0), np.nanmax(dispersion.order, initial=1.0)
    axes.set_ylim(float(low) - 0.5, float(high) + 0.5)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True, nbins=16))
    axes.set_ylabel("Circumferential order")
    right = _axis_of(axes, 1.0 / dispersion.radius)
    right.set_ylabel("Wavenumber at the outer radius [rad/m]")


def _decay_axis(axes: Axes, dispersion: Dispersion) -> None:
    """Nepers per radian at the left, decibels at the right."""
    axes.set_ylim(0.0, dispersion.bound)
    axes.set_ylabel("Decay [Np/rad]")
    _axis_of(axes, NEPER).set_ylabel("Decay [dB/rad]")


def _axis_of(axes: Axes, factor: float) -> SecondaryAxis:
    """A second scale at the right, the left one's times a factor."""

    def forth(y: ArrayLike) -> FloatArray:
        return np.asarray(y) * factor

    def back(y: ArrayLike) -> FloatArray:
        return np.asarray(y) / factor

    return axes.secondary_yaxis("right", functions=(forth, back))
