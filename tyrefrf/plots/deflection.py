"""Still pictures of the whole tyre in motion: its outer surface in space, and the mid-tread."""

from __future__ import annotations

from collections.abc import Iterator
from math import floor, log10
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.mesh.place import Place
from tyrefrf.plots.style import TITLE_WIDTH, house_style, plain
from tyrefrf.results.deflection import Deflection, at_phase, phase_of_most
from tyrefrf.results.ring_mesh import RingMesh

ELEVATION, AZIMUTH = 16.0, 32.0  # degrees; the axle points to the front right
LIGHT = np.array([0.35, 0.25, 0.9])
AMBIENT = 0.65  # of the light: what shade leaves
INSIDE = 0.8  # of the light on what is seen from within
TO_VIEW = [1, 2, 0]
"""x, y, z as the picture has them: the axle to the right, angle 0 on top."""
COLOURS = "RdBu_r"
ARROW = 0.28  # of the tyre's radius
PREFIXES = {0: "", -3: "m", -6: "\N{MICRO SIGN}", -9: "n", -12: "p", -15: "f"}


def deflection_figures(deflection: Deflection) -> Iterator[tuple[str, Figure]]:
    """The one figure of a deflection with the stem of its file's name."""
    yield f"deflection_{deflection.stem}", deflection_figure(deflection)


@house_style()
def deflection_figure(deflection: Deflection) -> Figure:
    """The tyre when it moves most, `visible_scale` times enlarged, coloured by motion outwards."""
    figure = Figure(figsize=(10.5, 6.2))
    grid = figure.add_gridspec(1, 2, width_ratios=[1.75, 1.0])
    space = figure.add_subplot(grid[0], projection="3d", computed_zorder=False)
    assert isinstance(space, Axes3D)
    phase = phase_of_most(deflection.u)
    moved = _draw_surface(figure, space, deflection, phase)
    arrow = _draw_load(space, deflection.load)
    _frame(space, np.concatenate([moved.reshape(-1, 3), arrow]))
    _draw_mid_tread(figure.add_subplot(grid[1]), deflection, phase)
    figure.suptitle(_title(deflection, phase), x=0.01, ha="left", fontsize=11)
    return figure


def _title(deflection: Deflection, phase: float) -> str:
    """The case, what moves, and how it is drawn."""
    degrees = np.rad2deg(phase) % 360.0
    of = "displacement under 1 N" if deflection.load is not None else "shape of unit modal mass"
    lines = (
        deflection.provenance.title,
        f"{deflection.frequency:.5g} Hz, {deflection.words}",
        f"drawn {deflection.visible_scale:g} times the {of}, at the phase of most motion, "
        f"{degrees:.0f}\N{DEGREE SIGN}",
    )
    return "\n".join(fill(plain(line), TITLE_WIDTH) for line in lines)


def _draw_surface(figure: Figure, axes: Axes3D, deflection: Deflection, phase: float) -> FloatArray:
    """The outer surface's quadrilaterals, deformed, coloured and lit; their corners (f, 4, 3)."""
    mesh, u = deflection.mesh, at_phase(deflection.cartesian, phase)
    moved = (mesh.points + deflection.visible_scale * u)[mesh.outer][..., TO_VIEW]
    outwards = outward(mesh, u)
    power = _prefix(np.abs(outwards).max())
    scale = Normalize(*(np.array([-1.0, 1.0]) * (np.abs(outwards).max() or 1.0) / 10.0**power))
    colour = ScalarMappable(scale, COLOURS)
    rgba = colour.to_rgba(outwards / 10.0**power)
    rgba[:, :3] *= _light(moved)[:, None]
    axes.add_collection3d(
        Poly3DCollection(moved, facecolors=rgba, edgecolors=0.75 * rgba[:, :3], linewidths=0.25)
    )
    bar = figure.colorbar(colour, ax=axes, shrink=0.55, pad=0.0, location="left")
    unit = deflection.units["displacement"]
    bar.set_label(f"outward displacement [{_prefixed(power, unit)}]")
    return moved


def outward(mesh: RingMesh, u: FloatArray) -> FloatArray:
    """(f,) the motion u (p, 3) of the outer surface's faces along their outward normals."""
    return np.einsum("fi,fi->f", u[mesh.outer].mean(axis=1), _normals(mesh.points[mesh.outer]))


def _normals(corners: FloatArray) -> FloatArray:
    """(f, 3) unit normals of quadrilaterals (f, 4, 3), by their diagonals."""
    n = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    return np.asarray(n / np.linalg.norm(n, axis=1, keepdims=True))


def _light(corners: FloatArray) -> FloatArray:
    """(f,) how bright faces are: both sides take light, the inside less."""
    elevation, azimuth = np.deg2rad([ELEVATION, AZIMUTH])
    c = np.cos(elevation)
    viewer = np.array([c * np.cos(azimuth), c * np.sin(azimuth), np.sin(elevation)])
    n = _normals(corners)
    seen_outside = n @ viewer > 0.0
    n[~seen_outside] *= -1.0
    lit = AMBIENT + (1.0 - AMBIENT) * np.clip(n @ LIGHT / np.linalg.norm(LIGHT), 0.0, 1.0)
    return np.where(seen_outside, lit, INSIDE * lit)


def _frame(axes: Axes3D, points: FloatArray) -> None:
    """All points (k, 3) at true proportions, without a box around them."""
    low, high = points.min(axis=0), points.max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=1.2)
    axes.view_init(elev=ELEVATION, azim=AZIMUTH)
    axes.set_proj_type("persp", focal_length=2.5)
    axes.set_axis_off()


def _draw_load(axes: Axes3D, load: Place | None) -> FloatArray:
    """An arrow along the load, away from its place; its ends (2, 3), none without a load."""
    if load is None:
        return np.empty((0, 3))
    c, s = np.cos(load.angle), np.sin(load.angle)
    along = {"r": (c, 0.0, s), "y": (0.0, 1.0, 0.0), "theta": (-s, 0.0, c)}[load.direction]
    place = np.array([load.r * c, load.y, load.r * s])
    ends = np.array([place, place + ARROW * load.r * np.array(along)])[:, TO_VIEW]
    axes.quiver(*ends[0], *(ends[1] - ends[0]), color="black", linewidth=1.8)
    return ends


def _draw_mid_tread(axes: Axes, deflection: Deflection, phase: float) -> None:
    """The mid-tread line seen along the axle: at rest, at most motion, a quarter later."""
    mesh, u = deflection.mesh, deflection.cartesian
    line = mid_tread(mesh)
    line = np.append(line, line[0])
    rest = mesh.points[line]
    curves: dict[str, tuple[FloatArray, dict[str, Any]]] = {
        "at rest": (0.0 * rest, {"color": "0.6", "linewidth": 0.8}),
        "most motion": (at_phase(u, phase)[line], {"color": "C0", "linewidth": 1.6}),
        "a quarter of a period later": (
            at_phase(u, phase + np.pi / 2.0)[line],
            {"color": "C1", "linestyle": (0, (4, 2))},
        ),
    }
    for label, (motion, look) in curves.items():
        x, _, z = (rest + deflection.visible_scale * motion).T
        axes.plot(z, x, label=label, **look)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title("mid-tread, along the axle", fontsize=10, loc="center")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0))


def mid_tread(mesh: RingMesh) -> IntArray:
    """Points of the outer surface nearest to y = 0, in order around the axle."""
    nodes = np.unique(mesh.outer)
    y = mesh.points[nodes, 1]
    nearest = y[np.argmin(np.abs(y))]
    line = nodes[np.abs(y - nearest) < 1e-6 * np.ptp(y)]
    return line[np.argsort(mesh.theta[line])]


def _prefix(largest: float) -> int:
    """The power of ten of the SI prefix that suits a value [m]; 0 for nothing."""
    if largest == 0.0:
        return 0
    return max(min(3 * floor(log10(largest) / 3.0), 0), min(PREFIXES))


def _prefixed(power: int, unit: str) -> str:
    """A unit of length with a prefix; a power of ten before any other."""
    if unit.startswith("m"):
        return PREFIXES[power] + unit
    return f"1e{power} {unit}" if power else unit
