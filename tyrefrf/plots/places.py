"""Loads and probes, drawn on the section at the places actually used."""

from __future__ import annotations

from collections.abc import Iterable
from math import degrees, sin
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from tyrefrf.arrays import FloatArray
from tyrefrf.mesh.place import REGION, Place
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.plots.style import plain
from tyrefrf.results.results import Results

MM = 1e3  # millimetres in a metre

LOAD_COLOUR = "#a01010"
PROBE_COLOUR = "#103070"
ARROW = 30.0  # length of a load's arrow [pt]
POINTS_PER_INCH = 72.0
NAME_WIDTH = 16  # characters of a load's name in a line
ASIDE = np.deg2rad(-65.0)  # from the normal to the number of a probe that sits under a load

Spot = tuple[float, float]
"""A point of the section, (y, r) [mm]; several places may share it."""


def draw_loads(axes: Axes, results: Results) -> list[Line2D]:
    """Arrows along the loads' directions, bars as wide as patches, and names; a legend's handles.

    A load along theta, which points into the page, is a crossed circle.
    """
    for spot, places in _by_spot(results.loads).items():
        normal = _normal(results.section, places[0])
        for load in places:
            _draw_direction(axes, spot, load.direction)
            half = MM * load.diameter / 2.0 * np.array([normal[1], -normal[0]])
            axes.plot(*np.transpose([spot - half, spot + half]), color=LOAD_COLOUR, linewidth=4.0)
        names = "\n".join(fill(_with_angle(load.name, load), NAME_WIDTH) for load in places)
        _write(axes, names, spot, (ARROW + 4.0) * normal, color=LOAD_COLOUR)
    return [_load_handle(load) for load in results.loads]


def _draw_direction(axes: Axes, spot: Spot, direction: str) -> None:
    look: dict[str, Any] = {"color": LOAD_COLOUR, "zorder": 4}
    if direction == "theta":
        axes.plot(*spot, "o", markersize=11, markerfacecolor="white", **look)
        axes.plot(*spot, "x", markersize=7, **look)
    else:
        along = (ARROW / POINTS_PER_INCH) * np.array([direction == "y", direction == "r"])
        inches: dict[str, Any] = {
            "units": "inches",
            "scale_units": "inches",
            "scale": 1.0,
            "width": 0.025,
        }
        axes.quiver(*spot, *along, angles="uv", **inches, **look)


def _load_handle(load: Place) -> Line2D:
    marker = {"r": r"$\uparrow$", "y": r"$\rightarrow$", "theta": r"$\otimes$"}[load.direction]
    size = f", \N{DIAMETER SIGN} {MM * load.diameter:.4g} mm" if load.diameter else ""
    label = plain(f"load {load.label}{size}")
    return Line2D(
        [], [], marker=marker, markersize=10, linestyle="none", color=LOAD_COLOUR, label=label
    )


def draw_probes(axes: Axes, results: Results) -> list[Line2D]:
    """Numbered dots, hollow where the probes are at other angles; a legend's handles."""
    probes = [probe for probe in results.probes if probe.kind != REGION]
    numbers = {probe: number for number, probe in enumerate(probes, start=1)}
    loaded = _by_spot(results.loads)
    for spot, places in _by_spot(probes).items():
        axes.plot(*spot, **_dot(any(_at_zero(place) for place in places)), zorder=3)
        aside = 15.0 * _normal(results.section, places[0])
        if spot in loaded:
            aside = 1.5 * _rotated(aside, ASIDE)
        box = {"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": PROBE_COLOUR}
        text = _numbers_text(places, numbers)
        _write(axes, text, spot, aside, color=PROBE_COLOUR, bbox=box)
    return [
        Line2D([], [], **_dot(_at_zero(probe)), label=plain(f"{number}  {probe.label}"))
        for probe, number in numbers.items()
    ]


def _dot(here: bool) -> dict[str, Any]:
    """A probe's dot: filled in the plane that is drawn, hollow elsewhere."""
    look = {"marker": "o", "markersize": 5, "linestyle": "none", "color": PROBE_COLOUR}
    return look | {"markerfacecolor": PROBE_COLOUR if here else "white"}


def _numbers_text(places: Iterable[Place], numbers: dict[Place, int]) -> str:
    """The numbers of the probes at one spot, a line for each angle."""
    lines: dict[str, list[str]] = {}
    for place in places:
        lines.setdefault(_with_angle("", place), []).append(str(numbers[place]))
    return "\n".join(", ".join(group) + angle for angle, group in lines.items())


def _by_spot(places: Iterable[Place]) -> dict[Spot, list[Place]]:
    spots: dict[Spot, list[Place]] = {}
    for place in places:
        spot = (round(MM * place.y, 3), round(MM * place.r, 3))
        spots.setdefault(spot, []).append(place)
    return spots


def _at_zero(place: Place) -> bool:
    """Whether a place lies in the plane that is drawn."""
    return abs(sin(place.angle / 2.0)) < 1e-9


def _with_angle(text: str, place: Place) -> str:
    return text if _at_zero(place) else f"{text} ({degrees(place.angle):.4g}\N{DEGREE SIGN})"


def _normal(section: SectionMesh, place: Place) -> FloatArray:
    """(2,) unit vector (y, r) away from the tyre, on the surface's edge nearest to a place."""
    if not place.surface:
        return np.array([0.0, 1.0])
    edges = section.outer if place.surface == "outer" else section.inner
    ends = section.points[edges[:, :2]]
    distance = np.linalg.norm(ends.mean(axis=1) - [place.r, place.y], axis=1)
    along_r, along_y = np.diff(ends[np.argmin(distance)], axis=0)[0]
    outward = 1.0 if place.surface == "outer" else -1.0
    normal: FloatArray = outward * np.array([-along_r, along_y]) / np.hypot(along_r, along_y)
    return normal


def _rotated(vector: FloatArray, angle: float) -> FloatArray:
    """A vector (2,) of the plot turned anticlockwise."""
    c, s = np.cos(angle), np.sin(angle)
    turned: FloatArray = np.array([[c, -s], [s, c]]) @ vector
    return turned


def _write(axes: Axes, text: str, spot: Spot, offset: FloatArray, **look: Any) -> None:
    """Write beside a spot, the text's near side at the offset [pt]."""
    x, y = offset / np.linalg.norm(offset)
    horizontal = "left" if x > 0.5 else "right" if x < -0.5 else "center"
    vertical = "bottom" if y > 0.5 else "top" if y < -0.5 else "center"
    look |= {"xytext": tuple(offset), "textcoords": "offset points", "zorder": 7}
    note = axes.annotate(plain(text), spot, ha=horizontal, va=vertical, fontsize="small", **look)
    note.set_in_layout(False)  # there is room inside the axes; a long name is not to shrink them
