"""The figures of a comparison show every solver's own responses, told apart where they agree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import synthetic
from matplotlib.colors import to_hex

from tyrefrf.plots import draw_plots
from tyrefrf.plots.comparison import EPSILON, LOOKS, comparison_figures
from tyrefrf.results import Comparison

SHARES = (1.0, 1.0 + 1e-12, 1.0 - 3e-13, 1.02 * np.exp(0.1j))
SOLVERS = ("recursive", "cyclic", "direct", "modal")


def comparison(frequency=synthetic.LINES, solvers=SOLVERS, failure=None) -> Comparison:
    """The synthetic tyre by up to four solvers that differ by little."""
    made, n = synthetic.results(frequency), len(solvers)
    shares = np.array(SHARES[:n])
    receptance = np.array([share * made.receptance for share in shares])
    samples = np.arange(0, len(frequency), max(1, len(frequency) // 10))
    costs = {name: np.ones(n) for name in ("prepare_seconds", "peak_memory", "base_memory", "disk")}
    return Comparison(
        frequency=made.frequency,
        solvers=solvers,
        loads=made.loads,
        probes=made.probes,
        receptance=receptance,
        seconds=np.outer(0.01 * np.arange(1, n + 1), np.ones(len(frequency))),
        residual=np.full((n, len(frequency)), 2e-13),
        difference=np.outer(np.abs(shares - shares[2 if n > 2 else 0]), np.ones(len(frequency))),
        samples=samples,
        section_error=np.abs(np.subtract.outer(shares, shares))[..., None] * np.ones(len(samples)),
        remark=(("",) * len(frequency),) * n,
        failure=failure or ("",) * n,
        machine={"cores": "2"},
        section=made.section,
        provenance=synthetic.PROVENANCE,
        **costs,
    )


def without_answers(made: Comparison, solver: int, *lines: int) -> Comparison:
    receptance = made.receptance.copy()
    receptance[solver][..., list(lines) or slice(None)] = complex(np.nan, np.nan)
    return replace(made, receptance=receptance)


def figures_of(made):
    return dict(comparison_figures(made))


@pytest.fixture(scope="module")
def made():
    return comparison()


@pytest.fixture(scope="module")
def figures(made):
    return figures_of(made)


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def panel(figure, letter):
    """Magnitude and phase axes of a panel."""
    index = next(
        i for i, axes in enumerate(figure.axes) if axes.get_title("left").startswith(f"({letter})")
    )
    magnitude = figure.axes[index]
    below = [axes for axes in figure.axes if axes.get_ylabel() == "Phase [deg]"]
    left = magnitude.get_subplotspec()
    phase = next(
        axes
        for axes in below
        if axes.get_subplotspec().rowspan.start == left.rowspan.stop
        and axes.get_subplotspec().colspan == left.colspan
    )
    return magnitude, phase


def test_there_is_a_figure_for_each_load_and_one_of_differences(figures):
    assert list(figures) == [
        "comparison_radial",
        "comparison_radial_2",
        "comparison_tangential",
        "comparison_difference",
    ]


def test_the_curves_are_the_results_mobilities_the_reference_first(made, figures):
    magnitude, _ = panel(figures["comparison_radial"], "a")
    assert "driving point" in magnitude.get_title("left")
    drawn = [line.get_ydata() for line in magnitude.lines]
    assert len(drawn) == 4
    for data, solver in zip(drawn, (2, 0, 1, 3), strict=True):  # direct is the reference
        np.testing.assert_array_equal(data[1:], np.abs(made.mobility[solver, 0, 2, 1:]))
        assert np.isnan(data[0])  # 0 Hz has no logarithm


def test_phases_stand_below_their_magnitudes(made, figures):
    magnitude, phase = panel(figures["comparison_radial"], "b")
    assert "shoulder" in magnitude.get_title("left")
    x, y = phase.lines[3].get_data()
    expected = np.degrees(np.angle(made.mobility[3, 0, 0]))
    lines = ~np.isnan(y)
    np.testing.assert_allclose(np.interp(x[lines], made.frequency, expected), y[lines])


def test_curves_that_coincide_differ_in_width_colour_and_dashes(figures):
    magnitude, _ = panel(figures["comparison_radial"], "a")
    widths = [line.get_linewidth() for line in magnitude.lines]
    assert widths == sorted(widths, reverse=True)
    assert len(set(widths)) == len({to_hex(line.get_color()) for line in magnitude.lines}) == 4
    assert [line.get_linestyle() for line in magnitude.lines[2:]] == ["--", "--"]
    assert len(LOOKS) == len(SOLVERS)


def test_the_legend_names_solvers_and_their_times(figures):
    assert legend(figures["comparison_radial"]) == [
        "direct (30 ms per line)",
        "recursive (10 ms per line)",
        "cyclic (20 ms per line)",
        "modal (40 ms per line)",
    ]


def test_the_title_names_case_and_load(figures):
    assert figures["comparison_radial"].get_suptitle().splitlines()[0] == (
        "A made-up tyre 165/65R13"
    )
    assert "load radial" in figures["comparison_radial"].get_suptitle()


def test_responses_that_are_zero_by_symmetry_have_no_panel(figures):
    titles = [axes.get_title("left") for stem in figures for axes in figures[stem].axes]
    assert any("sidewall" in title for title in titles)
    assert not any("crown y" in title for title in titles)


def test_differences_and_rounding_are_drawn_as_they_are(made, figures):
    (axes,) = figures["comparison_difference"].axes
    curves = {str(line.get_label()): line for line in axes.lines}
    np.testing.assert_array_equal(curves["modal: responses"].get_ydata(), made.difference[3])
    sections = curves["cyclic: whole sections, the worst"]
    np.testing.assert_array_equal(sections.get_xdata(), made.frequency[made.samples])
    np.testing.assert_array_equal(sections.get_ydata(), made.section_error[1, 2])
    np.testing.assert_array_equal(curves["residual of direct"].get_ydata(), made.residual[2])
    assert curves["rounding of a number"].get_ydata() == [EPSILON, EPSILON]
    assert axes.get_yscale() == "log"
    assert "direct: responses" not in curves
    assert legend(figures["comparison_difference"]) == list(curves)


def test_rounding_stays_in_sight_beside_a_truncated_solver(figures):
    (axes,) = figures["comparison_difference"].axes
    low, high = axes.get_ylim()
    assert low < EPSILON
    assert high > 0.02


def test_a_solver_without_answers_has_no_curve_and_a_failed_line_a_cross(made):
    dead = without_answers(comparison(failure=("", "", "", "killed")), 3)
    figures = figures_of(without_answers(dead, 0, 7, 8))
    magnitude, _ = panel(figures["comparison_radial"], "a")
    assert legend(figures["comparison_radial"])[1:3] == [
        "recursive (10 ms per line)",
        "cyclic (20 ms per line)",
    ]
    crosses = [line for line in magnitude.lines if line.get_marker() == "x"]
    assert crosses[0].get_xdata().tolist() == made.frequency[[7, 8]].tolist()
    assert legend(figures["comparison_radial"])[3:] == ["no answer (2 of 401 lines)"]
    assert not any("modal" in label for label in legend(figures["comparison_difference"]))


def test_one_solver_alone_has_no_differences():
    assert list(figures_of(comparison(solvers=("cyclic",)))) == [
        "comparison_radial",
        "comparison_radial_2",
        "comparison_tangential",
    ]


def test_nothing_is_drawn_where_no_solver_answered():
    failure = ("killed",) * 4
    none = comparison(failure=failure)
    for solver in range(4):
        none = without_answers(none, solver)
    assert figures_of(none) == {}


def test_few_lines_are_marked_one_by_one():
    figures = figures_of(comparison(synthetic.LINES[1::40]))
    magnitude, _ = panel(figures["comparison_radial"], "a")
    assert {line.get_marker() for line in magnitude.lines} == {"."}


def test_files_are_written_under_their_names(tmp_path):
    made = comparison(synthetic.LINES[::20])
    one = replace(made, loads=made.loads[1:], receptance=made.receptance[:, 1:])
    written = draw_plots(one, tmp_path, ("svg",))
    names = ["comparison_tangential.svg", "comparison_difference.svg"]
    assert [path.name for path in written] == names
    assert all(path.stat().st_size > 1000 for path in written)
