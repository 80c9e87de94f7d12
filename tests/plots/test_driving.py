"""The driving points' figure shows Re Y, and points at what no passive tyre does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import synthetic

from tyrefrf.plots.driving import driving_figures
from tyrefrf.results import Results


@pytest.fixture
def made() -> Results:
    return synthetic.results()


def labelled(axes, label):
    (line,) = [line for line in axes.lines if line.get_label() == label]
    return line


def test_every_load_shows_the_real_part_of_its_own_point(made):
    (figure,) = driving_figures(made)
    (axes,) = figure.axes
    radial = labelled(axes, "radial: r at outer 0.500, 0°")
    np.testing.assert_array_equal(radial.get_ydata(), made.driving_point("radial").real)
    tangential = labelled(axes, "tangential: theta at outer 0.500, 0°")
    np.testing.assert_array_equal(tangential.get_ydata(), made.driving_point("tangential").real)
    assert axes.get_ylabel() == "Re Y [m/(s N)]"
    assert axes.get_xlabel() == "Frequency [Hz]"
    assert "A made-up tyre" in axes.get_title(loc="left")


def test_a_passive_tyre_is_not_marked(made):
    (figure,) = driving_figures(made)
    assert len(figure.legends[0].get_texts()) == 2


@pytest.mark.parametrize(("share", "marked"), [(0.5e-10, 0), (2e-10, 1)])
def test_negative_beyond_rounding_is_marked(made, share, marked):
    receptance = made.receptance.copy()
    size = abs(receptance[0, 2, 100])
    receptance[0, 2, 100] = size * (1.0 + 1j * share)  # i omega H: Re Y = -omega Im H
    (figure,) = driving_figures(replace(made, receptance=receptance))
    marks = [line for line in figure.axes[0].lines if line.get_marker() == "v"]
    assert len(marks) == marked
    assert all(line.get_xdata().tolist() == [500.0] for line in marks)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert ("radial: negative at 1 lines, not passive" in labels) == bool(marked)


def test_without_driving_points_there_is_no_figure(made):
    lonely = replace(made, probes=made.probes[:2], receptance=made.receptance[:, :2])
    assert driving_figures(lonely) == []
