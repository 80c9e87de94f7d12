"""Every figure of a run, as files."""

from __future__ import annotations

import gc
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from tyrefrf.errors import ResultsError
from tyrefrf.plots.comparison import comparison_figures
from tyrefrf.plots.deflection import deflection_figures
from tyrefrf.plots.dispersion import dispersion_figures
from tyrefrf.plots.driving import driving_figures
from tyrefrf.plots.hub import hub_figures
from tyrefrf.plots.inflation import inflation_figures
from tyrefrf.plots.mobility import mobility_figures
from tyrefrf.plots.modes import mode_figures
from tyrefrf.plots.section import section_figure
from tyrefrf.plots.style import house_style
from tyrefrf.plots.sweep import sweep_figures
from tyrefrf.results.comparison import Comparison
from tyrefrf.results.deflection import Deflection
from tyrefrf.results.dispersion import Dispersion
from tyrefrf.results.modes import Modes
from tyrefrf.results.names import file_name, unique
from tyrefrf.results.reader import Content
from tyrefrf.results.results import Results
from tyrefrf.results.sweep import SweepResults
from tyrefrf.results.whole import whole_file

FORMATS = ("png", "pdf", "svg")

FIGURES_HELD = 8
"""Figures after which those that are drawn are let go: their parts hold each other, and Python
would leave them; 60 took 700 MB."""


def draw_plots(
    results: Content | Deflection, directory: str | Path, formats: Sequence[str] = ("png",)
) -> list[Path]:
    """Draw every figure of the results into a directory; the files written, in order.

    results: of any kind that a file may hold, or a deflection. formats: "png", "pdf" or "svg",
    one file of each for every figure; files of the same names are replaced.
    Raises ResultsError for another format or where a file cannot be written.
    """
    return _draw(FIGURES[type(results)](results), directory, formats)


def _draw(
    figures: Iterable[tuple[str, Figure]], directory: str | Path, formats: Sequence[str]
) -> list[Path]:
    """Write figures under the stems of their names, in every format."""
    unknown = sorted(set(formats) - set(FORMATS))
    if unknown:
        message = f"no plots in format {', '.join(unknown)}; there are: {', '.join(FORMATS)}"
        raise ResultsError(message)
    directory = Path(directory)
    written: list[Path] = []
    if not formats:
        return written
    for number, (stem, figure) in enumerate(figures, start=1):
        for form in formats:
            path = directory / f"{stem}.{form}"
            _save(figure, path, form)
            written.append(path)
        if number % FIGURES_HELD == 0:
            gc.collect()
    return written


def _figures_of_run(results: Results) -> Iterator[tuple[str, Figure]]:
    """Every figure with the stem of its file's name."""
    taken: set[str] = set()
    for load in results.loads:
        stem = f"mobility_{file_name(load.name)}"
        for number, figure in enumerate(mobility_figures(results, load), start=1):
            yield unique(f"{stem}_{number}" if number > 1 else stem, taken), figure
    for figure in driving_figures(results):
        yield "driving_points", figure
    for figure in hub_figures(results):
        yield "blocked_force", figure
    for figure in inflation_figures(results):
        yield "inflation", figure
    yield "section", section_figure(results)


def _figures_of_sweep(sweep: SweepResults) -> Iterator[tuple[str, Figure]]:
    """Every figure of a sweep; the section only where it is the same at every point."""
    taken: set[str] = set()
    for stem, figure in sweep_figures(sweep):
        yield unique(file_name(stem), taken), figure
    if sweep.has_one_section:
        yield unique("section", taken), section_figure(sweep.points[0])


def _figures_of_comparison(comparison: Comparison) -> Iterator[tuple[str, Figure]]:
    """Every figure of a comparison."""
    taken: set[str] = set()
    for stem, figure in comparison_figures(comparison):
        yield unique(file_name(stem), taken), figure


FIGURES: dict[type, Callable[[Any], Iterator[tuple[str, Figure]]]] = {
    Results: _figures_of_run,
    SweepResults: _figures_of_sweep,
    Dispersion: dispersion_figures,
    Modes: mode_figures,
    Comparison: _figures_of_comparison,
    Deflection: deflection_figures,
}
"""The figures of each kind of results, with the stems of their files' names."""


def _save(figure: Figure, path: Path, form: str) -> None:
    whole = whole_file(path, make_directory=True)
    with whole as temporary, house_style(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # a box stands for the letter
        figure.savefig(temporary, format=form)
