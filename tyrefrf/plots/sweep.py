"""A sweep's responses over one another: a curve for every value of the first parameter.

One figure for each load with each probe. A second parameter makes panels, more of them figures.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray
from tyrefrf.case.axis import Axis
from tyrefrf.plots.hub import UNITS, components
from tyrefrf.plots.mobility import is_drive, phase_axes, positive, shown_and_zero, wrapped
from tyrefrf.plots.style import (
    DASHES,
    frequency_axis,
    house_style,
    is_logarithmic,
    legend_below,
    line_markers,
    logarithmic,
    mark_lines,
    plain,
    set_title,
)
from tyrefrf.results.sweep import SweepResults

LIGHTEST = 0.85
"""Of the colour scale from 0 to 1: beyond it, yellow is lost on white paper."""

PANELS = 4
"""The most panels in one figure."""


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """What one figure shows, at all points.

    stem: of the file's name. what: in words. quantity: on the axis, with its unit.
    response: (..., f).
    """

    stem: str
    what: str
    quantity: str
    response: ComplexArray


def sweep_figures(sweep: SweepResults) -> Iterator[tuple[str, Figure]]:
    """Every figure with the stem of its file's name; none for what is zero by symmetry."""
    for pair in _pairs(sweep):
        for number, figure in enumerate(pair_figures(sweep, pair), start=1):
            yield f"{pair.stem}_{number}" if number > 1 else pair.stem, figure


def _pairs(sweep: SweepResults) -> Iterator[Pair]:
    """Every load with every probe and hub component that answers it at any point."""
    for load in sweep.loads:
        moving = {p.name for point in sweep.points for p in shown_and_zero(point, load)[0]}
        for probe in sorted(sweep.probes, key=lambda probe: not is_drive(probe, load)):
            if probe.name not in moving:
                continue
            drive = is_drive(probe, load)
            to = "at its driving point" if drive else f"to {probe.label}"
            yield Pair(
                stem=f"mobility_{load.name}_{'drive' if drive else probe.name}",
                what=f"mobility, load {load.label}\n{to}",
                quantity="Mobility magnitude [m/(s N)]",
                response=sweep.response(load.name, probe.name),
            )
    if not sweep.hub:
        return
    carried = {name for point in sweep.points for name in components(point)[0]}
    for i, load in enumerate(sweep.loads):
        for j, name in enumerate(sweep.hub):
            if f"{load.name}: {name}" in carried:
                kind = "Force" if name[0] == "F" else "Moment"
                yield Pair(
                    stem=f"blocked_force_{load.name}_{name}",
                    what=f"blocked hub, {name} per unit load\nload {load.label}",
                    quantity=f"{kind} magnitude [{UNITS[name[0]]}]",
                    response=sweep.blocked_force[..., i, j, :],
                )


def pair_figures(sweep: SweepResults, pair: Pair) -> list[Figure]:
    """One figure; with more than four values of a second parameter, or with a third, several."""
    colour, *others = sweep.axes
    if not others:
        return [_alone(sweep, pair, colour)]
    panel, *rest = others
    figures = []
    for where in product(*(range(len(axis.values)) for axis in rest)):
        for first in range(0, len(panel.values), PANELS):
            panels = range(first, min(first + PANELS, len(panel.values)))
            figures.append(_panelled(sweep, pair, panels, where))
    return figures


@house_style()
def _alone(sweep: SweepResults, pair: Pair, axis: Axis) -> Figure:
    """Magnitude above phase."""
    figure = Figure(figsize=(9.0, 6.5))
    magnitude, phase = figure.subplots(2, 1, sharex=True, height_ratios=(2.2, 1.0))
    for look, Y in zip(_looks(sweep, axis), pair.response, strict=True):
        magnitude.plot(sweep.frequency, positive(np.abs(Y)), **look)
        phase.plot(*wrapped(sweep.frequency, Y), **look)
    phase_axes(phase)
    _finish(figure, sweep, pair, [magnitude], pair.response, sweep.failed, "")
    return figure


@house_style()
def _panelled(sweep: SweepResults, pair: Pair, panels: range, where: tuple[int, ...]) -> Figure:
    """Magnitudes alone, a panel for every value of the second parameter."""
    colour, panel, *rest = sweep.axes
    here: tuple[Any, ...] = (slice(None), slice(panels.start, panels.stop), *where)
    response, failed = pair.response[here], sweep.failed[here]
    figure = Figure(figsize=(9.0, 1.5 + 2.4 * len(panels)))
    all_axes = figure.subplots(len(panels), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    for k, (index, axes) in enumerate(zip(panels, all_axes, strict=True)):
        for look, Y in zip(_looks(sweep, colour), response[:, k], strict=True):
            axes.plot(sweep.frequency, positive(np.abs(Y)), **look)
        axes.set_title(plain(panel.label(index)), loc="right")
    at = ", ".join(axis.label(i) for axis, i in zip(rest, where, strict=True))
    _finish(figure, sweep, pair, list(all_axes), response, failed, at)
    return figure


def _finish(
    figure: Figure,
    sweep: SweepResults,
    pair: Pair,
    magnitudes: Sequence[Axes],
    response: ComplexArray,
    failed: BoolArray,
    at: str,
) -> None:
    """Title, axes, crosses where lines failed, and what the colours mean."""
    set_title(magnitudes[0], sweep, f"{pair.what}{f', {at}' if at else ''}")
    for axes in magnitudes:
        axes.set_ylabel(
            pair.quantity if len(magnitudes) < 3 else pair.quantity.replace(" [", "\n[")
        )
    logarithmic(magnitudes[0], list(np.abs(response).reshape(-1, len(sweep.frequency))))
    for axes in magnitudes[1:]:
        axes.set_yscale("log", nonpositive="mask")
        axes.set_ylim(magnitudes[0].get_ylim())
    frequency_axis(figure, sweep.frequency)
    any_failed: BoolArray = np.asarray(failed.reshape(-1, failed.shape[-1]).any(axis=0))
    handles = mark_lines(magnitudes[0], sweep.frequency, any_failed)
    axis = sweep.axes[0]
    if _few(axis):
        handles = [Line2D([], [], **look) for look in _looks(sweep, axis)] + handles
    else:
        unit, size = axis.scale
        label = plain(f"{axis.meaning}, {axis.name}") + ("" if unit == "1" else f" [{unit}]")
        norm = _norm(np.array(axis.values) / size)
        colours = ScalarMappable(norm, _colours())
        bar = figure.colorbar(colours, ax=figure.axes, label=label, pad=0.01, **_ticks(norm))
        bar.ax.yaxis.set_minor_formatter(NullFormatter())
    if handles:
        legend_below(figure, handles)


def _looks(sweep: SweepResults, axis: Axis) -> list[dict[str, Any]]:
    """How the curve of every value is drawn: by rank and dashed if few, else by value."""
    n, values = len(axis.values), np.array(axis.values) / axis.scale[1]
    rank = np.argsort(np.argsort(values))
    shares = rank / max(n - 1, 1) if _few(axis) else np.asarray(_norm(values)(values))
    marker = line_markers(sweep.frequency)
    return [
        {
            "color": _colours()(float(share)),
            "linestyle": DASHES[i] if _few(axis) else "solid",
            "linewidth": 1.4 if _few(axis) else 1.0,
            "label": plain(axis.label(i)),
            **marker,
        }
        for i, share in enumerate(shares)
    ]


def _few(axis: Axis) -> bool:
    """Whether a legend can name every value."""
    return len(axis.values) <= len(DASHES)


def _colours() -> Colormap:
    """Cividis: perceptually uniform, also to eyes that see no red or no green."""
    return ListedColormap(colormaps["cividis"](np.linspace(0.0, LIGHTEST, 256)))


def _ticks(norm: Normalize) -> dict[str, Any]:
    """Plain numbers along a logarithmic colour bar."""
    if not isinstance(norm, LogNorm):
        return {}
    return {"ticks": LogLocator(subs=(1.0, 2.0, 5.0)), "format": StrMethodFormatter("{x:g}")}


def _norm(values: FloatArray) -> Normalize:
    """Colours along the values, or along their logarithms if these are the more even."""
    kind = LogNorm if is_logarithmic(np.sort(values)) else Normalize
    return kind(float(values.min()), float(values.max()))
