"""Natural modes: frequency against circumferential order, and shapes on the section."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.plots.places import MM
from tyrefrf.plots.section import element_polygons
from tyrefrf.plots.style import TITLE_WIDTH, house_style, legend_below, plain
from tyrefrf.results.modes import WORDS, Modes

MARKERS = ("o", "^", "s")
"""Mainly radial, lateral, circumferential: told apart without colour."""
N_SHAPES, COLUMNS = 12, 4
VISIBLE = 0.09
"""Largest motion in the drawing, of the section's size."""


def mode_figures(modes: Modes) -> Iterator[tuple[str, Figure]]:
    """Every figure of natural modes with the stem of its file's name."""
    yield "frequency_by_order", order_figure(modes)
    if len(modes.frequency):
        yield "mode_shapes", shapes_figure(modes)


@house_style()
def order_figure(modes: Modes) -> Figure:
    """Every mode's frequency over its order, coloured by its loss factor."""
    figure = Figure(figsize=(9.0, 6.0))
    axes = figure.subplots()
    mainly = np.argmax(modes.motion, axis=1)
    loss = np.nan_to_num(modes.loss_factor)
    scale = Normalize(0.0, max(loss.max(initial=0.0), 1e-12))
    for direction, marker in enumerate(MARKERS):
        here = mainly == direction
        points = axes.scatter(
            modes.order[here],
            modes.frequency[here],
            c=loss[here],
            norm=scale,
            cmap="viridis_r",
            marker=marker,
            edgecolor="0.2",
            linewidth=0.4,
        )
    handles = [
        _entry(f"mainly {word}", marker) for word, marker in zip(WORDS, MARKERS, strict=True)
    ]
    told = modes.diameters != modes.order
    if told.any():
        axes.scatter(
            modes.order[told], modes.frequency[told], s=90, facecolor="none", edgecolor="C1"
        )
        handles.append(_entry("in the cell's planes nearer to another alias than h", "o", "C1"))
    figure.colorbar(points, ax=axes).set_label("loss factor")
    N = modes.provenance.n_cells
    axes.set_title(
        _title(
            modes,
            f"{modes.n_modes} natural modes below {modes.cutoff:.5g} Hz, members of pairs counted\n"
            f"order h of {N} cells stands for n = h, {N} - h, {N} + h, ... nodal diameters",
        )
    )
    axes.set_xlabel("Circumferential order h")
    axes.set_ylabel("Frequency [Hz]")
    axes.set_ylim(bottom=0.0)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    legend_below(figure, handles)
    return figure


@house_style()
def shapes_figure(modes: Modes) -> Figure:
    """The lowest modes' shapes on the section, coloured by the motion around."""
    n = min(N_SHAPES, len(modes.frequency))
    rows = -(-n // COLUMNS)
    figure = Figure(figsize=(11.0, 1.2 + 1.9 * rows))
    panels = figure.subplots(rows, COLUMNS, sharex=True, sharey=True, squeeze=False)
    for number, axes in enumerate(panels.flat):
        if number >= n:
            axes.set_axis_off()
            continue
        elements = _draw_shape(axes, modes.section, modes.section_shape[number])
        h, n_told = modes.order[number], modes.diameters[number]
        alias = "" if n_told == h else f" (n = {n_told})"
        axes.set_title(f"{modes.frequency[number]:.4g} Hz, h = {h}{alias}", fontsize=9)
    for axes in panels[-1]:
        axes.set_xlabel("y [mm]")
    for axes in panels[:, 0]:
        axes.set_ylabel("r [mm]")
    bar = figure.colorbar(elements, ax=list(panels.flat), shrink=0.6)
    bar.set_label("motion around, of the largest motion")
    figure.suptitle(
        _title(modes, f"the {n} lowest natural modes, when they move most in the section"),
        x=0.01,
        ha="left",
    )
    return figure


def _draw_shape(axes: Axes, section: SectionMesh, shape: ComplexArray) -> Collection:
    """One mode (n, 3) over the section at rest; its elements, coloured by |u_theta|.

    Or its nodes, where only those are known.
    """
    largest = np.linalg.norm(shape, axis=1).max() or 1.0
    size = VISIBLE * np.ptp(section.points, axis=0).max() / largest
    points = section.points + size * in_phase(shape[:, :2])
    if not section.n_elements:
        return _draw_nodes(axes, section.points, points, np.abs(shape[:, 2]) / largest)
    at_rest = element_polygons(section, section.points)
    axes.add_collection(
        PolyCollection(list(at_rest), facecolor="none", edgecolor="0.7", linewidth=0.4)
    )
    moved = element_polygons(section, points)
    elements = PolyCollection(list(moved), cmap="YlGnBu", edgecolor="0.3", linewidth=0.3)
    elements.set_array(np.abs(shape[section.quads, 2]).mean(axis=1) / largest)
    elements.set_clim(0.0, 1.0)
    axes.add_collection(elements)
    axes.set_aspect("equal")
    axes.autoscale_view()
    return elements


def _draw_nodes(
    axes: Axes, at_rest: FloatArray, moved: FloatArray, around: FloatArray
) -> Collection:
    """Nodes (n, 2) at rest and moved, these coloured by their motion around (n,)."""
    y, r = MM * at_rest[:, ::-1].T
    axes.scatter(y, r, s=2, color="0.7")
    y, r = MM * moved[:, ::-1].T
    nodes = axes.scatter(y, r, c=around, cmap="YlGnBu", s=8, edgecolor="0.3", linewidth=0.2)
    nodes.set_clim(0.0, 1.0)
    axes.set_aspect("equal")
    return nodes


def in_phase(u: ComplexArray) -> FloatArray:
    """The real motion at the phase at which the sum of its squares is largest."""
    return np.asarray((u * np.exp(-0.5j * np.angle(np.sum(u**2)))).real)


def _entry(label: str, marker: str, edge: str = "0.2") -> Line2D:
    return Line2D(
        [], [], linestyle="none", marker=marker, markerfacecolor="none", color=edge, label=label
    )


def _title(modes: Modes, what: str) -> str:
    """The case's title, its pressure, and below it what the figure shows."""
    state = modes.inflation
    about = f", about the state at {state.pressure / 1e5:.4g} bar" if state is not None else ""
    first, *others = what.splitlines()
    lines = (modes.provenance.title, first + about, *others)
    return "\n".join(fill(plain(line), TITLE_WIDTH) for line in lines)
