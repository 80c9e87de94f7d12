"""The mobility figures show the responses, all of them, and nothing else."""

from __future__ import annotations

from dataclasses import replace

import matplotlib as mpl
import numpy as np
import pytest
import synthetic
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from tyrefrf.plots.mobility import mobility_figures
from tyrefrf.results import Results

RADIAL = synthetic.LOADS[0]
DRIVE = "radial.drive: r at outer 0.500, 0° (driving point)"
SHOULDER = "shoulder: r at outer 0.320, 0°"


@pytest.fixture
def made() -> Results:
    return synthetic.results()


def one(results: Results) -> Figure:
    (figure,) = mobility_figures(results, RADIAL)
    return figure


def curve(axes, label):
    (line,) = [line for line in axes.lines if line.get_label() == label]
    return line


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_the_curve_is_the_magnitude_of_the_response(made):
    line = curve(one(made).axes[0], SHOULDER)
    np.testing.assert_array_equal(line.get_xdata(), made.frequency)
    expected = np.abs(made.response("radial", "shoulder"))[1:]
    np.testing.assert_array_equal(line.get_ydata()[1:], expected)


def test_zero_at_0_hz_leaves_the_curve_and_the_log_axis_alone(made):
    magnitude, phase = one(made).axes
    assert made.response("radial", "shoulder")[0] == 0.0
    assert np.isnan(curve(magnitude, SHOULDER).get_ydata()[0])
    assert np.isnan(curve(phase, SHOULDER).get_ydata()[0])
    low, high = magnitude.get_ylim()
    assert 1e-7 < low < 1e-6
    assert 1e-3 < high < 1e-2


def test_the_phase_is_in_degrees_and_breaks_where_it_wraps(made):
    line = curve(one(made).axes[1], "far side: r at outer 0.500, 180°")
    x, y = line.get_xdata(), line.get_ydata()
    expected = np.degrees(np.angle(made.response("radial", "far side")))[1:]
    np.testing.assert_array_equal(y[~np.isnan(y)], expected)
    assert np.nanmax(np.abs(np.diff(y))) <= 180.0
    wraps = np.sum(np.abs(np.diff(expected)) > 180.0)
    assert np.isnan(y).sum() == wraps + 1  # and 0 Hz
    assert len(x) == len(made.frequency) + wraps


def test_axes_name_quantity_and_unit(made):
    magnitude, phase = one(made).axes
    assert magnitude.get_yscale() == "log"
    assert magnitude.get_ylabel() == "Mobility magnitude [m/(s N)]"
    assert phase.get_ylabel() == "Phase [deg]"
    assert phase.get_xlabel() == "Frequency [Hz]"
    assert phase.get_ylim() == (-180.0, 180.0)
    assert phase.get_xlim() == (0.0, 2000.0)
    assert phase.get_xscale() == "linear"


def test_the_title_names_case_and_load(made):
    title = one(made).axes[0].get_title(loc="left")
    assert title == "A made-up tyre 165/65R13\nmobility, load radial: r at outer 0.500, 0°"


def test_the_driving_point_is_first_and_heavier(made):
    figure = one(made)
    first, *others = figure.axes[0].lines
    assert first.get_label() == DRIVE == legend(figure)[0]
    assert first.get_linewidth() > 1.5 * max(line.get_linewidth() for line in others)


def test_curves_differ_in_colour_and_in_dashes(made):
    lines = one(made).axes[0].lines
    assert len({to_hex(line.get_color()) for line in lines}) == len(lines)
    assert len({str(line._unscaled_dash_pattern) for line in lines}) == len(lines)


def test_zeros_by_symmetry_are_named_and_not_drawn(made):
    figure = one(made)
    assert len(figure.axes[0].lines) == 6
    assert legend(figure)[-1] == "zero by symmetry: tangential.drive (theta), crown y (y)"


def test_rounding_is_judged_by_the_largest_response_of_the_load(made):
    factor = np.ones(8)
    factor[0], factor[1] = 1e-6, 1e-10
    quiet = replace(made, receptance=made.receptance * factor[:, None])
    names = legend(one(quiet))
    assert SHOULDER in names
    assert names[-1].replace("\n", " ").startswith("zero by symmetry: sidewall (y)")


def test_failed_lines_are_gaps_with_a_cross(made):
    figure = one(synthetic.with_failed(made, 60, 61, 200))
    magnitude, phase = figure.axes
    assert np.isnan(curve(magnitude, SHOULDER).get_ydata()[[60, 61, 200]]).all()
    assert np.isnan(curve(phase, SHOULDER).get_ydata()).sum() == 4
    crosses = curve(magnitude, "no answer (3 of 401 lines)")
    np.testing.assert_array_equal(crosses.get_xdata(), made.frequency[[60, 61, 200]])
    assert crosses.get_marker() == "x"
    assert "no answer (3 of 401 lines)" in legend(figure)


def test_a_run_without_any_answer_can_be_drawn(made):
    figure = one(synthetic.with_failed(made, *range(401)))
    assert "no answer (401 of 401 lines)" in legend(figure)
    figure.draw_without_rendering()


def test_more_than_eight_curves_are_split_with_the_driving_point_in_the_first():
    probes = tuple(synthetic.place(f"p{i}", i / 20, "r") for i in range(1, 18))
    made = synthetic.results(probes=(*probes, synthetic.PROBES[2]))
    figures = mobility_figures(made, RADIAL)
    assert [len(figure.axes[0].lines) for figure in figures] == [8, 8, 2]
    assert legend(figures[0])[0] == DRIVE
    assert [figure.axes[0].get_title(loc="right") for figure in figures] == [
        "1 of 3",
        "2 of 3",
        "3 of 3",
    ]


def test_logarithmic_lines_get_a_logarithmic_axis():
    axes = one(synthetic.results(np.geomspace(10.0, 3000.0, 200))).axes[1]
    assert axes.get_xscale() == "log"
    assert axes.get_xlim() == pytest.approx((10.0, 3000.0))


def test_narrow_linear_bands_stay_linear():
    axes = one(synthetic.results(np.arange(1000.0, 1100.0, 2.0))).axes[1]
    assert axes.get_xscale() == "linear"


def test_a_single_line_is_a_dot():
    line = curve(one(synthetic.results(np.array([100.0]))).axes[0], SHOULDER)
    assert line.get_marker() == "."


def test_a_name_with_dollars_and_a_leading_underscore_is_text(made):
    load = replace(RADIAL, name="_a$b$")
    drive = replace(made.probes[2], name="_a$b$.drive")
    renamed = replace(made, loads=(load, made.loads[1]), probes=(drive, *made.probes[1:]))
    (figure,) = mobility_figures(renamed, load)
    assert legend(figure)[0].startswith(r"_a\$b\$.drive: r at outer")


def test_the_legend_stays_clear_of_the_axes(made):
    figure = one(made)
    figure.draw_without_rendering()
    below = figure.legends[0].get_window_extent().y1
    assert below <= min(axes.get_tightbbox().y0 for axes in figure.axes)


def test_the_users_matplotlib_settings_change_nothing(made):
    with mpl.rc_context({"axes.labelsize": 30.0, "axes.xmargin": 0.4}):
        assert one(made).axes[0].yaxis.label.get_size() == 10.0
