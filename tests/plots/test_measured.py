"""Measured responses lie under the computed curves, as they were measured."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import synthetic

from tyrefrf.plots.driving import driving_figures
from tyrefrf.plots.mobility import mobility_figures
from tyrefrf.results import Measured

RADIAL, TANGENTIAL = synthetic.LOADS
F = np.arange(20.0, 2500.0, 12.0)  # beyond the computed lines
WITHIN = F <= 2000.0


def curve(name, load, probe, quantity="mobility"):
    """A response of 30 to 60 mm/(s N), ten times those computed."""
    mobility = (0.03 + 1.2e-5 * F) * np.exp(1e-2j * F)
    s = {"receptance": 1.0, "mobility": 0.0, "accelerance": -1.0}[quantity]
    return Measured(name, load, probe, quantity, F.copy(), mobility / (2j * np.pi * F) ** s)


@pytest.fixture
def made():
    measured = (
        curve("run 1", "radial", "radial.drive", "accelerance"),
        curve("run $2", "radial", "shoulder", "receptance"),
        curve("run 3", "tangential", "shoulder"),
    )
    return replace(synthetic.results(), measured=measured)


def drawn(axes):
    return {str(line.get_label()): line for line in axes.lines}


def test_the_mobility_of_every_measured_pair_is_drawn(made):
    (figure,) = mobility_figures(made, RADIAL)
    magnitude, phase = (drawn(axes) for axes in figure.axes)
    for k, label in ((0, "run 1: measured at radial.drive"), (1, r"run \$2: measured at shoulder")):
        np.testing.assert_array_equal(magnitude[label].get_xdata(), F[WITHIN])
        Y = made.measured[k].mobility[WITHIN]
        np.testing.assert_array_equal(magnitude[label].get_ydata(), np.abs(Y))
        np.testing.assert_allclose(np.abs(Y), (0.03 + 1.2e-5 * F)[WITHIN], rtol=1e-12)
        angle = phase[label].get_ydata()
        expected = np.degrees(np.angle(Y))
        np.testing.assert_array_equal(angle[~np.isnan(angle)], expected)
    assert not any("run 3" in label for label in magnitude)


def test_it_lies_below_the_computed_curves_and_apart_from_the_others(made):
    (figure,) = mobility_figures(made, RADIAL)
    lines = drawn(figure.axes[0])
    measured = [line for label, line in lines.items() if "measured" in label]
    computed = [line for label, line in lines.items() if " at outer " in label]
    assert max(line.get_zorder() for line in measured) < min(line.get_zorder() for line in computed)
    assert len({(line.get_color(), line.get_marker()) for line in measured}) == 2


def test_the_axes_hold_it_and_the_legend_names_it(made):
    (figure,) = mobility_figures(made, RADIAL)
    assert figure.axes[0].get_ylim()[1] > 0.05
    assert figure.axes[0].get_xlim() == (0.0, 2000.0)
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "run 1: measured at radial.drive" in words


def test_a_pair_that_is_zero_by_symmetry_shows_what_was_measured(made):
    lateral = replace(made, measured=(curve("run 4", "radial", "crown y"),))
    (figure,) = mobility_figures(lateral, RADIAL)
    assert "run 4: measured at crown y" in drawn(figure.axes[0])


def test_a_measured_driving_point_is_in_the_figure_of_real_parts(made):
    (figure,) = driving_figures(made)
    lines = drawn(figure.axes[0])
    Y = made.measured[0].mobility[WITHIN]
    np.testing.assert_array_equal(lines["run 1: measured at radial.drive"].get_ydata(), Y.real)
    assert sum("measured" in label for label in lines) == 1
