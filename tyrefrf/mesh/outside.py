"""A mesh as another program wrote it: nodes, elements by kind, and named sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from tyrefrf.arrays import FloatArray, IntArray

NAMING = ("vertex", "line", "line3", "line4")
"""Kinds of elements that only name nodes: in Gmsh's files, the physical points and curves."""


@dataclass(frozen=True, slots=True, eq=False)
class Elements:
    """Elements of one kind.

    kind: meshio's name for it: quad, quad8, hexahedron, hexahedron20, triangle, ...; the file's own
        name where it has none.
    nodes: (e, a) places in `OutsideMesh.points`, in the order of Abaqus (and VTK) for the kind.
    numbers: (e,) as the file numbers them.
    """

    kind: str
    nodes: IntArray
    numbers: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class OutsideMesh:
    """A mesh in metres, with the axle along y.

    path: of the file, for messages. points: (n, 3) x, y, z [m]. numbers: (n,) of the nodes, as the
    file numbers them. elements: by kind, as they come in the file.
    element_sets: numbers of elements by the name of their set or physical group.
    node_sets: places in `points` by the name of their set.
    surfaces: (k, 2) number of the element and of its face, from 1 as Abaqus numbers them and 0 for
        all its outer faces, by the name of the surface; empty where the format knows none.
    """

    path: str
    points: FloatArray
    numbers: IntArray
    elements: tuple[Elements, ...]
    element_sets: Mapping[str, IntArray]
    node_sets: Mapping[str, IntArray]
    surfaces: Mapping[str, IntArray]
