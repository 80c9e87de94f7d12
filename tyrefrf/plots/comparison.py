"""Several solvers' mobilities over one another, as the paper's figures 5 and 8, and how far apart.

Curves that agree lie on top of one another: the first is drawn widest and palest, each later one
narrower and dashed, so that all can be seen.
"""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tyrefrf.arrays import BoolArray
from tyrefrf.mesh.place import Place
from tyrefrf.plots.mobility import is_drive, phase_axes, positive, shown_and_zero, wrapped
from tyrefrf.plots.style import (
    TITLE_WIDTH,
    frequency_axis,
    house_style,
    legend_below,
    line_markers,
    logarithmic,
    mark_lines,
    plain,
    set_title,
)
from tyrefrf.results.comparison import Comparison, time_text

PANELS = 4
"""The most responses in one figure."""

COLUMNS = 2

LOOKS: tuple[dict[str, Any], ...] = (
    {"color": "0.7", "linewidth": 6.0, "linestyle": "solid"},
    {"color": "C0", "linewidth": 2.6, "linestyle": "solid"},
    {"color": "C1", "linewidth": 1.7, "linestyle": (0, (4, 3))},
    {"color": "black", "linewidth": 1.0, "linestyle": (0, (1, 4))},
)
"""Of the reference, then of the others in their order."""

EPSILON = float(np.finfo(float).eps)


def comparison_figures(comparison: Comparison) -> Iterator[tuple[str, Figure]]:
    """Every figure with the stem of its file's name; none where no solver has answers."""
    if all(comparison.failure):
        return
    for load in comparison.loads:
        for number, figure in enumerate(overlay_figures(comparison, load), start=1):
            stem = f"comparison_{load.name}"
            yield f"{stem}_{number}" if number > 1 else stem, figure
    if len(comparison.solvers) > 1:
        yield "comparison_difference", difference_figure(comparison)


@house_style()
def overlay_figures(comparison: Comparison, load: Place) -> list[Figure]:
    """Mobilities of all solvers under one load, four responses to a figure.

    Which responses are zero by symmetry, and have no panel, the reference says.
    """
    shown = list(shown_and_zero(comparison.of(comparison.reference), load)[0])
    groups = [shown[i : i + PANELS] for i in range(0, len(shown), PANELS)]
    return [_overlay(comparison, load, group) for group in groups]


def _overlay(comparison: Comparison, load: Place, probes: list[Place]) -> Figure:
    """Magnitude above phase for each probe, in two columns."""
    columns = min(COLUMNS, len(probes))
    rows = -(-len(probes) // columns)
    figure = Figure(figsize=(5.5 * columns + 1.0, 4.6 * rows + 1.0))
    grid = figure.subplots(
        2 * rows, columns, sharex=True, squeeze=False, height_ratios=(2.2, 1.0) * rows
    )
    for index, probe in enumerate(probes):
        row, column = divmod(index, columns)
        panel = grid[2 * row, column], grid[2 * row + 1, column]
        crosses = _panel(comparison, load, probe, *panel)
        panel[0].set_title(f"({chr(ord('a') + index)}) {plain(_named(probe, load))}")
    for unused in grid.T[len(probes) % columns or columns :, -2:].flat:
        unused.remove()
    frequency_axis(figure, comparison.frequency)
    for axes in grid[1::2].flat:
        axes.set_xlabel("Frequency [Hz]")
        axes.tick_params(labelbottom=True)
    looks = _looks(comparison)
    handles = [Line2D([], [], **look, label=_label(comparison, i)) for i, look in looks]
    handles += crosses
    _title(figure, comparison, f"mobility, load {load.label}")
    legend_below(figure, handles)
    return figure


def _panel(
    comparison: Comparison, load: Place, probe: Place, magnitude: Axes, phase: Axes
) -> list[Line2D]:
    """One response of every solver; a legend's handle of the lines without answers."""
    here = comparison.loads.index(load), comparison.probes.index(probe)
    frequency, curves = comparison.frequency, comparison.mobility[:, *here]
    marker = line_markers(frequency)
    for i, look in _looks(comparison):
        magnitude.plot(frequency, positive(np.abs(curves[i])), **look, **marker)
        phase.plot(*wrapped(frequency, curves[i]), **look, **marker)
    logarithmic(magnitude, list(np.abs(curves)))
    magnitude.set_ylabel("Mobility magnitude [m/(s N)]")
    phase_axes(phase)
    return mark_lines(magnitude, frequency, _failed_somewhere(comparison))


def _looks(comparison: Comparison) -> list[tuple[int, dict[str, Any]]]:
    """Number and look of every solver that has answers, the reference first."""
    truth = comparison.solvers.index(comparison.reference)
    order = [truth, *(i for i in range(len(comparison.solvers)) if i != truth)]
    answered = [i for i in order if not comparison.failure[i]]
    return [(i, LOOKS[rank % len(LOOKS)]) for rank, i in enumerate(answered)]


def _label(comparison: Comparison, i: int) -> str:
    """A solver in the legend, with its time."""
    time = time_text(float(np.median(comparison.seconds[i])))
    return f"{comparison.solvers[i]} ({time} per line)"


def _named(probe: Place, load: Place) -> str:
    return f"{probe.label}, driving point" if is_drive(probe, load) else probe.label


def _failed_somewhere(comparison: Comparison) -> BoolArray:
    """(f,) lines that a solver with answers to others has none to."""
    answered = [not why for why in comparison.failure]
    return np.asarray(comparison.failed[answered].any(axis=0))


def _title(figure: Figure, comparison: Comparison, what: str) -> None:
    """The case's title, and below it what the figure shows, above all panels."""
    lines = (comparison.provenance.title, what)
    text = "\n".join(fill(plain(line), TITLE_WIDTH) for line in lines)
    figure.suptitle(text, x=0.01, ha="left", fontsize="medium")


@house_style()
def difference_figure(comparison: Comparison) -> Figure:
    """How far every solver is from the reference, and where rounding alone would be."""
    figure = Figure(figsize=(9.0, 5.4))
    axes = figure.subplots()
    truth = comparison.solvers.index(comparison.reference)
    frequency, samples = comparison.frequency, comparison.frequency[comparison.samples]
    handles = []
    for i, look in _looks(comparison)[1:]:
        name, colour = comparison.solvers[i], look["color"]
        handles += axes.plot(
            frequency,
            positive(comparison.difference[i]),
            color=colour,
            label=f"{name}: responses",
            **line_markers(frequency),
        )
        handles += axes.plot(
            samples,
            positive(comparison.section_error[i, truth]),
            marker="oD^s"[i % 4],
            color=colour,
            markersize=6,
            markerfacecolor="none",
            linestyle="none",
            clip_on=False,
            label=f"{name}: whole sections, the worst",
        )
    name = comparison.reference
    residual = positive(comparison.residual[truth])
    handles += axes.plot(frequency, residual, color="0.6", label=f"residual of {name}")
    handles += [axes.axhline(EPSILON, color="black", linestyle=":", label="rounding of a number")]
    handles += mark_lines(axes, frequency, _failed_somewhere(comparison))
    axes.set_yscale("log")
    axes.set_ylabel(f"Difference to {name}, relative")
    set_title(axes, comparison.of(name), f"difference of the solvers to {name}")
    frequency_axis(figure, frequency)
    legend_below(figure, handles)
    return figure
