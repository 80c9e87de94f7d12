"""Figures of natural modes: axes, labels and the data drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import PathCollection, PolyCollection
from small import case_with

from tyrefrf.plots import draw_plots
from tyrefrf.plots.modes import in_phase, order_figure, shapes_figure
from tyrefrf.results import Modes
from tyrefrf.study.modes import modes


@pytest.fixture(scope="module")
def found() -> Modes:
    return modes(case_with(), count=30)


def test_every_mode_stands_over_its_order(found):
    axes = order_figure(found).axes[0]
    assert axes.get_xlabel() == "Circumferential order h"
    assert axes.get_ylabel() == "Frequency [Hz]"
    points = [c.get_offsets() for c in axes.collections if isinstance(c, PathCollection)]
    drawn = np.concatenate([np.asarray(p) for p in points])
    expected = np.stack([found.order, found.frequency], axis=1)
    np.testing.assert_allclose(sorted(map(tuple, drawn)), sorted(map(tuple, expected)))


def test_the_folding_is_stated(found):
    assert "h of 15 cells stands for n = h, 15 - h, 15 + h" in order_figure(found).axes[
        0
    ].get_title(loc="left")


def test_modes_nearer_to_another_alias_are_ringed(found):
    assert len(order_figure(found).legends[0].get_texts()) == 3
    told = replace(found, diameters=15 - found.order)
    labels = [text.get_text() for text in order_figure(told).legends[0].get_texts()]
    assert labels[-1] == "in the cell's planes nearer to another alias than h"
    title = shapes_figure(told).axes[0].get_title(loc="left")
    assert title.endswith(f"h = {found.order[0]} (n = {15 - found.order[0]})")


def test_the_lowest_shapes_are_drawn_over_the_section_at_rest(found):
    figure = shapes_figure(found)
    assert len(figure.axes) == 12 + 1  # and the colour bar
    for number, axes in enumerate(figure.axes[:12]):
        at_rest, moved = (c for c in axes.collections if isinstance(c, PolyCollection))
        assert len(at_rest.get_paths()) == len(moved.get_paths()) == found.section.n_elements
        assert f"{found.frequency[number]:.4g} Hz" in axes.get_title(loc="left")
        around = np.abs(found.section_shape[number, :, 2])
        assert 0.0 <= np.max(moved.get_array()) <= 1.0
        assert (np.max(moved.get_array()) > 0.01) == (around.max() > 0.01 * around_all(found))


def test_shapes_of_nodes_alone_are_drawn_as_dots(found):
    """As those of a cell that came as matrices."""
    nothing = np.empty((0, 4), np.int64)
    section = replace(found.section, quads=nothing, material=nothing[:, 0])
    figure = shapes_figure(replace(found, section=section))
    for axes in figure.axes[:12]:
        at_rest, moved = (c for c in axes.collections if isinstance(c, PathCollection))
        y, r = 1e3 * found.section.points[:, ::-1].T
        np.testing.assert_allclose(np.asarray(at_rest.get_offsets()), np.stack([y, r], axis=1))
        assert np.ptp(np.asarray(moved.get_offsets()) - np.stack([y, r], axis=1)) > 0.0
        assert 0.0 <= np.max(moved.get_array()) <= 1.0


def around_all(found: Modes) -> float:
    return float(np.linalg.norm(found.section_shape, axis=2).max())


@pytest.mark.parametrize("phase", [0.0, 0.7, 2.0])
def test_motion_is_drawn_at_the_phase_of_the_largest(phase):
    u = np.array([[1.0, -2.0], [0.5, 3.0]])
    drawn = in_phase(u * np.exp(1j * phase) + 0j)
    assert np.allclose(drawn, u) or np.allclose(drawn, -u)


def test_figures_become_files(found, tmp_path):
    written = draw_plots(found, tmp_path, ("png",))
    assert [path.name for path in written] == ["frequency_by_order.png", "mode_shapes.png"]


def test_no_modes_still_make_a_plot():
    nothing = modes(case_with(), below=1.0)
    assert len(nothing.frequency) == 0
    assert order_figure(nothing).axes[0].get_xlabel() == "Circumferential order h"
