"""The figures of a sweep show every point's responses, told apart by the parameter's value."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import synthetic
from matplotlib import colormaps
from matplotlib.colors import to_rgb

from tyrefrf.case.axis import Axis
from tyrefrf.plots import draw_plots
from tyrefrf.plots.sweep import LIGHTEST, sweep_figures
from tyrefrf.results import SweepResults

DRIVE = "mobility_radial_drive"


def modulus(*values: float) -> Axis:
    return Axis("E_rubber", "materials.rubber.E", "Pa", "Young's modulus", values)


def crown(*values: float) -> Axis:
    return Axis("crown", "geometry.thickness.crown", "m", "thickness at mid-tread", values)


ETA = Axis("eta_rubber", "materials.rubber.eta", "1", "loss factor", (0.1, 0.2))


def sweep(*axes: Axis, frequency=synthetic.LINES) -> SweepResults:
    """The synthetic tyre, with a receptance that falls from point to point."""
    made = synthetic.results(frequency)
    n = int(np.prod([len(axis.values) for axis in axes]))
    points = [replace(made, receptance=made.receptance / (1.0 + k)) for k in range(n)]
    return SweepResults(axes, tuple(points), synthetic.PROVENANCE)


def figure_of(made: SweepResults, stem: str = DRIVE):
    return dict(sweep_figures(made))[stem]


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


THREE = modulus(14e6, 28e6, 56e6)


def test_there_is_a_figure_for_every_pair_that_is_not_zero_by_symmetry():
    stems = [stem for stem, _ in sweep_figures(sweep(THREE))]
    assert stems == [
        DRIVE,
        "mobility_radial_shoulder",
        "mobility_radial_sidewall",
        "mobility_radial_far side",
        "mobility_radial_quarter",
        "mobility_radial_liner",
        "mobility_tangential_drive",
        "mobility_tangential_quarter",
        "blocked_force_radial_Fx",
        "blocked_force_tangential_Fz",
        "blocked_force_tangential_My",
    ]


def test_what_moves_at_one_point_only_is_drawn():
    made = sweep(THREE)
    receptance = made.points[2].receptance.copy()
    receptance[0, 7] = 1e-4  # `crown y`
    points = (*made.points[:2], replace(made.points[2], receptance=receptance))
    assert "mobility_radial_crown y" in dict(sweep_figures(replace(made, points=points)))


def test_the_curves_are_the_magnitudes_of_the_points():
    made = sweep(THREE)
    lines = figure_of(made).axes[0].lines
    for line, point in zip(lines, made.points, strict=True):
        np.testing.assert_array_equal(line.get_xdata(), made.frequency)
        expected = np.abs(point.driving_point("radial"))[1:]
        np.testing.assert_array_equal(line.get_ydata()[1:], expected)


def test_the_phase_is_below():
    phase = figure_of(sweep(THREE)).axes[1]
    assert phase.get_ylabel() == "Phase [deg]"
    assert phase.get_ylim() == (-180.0, 180.0)
    assert len(phase.lines) == 3


def test_axes_name_quantity_and_unit_and_the_title_the_pair():
    magnitude, phase = figure_of(sweep(THREE), "mobility_radial_sidewall").axes
    assert magnitude.get_yscale() == "log"
    assert magnitude.get_ylabel() == "Mobility magnitude [m/(s N)]"
    assert phase.get_xlabel() == "Frequency [Hz]"
    assert phase.get_xlim() == (0.0, 2000.0)
    assert magnitude.get_title(loc="left").splitlines() == [
        "A made-up tyre 165/65R13",
        "mobility, load radial: r at outer 0.500, 0°",
        "to sidewall: y at outer 0.150, 0°",
    ]


def test_forces_and_moments_have_their_own_units():
    figures = dict(sweep_figures(sweep(THREE)))
    force, moment = (
        figures[f"blocked_force_tangential_{name}"].axes[0].get_ylabel() for name in ("Fz", "My")
    )
    assert (force, moment) == ("Force magnitude [N/N]", "Moment magnitude [N m/N]")
    line = figures["blocked_force_tangential_My"].axes[0].lines[1]
    expected = np.abs(sweep(THREE).blocked_force[1, 1, 4])
    np.testing.assert_array_equal(line.get_ydata(), expected)


def test_few_values_are_named_with_units_and_differ_in_print():
    figure = figure_of(sweep(THREE))
    assert legend(figure) == ["E_rubber = 14 MPa", "E_rubber = 28 MPa", "E_rubber = 56 MPa"]
    lines = figure.axes[0].lines
    assert len({str(line._unscaled_dash_pattern) for line in lines}) == 3
    assert len(figure.axes) == 2  # no colour bar


def test_colours_are_cividis_from_low_to_high_whatever_the_order():
    lines = figure_of(sweep(modulus(28e6, 56e6, 14e6))).axes[0].lines
    expected = [colormaps["cividis"](share * LIGHTEST) for share in (0.5, 1.0, 0.0)]
    for line, colour in zip(lines, expected, strict=True):
        assert to_rgb(line.get_color()) == pytest.approx(colour[:3], abs=0.01)
    light = [sum(to_rgb(line.get_color())) for line in lines]
    assert light[2] < light[0] < light[1]


def test_many_values_have_a_colour_bar_with_name_and_unit():
    made = sweep(modulus(*np.linspace(10e6, 50e6, 12)))
    figure = figure_of(made)
    bar = figure.axes[-1]
    assert bar.get_ylabel() == "Young's modulus, E_rubber [MPa]"
    assert bar.get_ylim() == (10.0, 50.0)
    assert bar.get_yscale() == "linear"
    assert not figure.legends
    assert len({line.get_linestyle() for line in figure.axes[0].lines}) == 1


def test_many_values_spaced_in_logarithm_have_a_logarithmic_bar():
    bar = figure_of(sweep(modulus(*np.geomspace(1e6, 100e6, 12)))).axes[-1]
    assert bar.get_yscale() == "log"


def test_a_second_parameter_makes_panels():
    made = sweep(THREE, crown(0.012, 0.014))
    figure = figure_of(made)
    assert [axes.get_title(loc="right") for axes in figure.axes] == [
        "crown = 12 mm",
        "crown = 14 mm",
    ]
    assert figure.axes[0].get_ylim() == figure.axes[1].get_ylim()
    for k, axes in enumerate(figure.axes):
        for i, line in enumerate(axes.lines):
            expected = np.abs(made.driving_point("radial")[i, k, 1:])
            np.testing.assert_array_equal(line.get_ydata()[1:], expected)
    assert len(legend(figure)) == 3


def test_more_than_four_panels_make_more_figures():
    made = sweep(THREE, crown(*np.linspace(0.010, 0.014, 5)), frequency=synthetic.LINES[::40])
    figures = {stem: f for stem, f in sweep_figures(made) if stem.startswith(DRIVE)}
    assert list(figures) == [DRIVE, f"{DRIVE}_2"]
    assert [len(figure.axes) for figure in figures.values()] == [4, 1]
    line = figures[f"{DRIVE}_2"].axes[0].lines[1]
    expected = np.abs(made.driving_point("radial")[1, 4, 1:])
    np.testing.assert_array_equal(line.get_ydata()[1:], expected)


def test_a_third_parameter_makes_more_figures_and_is_in_the_title():
    made = sweep(THREE, crown(0.012, 0.014), ETA)
    figures = [f for stem, f in sweep_figures(made) if stem.startswith(DRIVE)]
    titles = [figure.axes[0].get_title(loc="left").splitlines()[-1] for figure in figures]
    assert titles == [f"at its driving point, eta_rubber = {eta}" for eta in (0.1, 0.2)]
    line = figures[1].axes[0].lines[2]
    expected = np.abs(made.driving_point("radial")[2, 0, 1, 1:])
    np.testing.assert_array_equal(line.get_ydata()[1:], expected)


def test_lines_that_failed_at_any_point_have_a_cross():
    made = sweep(THREE)
    points = (synthetic.with_failed(made.points[0], 7), *made.points[1:])
    figure = figure_of(replace(made, points=points))
    assert legend(figure)[-1] == "no answer (1 of 401 lines)"
    assert figure.axes[0].lines[-1].get_xdata().tolist() == [made.frequency[7]]


def test_a_sweep_without_any_answer_can_be_drawn():
    made = sweep(THREE)
    points = tuple(synthetic.with_failed(point, *range(401)) for point in made.points)
    for _, figure in sweep_figures(replace(made, points=points)):
        figure.draw_without_rendering()
        assert figure.axes[0].get_title(loc="left")


def test_every_figure_is_written_and_the_shared_section(tmp_path):
    written = draw_plots(sweep(THREE, frequency=synthetic.LINES[::40]), tmp_path / "plots")
    assert sorted((tmp_path / "plots").iterdir()) == sorted(written)
    assert written[0].name == f"{DRIVE}.png"
    assert "mobility_radial_far_side.png" in [path.name for path in written]
    assert written[-1].name == "section.png"


def test_sections_that_differ_are_not_drawn(tmp_path):
    made = sweep(crown(0.012, 0.014), frequency=synthetic.LINES[::40])
    section = replace(made.points[1].section, points=made.points[1].section.points + 0.001)
    points = (made.points[0], replace(made.points[1], section=section))
    written = draw_plots(replace(made, points=points), tmp_path)
    assert "section.png" not in [path.name for path in written]


def test_a_sweep_without_a_hub_has_figures_of_its_probes():
    made = sweep(THREE)
    points = [replace(p, blocked_force=p.blocked_force[:, :0]) for p in made.points]
    stems = [stem for stem, _ in sweep_figures(replace(made, points=tuple(points)))]
    assert stems
    assert all(stem.startswith("mobility_") for stem in stems)
