"""The blocked hub's figure: forces above moments, without those that symmetry forbids."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import synthetic

from tyrefrf.plots.hub import hub_figures
from tyrefrf.results import Results


@pytest.fixture
def made() -> Results:
    return synthetic.results()


def test_forces_and_moments_have_a_panel_each_with_its_unit(made):
    (figure,) = hub_figures(made)
    forces, moments = figure.axes
    assert forces.get_ylabel() == "Force magnitude [N/N]"
    assert moments.get_ylabel() == "Moment magnitude [N m/N]"
    assert moments.get_xlabel() == "Frequency [Hz]"
    assert [line.get_label() for line in forces.lines] == ["radial: Fx", "tangential: Fz"]
    (My,) = moments.lines
    np.testing.assert_array_equal(My.get_ydata(), np.abs(made.blocked_force[1, 4]))


def test_zeros_by_symmetry_are_named(made):
    (figure,) = hub_figures(made)
    text = figure.legends[0].get_texts()[-1].get_text().replace("\n", " ")
    assert text == "zero by symmetry: radial: Fy Fz Mx My Mz, tangential: Fx Fy Mx Mz"


def test_moments_that_are_all_rounding_are_not_drawn(made):
    blocked = made.blocked_force[:1]
    radial = replace(
        made, loads=made.loads[:1], receptance=made.receptance[:1], blocked_force=blocked
    )
    (figure,) = hub_figures(radial)
    moments = figure.axes[1]
    assert len(moments.lines) == 0
    assert [text.get_text() for text in moments.texts] == ["all zero by symmetry"]


def test_failed_lines_are_gaps(made):
    (figure,) = hub_figures(synthetic.with_failed(made, 60))
    assert np.flatnonzero(np.isnan(figure.axes[0].lines[0].get_ydata())).tolist() == [60]


def test_without_a_hub_there_is_no_figure(made):
    assert hub_figures(replace(made, blocked_force=made.blocked_force[:, :0])) == []
