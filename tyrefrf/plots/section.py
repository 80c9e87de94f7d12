"""The section as it was meshed: elements by material, the rim, loads and probes."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from tyrefrf.arrays import FloatArray
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.plots.places import MM, draw_loads, draw_probes
from tyrefrf.plots.style import house_style, legend_below, plain, set_title
from tyrefrf.results.results import Results

AROUND = [0, 4, 1, 5, 2, 6, 3, 7]  # nodes of an eight-node element in order along its edges

HATCHES = ("", "////", "....", "xxxx", "----", "\\\\\\\\")
"""Materials stay apart in black and white."""


@house_style()
def section_figure(results: Results) -> Figure:
    """The section over y and r [mm], so that e_theta points into the page."""
    figure = Figure(figsize=(9.0, 5.8))
    axes = figure.subplots()
    handles = [
        *_draw_elements(axes, results.section),
        *_draw_rim(axes, results.section),
        *draw_loads(axes, results),
        *draw_probes(axes, results),
    ]
    set_title(axes, results, "section, loads and probes")
    axes.set_xlabel("y [mm]")
    axes.set_ylabel("r [mm]")
    axes.set_aspect("equal", adjustable="datalim")
    axes.update_datalim([(0.0, _headroom(results.section))])
    legend_below(figure, handles)
    return figure


def _headroom(section: SectionMesh) -> float:
    """The r [mm] up to which loads and their names stand above the crown."""
    r = MM * section.points[:, 0]
    return float(r.max() + 0.3 * np.ptp(r))


def element_polygons(section: SectionMesh, points: FloatArray) -> FloatArray:
    """Outlines (e, 4 or 8, 2) of the elements as (y, r) [mm], their nodes at points (n, 2) [m]."""
    quads = section.quads[:, AROUND] if section.quads.shape[1] == 8 else section.quads
    return _in_plot(points[quads])


def _in_plot(points: FloatArray) -> FloatArray:
    """(..., 2) places (r, y) [m] as (y, r) [mm]."""
    return MM * points[..., ::-1]


def _draw_elements(axes: Axes, section: SectionMesh) -> list[Patch] | list[Line2D]:
    """Fill the elements by material; a legend's handles. Dots where only nodes are known."""
    if not section.n_elements:
        y, r = _in_plot(section.points).T
        return axes.plot(y, r, "o", color="0.6", markersize=3, label="nodes of the section")
    outlines = element_polygons(section, section.points)
    handles = []
    for number, material in enumerate(section.materials):
        look: dict[str, Any] = {
            "facecolor": to_hex(f"C{number % 10}"),  # now: a collection asks again when drawn
            "hatch": HATCHES[number % len(HATCHES)],
        }
        look |= {"edgecolor": "0.3", "linewidth": 0.6, "alpha": 0.45}
        polygons = list(outlines[section.material == number])
        axes.add_collection(PolyCollection(polygons, **look))
        handles.append(Patch(**look, label=plain(material)))
    return handles


def _draw_rim(axes: Axes, section: SectionMesh) -> list[Line2D]:
    y, r = _in_plot(section.points[section.rim]).T
    return axes.plot(y, r, "s", color="black", markersize=5, label="rim")
