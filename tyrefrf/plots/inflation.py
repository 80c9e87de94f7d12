"""The tyre under pressure: its static shape and stresses."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from tyrefrf.arrays import FloatArray
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.plots.section import element_polygons
from tyrefrf.plots.style import house_style, set_title
from tyrefrf.results.results import STRESS, Results, StaticState

VISIBLE = 0.04  # of the section's size: the largest displacement is drawn about so long


@house_style()
def inflation_figures(results: Results) -> list[Figure]:
    """One figure: hoop and von Mises stress on the inflated section; none without pressure."""
    state = results.inflation
    if state is None:
        return []
    scale = _scale(results.section, state)
    figure = Figure(figsize=(11.0, 4.6))
    panels = figure.subplots(1, 2)
    stresses = {"hoop stress": state.stress[:, STRESS.index("tt")], "von Mises": von_mises(state)}
    for axes, (name, stress) in zip(panels, stresses.items(), strict=True):
        _draw(axes, results.section, state, scale, stress, f"{name} [MPa]")
    largest = 1e3 * np.linalg.norm(state.displacement, axis=1).max()
    set_title(
        panels[0],
        results,
        f"inflated to {state.pressure / 1e5:.4g} bar in {len(state.share)} step(s), "
        f"{state.resultant[0]:.4g} N outwards on a cell\n"
        f"largest displacement {largest:.3g} mm, drawn {scale:g} times as large",
    )
    panels[0].set_ylabel("r [mm]")
    return [figure]


def von_mises(state: StaticState) -> FloatArray:
    """Von Mises stress (e,) [Pa] of the elements' mean stresses."""
    normal, shear = state.stress[:, :3], state.stress[:, 3:]
    deviator = normal - normal.mean(axis=1)[:, None]
    return np.sqrt(1.5 * np.sum(deviator**2, axis=1) + 3.0 * np.sum(shear**2, axis=1))


def _scale(section: SectionMesh, state: StaticState) -> float:
    """A round number of times that the displacements are drawn, so that they can be seen."""
    largest = np.linalg.norm(state.displacement, axis=1).max()
    wanted = VISIBLE * np.ptp(section.points, axis=0).max() / largest
    return float(max(1.0, 10.0 ** np.floor(np.log10(wanted))))


def _draw(
    axes: Axes,
    section: SectionMesh,
    state: StaticState,
    scale: float,
    stress: FloatArray,
    label: str,
) -> None:
    """The section at rest in outline, and inflated with its elements coloured."""
    at_rest = element_polygons(section, section.points)
    axes.add_collection(
        PolyCollection(list(at_rest), facecolor="none", edgecolor="0.75", linewidth=0.5)
    )
    inflated = element_polygons(section, section.points + scale * state.displacement)
    elements = PolyCollection(list(inflated), cmap="cividis", edgecolor="0.3", linewidth=0.3)
    elements.set_array(stress / 1e6)
    axes.add_collection(elements)
    bar = axes.figure.colorbar(elements, ax=axes, orientation="horizontal", shrink=0.8)
    bar.set_label(label)
    axes.set_xlabel("y [mm]")
    axes.set_aspect("equal")
    axes.autoscale_view()
