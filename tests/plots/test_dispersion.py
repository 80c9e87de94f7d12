"""The figure of free waves: its curves, colours, axes and resonances are the data's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import synthetic
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb

from tyrefrf.plots import draw_plots
from tyrefrf.plots.dispersion import FAINTEST, dispersion_figure, resonances
from tyrefrf.plots.style import house_style
from tyrefrf.results import Dispersion

LINES = np.array([100.0, 200.0, 300.0, 400.0])


@pytest.fixture
def made() -> Dispersion:
    """A weakly decaying radial wave, and one that cuts on and becomes lateral."""
    order = np.array([[0.5, 1.5, 2.5, 4.5], [np.nan, 0.2, 1.2, 2.2]])
    decay = np.array([[0.1, 0.1, 0.2, 0.3], [np.nan, 2.0, 1.0, 0.3]])
    radial = np.array([[0.9, 0.9, 0.9, 0.9], [np.nan, 0.6, 0.2, 0.1]])
    return Dispersion(
        frequency=LINES,
        order=order,
        decay=decay,
        velocity=order,
        share=np.stack([radial, 1.0 - radial, 0.0 * radial], axis=1),
        residual=0.0 * order,
        found=np.array([1, 2, 2, 2]),
        counted=np.array([1, 2, 2, 2]),
        solve_time=np.zeros(4),
        remark=("",) * 4,
        bound=2.0,
        section=synthetic.section(),
        provenance=synthetic.PROVENANCE,
    )


def curves(axes) -> list[LineCollection]:
    return [c for c in axes.collections if isinstance(c, LineCollection)]


def test_curves_hold_the_branches(made):
    order, decay = dispersion_figure(made).axes
    for axes, values in ((order, made.order), (decay, made.decay)):
        first, second = curves(axes)
        np.testing.assert_array_equal(
            [segment[0] for segment in first.get_segments()],
            np.column_stack([LINES, values[0]])[:-1],
        )
        np.testing.assert_array_equal(
            [segment[1] for segment in second.get_segments()],
            np.column_stack([LINES, values[1]])[2:],
        )


def test_colour_tells_the_motion_and_faintness_the_decay(made):
    order, decay = dispersion_figure(made).axes
    with house_style():
        radial, lateral = to_rgb("C0"), to_rgb("C1")
    first, second = (curve.get_colors() for curve in curves(order))
    np.testing.assert_allclose(first[:, :3], [radial] * 3)
    np.testing.assert_allclose(second[:, :3], [lateral] * 2)
    np.testing.assert_allclose(first[:, 3], 1.0 - (1.0 - FAINTEST) * np.array([0.05, 0.1, 0.15]))
    np.testing.assert_allclose(curves(decay)[1].get_colors()[:, 3], 1.0)


def test_axes_say_what_they_show(made):
    order, decay = dispersion_figure(made).axes
    assert order.get_ylabel() == "Circumferential order"
    assert decay.get_ylabel() == "Decay [Np/rad]"
    assert decay.get_xlabel() == "Frequency [Hz]"
    right = [axes.get_ylabel() for panel in (order, decay) for axes in panel.child_axes]
    assert right == ["Wavenumber at the outer radius [rad/m]", "Decay [dB/rad]"]
    assert order.get_title(loc="left").splitlines() == [
        "A made-up tyre 165/65R13",
        "free waves that decay by up to 17.4 dB/rad",
    ]


def test_resonances_stand_where_an_order_is_whole_and_the_wave_comes_round(made):
    """At order 3 and 4 between 300 and 400 Hz; the second branch decays too much for any."""
    np.testing.assert_allclose(resonances(made), [(150, 1), (250, 2), (325, 3), (375, 4)])


def test_a_line_that_failed_is_marked(made):
    counted = np.array([1, 2, 3, 2])
    figure = dispersion_figure(replace(made, counted=counted))
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "no answer (1 of 4 lines)" in labels


def test_no_waves_make_an_empty_figure(made):
    nothing = {name: getattr(made, name)[:0] for name in ("order", "decay", "velocity", "residual")}
    figure = dispersion_figure(replace(made, **nothing, share=made.share[:0]))
    assert curves(figure.axes[0]) == []


def test_the_figure_is_drawn_as_a_file(made, tmp_path):
    drawn = draw_plots(made, tmp_path, ("png", "svg"))
    assert [path.name for path in drawn] == ["dispersion.png", "dispersion.svg"]
    assert all(path.stat().st_size > 10_000 for path in drawn)
