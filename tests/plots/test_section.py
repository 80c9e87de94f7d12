"""The section's figure: every element in its place and material, every load and probe."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import synthetic
from matplotlib.collections import PolyCollection
from matplotlib.quiver import Quiver
from matplotlib.text import Annotation

from tyrefrf.plots.section import section_figure
from tyrefrf.results import Results


@pytest.fixture
def made() -> Results:
    return synthetic.results()


def axes_of(results):
    (axes,) = section_figure(results).axes
    return axes


def polygons(axes):
    return [c for c in axes.collections if isinstance(c, PolyCollection) and type(c) is not Quiver]


def notes(axes):
    return {note.get_text(): note.xy for note in axes.texts if isinstance(note, Annotation)}


def test_every_element_is_filled_in_its_own_place(made):
    rubber, tread = polygons(axes_of(made))
    assert len(rubber.get_paths()) + len(tread.get_paths()) == 28
    first = rubber.get_paths()[0].vertices[:4]
    corners = made.section.points[made.section.quads[0]]
    np.testing.assert_allclose(first, 1e3 * corners[:, ::-1])


def test_elements_have_the_colour_of_their_material_in_the_legend(made):
    figure = section_figure(made)
    figure.draw_without_rendering()  # outside the house style, as a user saves it
    (legend,) = figure.legends
    shown = [patch.get_facecolor() for patch in legend.get_patches()]
    drawn = [tuple(elements.get_facecolor()[0]) for elements in polygons(figure.axes[0])]
    assert drawn == shown[: len(drawn)]


def without_elements(section):
    """The section of a cell that came as matrices."""
    nothing = np.empty((0, 4), np.int64)
    return replace(
        section,
        quads=nothing,
        material=nothing[:, 0],
        outer=nothing[:, :2],
        inner=nothing[:, :2],
    )


def test_nodes_are_drawn_where_there_are_no_elements(made):
    at_nodes = {
        "loads": tuple(replace(load, surface="", diameter=0.0) for load in made.loads),
        "probes": tuple(replace(probe, surface="") for probe in made.probes),
    }
    bare = replace(made, section=without_elements(made.section), **at_nodes)
    figure = section_figure(bare)
    (axes,) = figure.axes
    (dots,) = [line for line in axes.lines if line.get_label() == "nodes of the section"]
    np.testing.assert_allclose(dots.get_xydata(), 1e3 * made.section.points[:, ::-1])
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[:2] == ["nodes of the section", "rim"]


def test_an_element_of_eight_nodes_is_drawn_along_its_edges(made):
    section = made.section
    ends = section.points[section.quads]
    middles = (ends + np.roll(ends, -1, axis=1)) / 2
    points = np.concatenate([section.points, middles.reshape(-1, 2)])
    mids = len(section.points) + np.arange(4 * 28).reshape(28, 4)
    quadratic = replace(section, points=points, quads=np.hstack([section.quads, mids]))
    outline = polygons(axes_of(replace(made, section=quadratic)))[0].get_paths()[0].vertices
    np.testing.assert_allclose(outline[1:8:2], 1e3 * middles[0][:, ::-1])


def test_axes_are_y_and_r_with_equal_scales(made):
    axes = axes_of(made)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("y [mm]", "r [mm]")
    assert axes.get_aspect() == 1.0


def test_the_legend_names_materials_rim_loads_and_probes(made):
    figure = section_figure(made)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[:3] == ["rubber", "tread", "rim"]
    assert labels[3] == "load radial: r at outer 0.500, 0°, ⌀ 10 mm"
    assert labels[5] == "1  shoulder: r at outer 0.320, 0°"
    assert len(labels) == 3 + 2 + 8


def test_rim_nodes_are_marked(made):
    (rim,) = [line for line in axes_of(made).lines if line.get_label() == "rim"]
    np.testing.assert_allclose(rim.get_xydata(), 1e3 * made.section.points[[0, 1, 56, 57]][:, ::-1])


def test_loads_are_named_and_point_along_their_direction(made):
    axial = replace(made.loads[0], name="axial", direction="y")
    loaded = replace(made, loads=(made.loads[0], axial))
    axes = axes_of(loaded)
    radial, along = [c for c in axes.collections if isinstance(c, Quiver)]
    assert (radial.U[0], radial.V[0] > 0.0) == (0.0, True)
    assert (along.U[0] > 0.0, along.V[0]) == (True, 0.0)
    assert notes(axes)["radial\naxial"] == pytest.approx((0.0, 278.0))


def test_a_patch_is_as_wide_as_its_disc(made):
    bars = [line for line in axes_of(made).lines if len(line.get_xdata()) == 2]
    widths = [float(np.hypot(*np.ptp(line.get_xydata(), axis=0))) for line in bars]
    assert widths[0] == pytest.approx(10.0)


def test_probes_are_numbered_where_they_are_and_other_angles_are_labelled(made):
    written = notes(axes_of(made))
    sidewall = made.probes[1]
    assert written["2"] == pytest.approx((1e3 * sidewall.y, 1e3 * sidewall.r), abs=1e-3)
    assert "3, 4, 8\n5 (180°)\n6 (90°)" in written


def test_numbers_stand_outside_the_outer_and_inside_the_inner_surface(made):
    offsets = {note.get_text(): note.xyann for note in axes_of(made).texts}
    assert offsets["2"][0] < 0.0  # the sidewall at y < 0
    assert offsets["1"][1] > 0.0  # the shoulder
    assert offsets["7"][1] < 0.0  # the liner


def test_names_above_the_crown_stay_inside_the_axes(made):
    figure = section_figure(made)
    figure.draw_without_rendering()
    axes = figure.axes[0]
    assert max(text.get_window_extent().y1 for text in axes.texts) < axes.bbox.y1


def test_a_node_off_the_surfaces_can_be_drawn(made):
    node = replace(made.probes[0], kind="node", surface="", s=float("nan"), r=0.27, y=0.01)
    written = notes(axes_of(replace(made, probes=(node, *made.probes[1:]))))
    assert written["1"] == pytest.approx((10.0, 270.0))
