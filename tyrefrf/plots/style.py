"""How every figure looks: colours, line styles, axes, legends."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from textwrap import fill
from typing import Any, Protocol

import numpy as np
from matplotlib import style
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

from tyrefrf.arrays import BoolArray, FloatArray
from tyrefrf.results.results import Provenance, Results

RC: dict[str, Any] = {
    "font.size": 10.0,
    "axes.titlesize": 11.0,
    "axes.titlelocation": "left",
    "legend.fontsize": 9.0,
    "legend.frameon": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "0.85",
    "grid.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 1.2,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 150,
    "pdf.fonttype": 42,
}

DASHES: tuple[Any, ...] = (
    "solid",
    (0, (6, 2)),
    (0, (1.5, 1.5)),
    (0, (7, 2, 1.5, 2)),
    (0, (3, 1.2)),
    (0, (7, 2, 1.5, 2, 1.5, 2)),
    (0, (12, 3)),
    (0, (1, 3.5)),
)
"""As many as curves in a figure: they stay apart in black and white."""

ROUNDING = 1e-9
"""Below this share of the largest, a response is zero by symmetry and the rest is rounding."""

LEGEND_ROW = 0.2  # height [inch]
LEGEND_COLUMNS = 2
LEGEND_WIDTH = 56  # characters in a column
TITLE_WIDTH = 90  # characters

FEW_LINES = 30
"""So few frequency lines are marked one by one."""


@contextmanager
def house_style() -> Iterator[None]:
    """Draw in the house style, whatever the user's matplotlibrc says; also a decorator."""
    with style.context(["petroff10", RC], after_reset=True):
        yield


def curve_style(index: int) -> dict[str, Any]:
    """Colour and dashes of the index-th curve."""
    return {"color": f"C{index % 10}", "linestyle": DASHES[index % len(DASHES)]}


def line_markers(frequency: FloatArray) -> dict[str, Any]:
    """Markers where a curve has so few lines that it could be mistaken for a continuous one."""
    return {"marker": "." if len(frequency) <= FEW_LINES else ""}


def plain(text: str) -> str:
    """A user's text in a figure: a dollar sign starts no formula."""
    return text.replace("$", r"\$")


class OfACase(Protocol):
    """Results of any kind: they know the case that they come from."""

    @property
    def provenance(self) -> Provenance:
        """Where they come from."""
        ...


def set_title(axes: Axes, results: OfACase, what: str) -> None:
    """The case's title, and below it what the figure shows."""
    lines = (results.provenance.title, *what.splitlines())
    axes.set_title("\n".join(fill(plain(line), TITLE_WIDTH) for line in lines))


def is_logarithmic(frequency: FloatArray) -> bool:
    """Whether the lines are more even on a logarithmic axis than on a linear one."""
    if len(frequency) < 3 or frequency[0] <= 0.0:
        return False
    return _unevenness(np.log(frequency)) < _unevenness(frequency)


def _unevenness(x: FloatArray) -> float:
    steps = np.diff(x)
    return float(np.ptp(steps) / np.mean(steps))


def frequency_axis(figure: Figure, frequency: FloatArray) -> None:
    """Hertz along every panel, over exactly the lines' range; logarithmic if the lines are."""
    for axes in figure.axes:
        if is_logarithmic(frequency):
            axes.set_xscale("log")
            axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axes.xaxis.set_major_formatter("{x:g}")
            axes.xaxis.set_minor_formatter(NullFormatter())
        if len(frequency) > 1:
            axes.set_xlim(frequency[0], frequency[-1])
    figure.axes[-1].set_xlabel("Frequency [Hz]")


def logarithmic(axes: Axes, curves: Iterable[FloatArray]) -> None:
    """A logarithmic y axis around the positive values of all curves, without rounding noise."""
    values = np.concatenate([np.empty(0), *curves])
    values = values[values > 0.0]
    if len(values):
        top = values.max()
        axes.set_yscale("log", nonpositive="mask")
        axes.set_ylim(max(values.min(), top * ROUNDING) / 1.5, top * 1.5)


def mark_failed(axes: Axes, results: Results) -> list[Line2D]:
    """A cross on the frequency axis for every line without an answer; a legend's handle."""
    return mark_lines(axes, results.frequency, results.failed)


def mark_lines(axes: Axes, frequency: FloatArray, failed: BoolArray) -> list[Line2D]:
    """The same for lines (f,) of which some failed (f,)."""
    if not failed.any():
        return []
    return axes.plot(
        frequency[failed],
        np.zeros(failed.sum()),
        "x",
        color="black",
        markersize=6,
        clip_on=False,
        zorder=5,
        transform=axes.get_xaxis_transform(),
        label=f"no answer ({failed.sum()} of {len(frequency)} lines)",
    )


def zero_entry(names: Sequence[str]) -> list[Line2D]:
    """A legend's entry that names what is zero by symmetry."""
    if not names:
        return []
    label = f"zero by symmetry: {plain(', '.join(names))}"
    return [Line2D([], [], linestyle="none", label=label)]


def legend_below(figure: Figure, handles: Sequence[Artist]) -> None:
    """A legend under the axes, for which the figure grows."""
    labels = [fill(str(handle.get_label()), LEGEND_WIDTH) for handle in handles]
    rows = sum(label.count("\n") + 1 for label in labels) / LEGEND_COLUMNS + 1
    width, height = figure.get_size_inches()
    figure.set_size_inches(width, height + rows * LEGEND_ROW)
    figure.legend(handles, labels, loc="outside lower center", ncols=LEGEND_COLUMNS)
