"""Mesh files of other programs, by the ending of their name, in metres with the axle along y."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.abaqus import read_inp
from tyrefrf.mesh.ansys import read_cdb
from tyrefrf.mesh.library import read_by_meshlane
from tyrefrf.mesh.outside import NAMING, OutsideMesh

if TYPE_CHECKING:
    from tyrefrf.case import MeshFile

METRES = {"m": 1.0, "mm": 1e-3, "in": 0.0254}
"""By how much a file's coordinates are multiplied."""

XYZ = {"x": (2, 0, 1), "y": (0, 1, 2), "z": (1, 2, 0)}
"""The file's coordinates that become x, y, z for each axle: turned, not mirrored."""

PLAUSIBLE = (0.05, 5.0)
"""Largest radius of a tyre [m]: of a toy's to an earth mover's, with margin."""

READERS = {".inp": read_inp, ".cdb": read_cdb}
"""Formats that another reader than meshlane reads."""


def read_mesh(path: Path, source: MeshFile) -> OutsideMesh:
    """The mesh of a file, turned and scaled as its [mesh] table says.

    Sets of lines are sets of nodes too, and all elements are the set EALL, as in CalculiX.
    Raises MeshError, naming the file, where it cannot be read, or is no tyre in that unit.
    """
    if not path.is_file():
        raise MeshError(f"{path}: {'is no file' if path.exists() else 'there is no such file'}")
    return as_said(READERS.get(path.suffix.lower(), read_by_meshlane)(path), source)


def as_said(mesh: OutsideMesh, source: MeshFile) -> OutsideMesh:
    """A mesh in its own unit and axes, turned, scaled and with sets as `read_mesh` has it."""
    points = mesh.points[:, XYZ[source.axis]] * METRES[source.unit]
    used = np.unique(np.concatenate([block.nodes.ravel() for block in mesh.elements]))
    _refuse_wrong_unit(mesh.path, points[used] if len(used) else points, source)
    node_sets = {**_on_lines(mesh), **mesh.node_sets}
    element_sets = {"EALL": np.concatenate([e.numbers for e in mesh.elements]), **mesh.element_sets}
    return replace(mesh, points=points, node_sets=node_sets, element_sets=element_sets)


def _on_lines(mesh: OutsideMesh) -> dict[str, IntArray]:
    """Places of the nodes of every set that has lines or points: Gmsh's way to name nodes."""
    lines = [block for block in mesh.elements if block.kind in NAMING]
    found = {
        name: [block.nodes[np.isin(block.numbers, members)].ravel() for block in lines]
        for name, members in mesh.element_sets.items()
    }
    return {
        name: np.unique(np.concatenate(nodes))
        for name, nodes in found.items()
        if any(len(part) for part in nodes)
    }


def _refuse_wrong_unit(path: str, points: FloatArray, source: MeshFile) -> None:
    """Raise MeshError where the largest radius is no tyre's."""
    low, high = PLAUSIBLE
    radius = float(np.hypot(points[:, 0], points[:, 2]).max(initial=0.0))
    if low <= radius <= high:
        return
    raw = radius / METRES[source.unit]
    fits = [unit for unit, factor in METRES.items() if low <= raw * factor <= high]
    hint = f"is the unit {' or '.join(fits)}?" if fits else "is the axle along another axis?"
    raise MeshError(
        f"{path}: the largest radius is {radius:.4g} m (with mesh.unit = '{source.unit}' and "
        f"mesh.axis = '{source.axis}'), outside {low:g} to {high:g} m; {hint}"
    )
