"""A mesh as another program wrote it: nodes, elements by kind, and named sets."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

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

    def digest(self) -> str:
        """SHA-256 of all that it holds, but for the path; the order of the sets does not count."""
        digest = hashlib.sha256()
        for name, array in self._arrays():
            plain = array.astype("<f8" if np.issubdtype(array.dtype, np.floating) else "<i8")
            digest.update(json.dumps([name, plain.shape]).encode())
            digest.update(plain.tobytes())
        return digest.hexdigest()

    def _arrays(self) -> Iterator[tuple[list[str], FloatArray | IntArray]]:
        """Every array, and what it is."""
        yield ["points"], self.points
        yield ["numbers"], self.numbers
        for block in self.elements:
            yield ["nodes", block.kind], block.nodes
            yield ["numbers", block.kind], block.numbers
        sets = {
            "element_sets": self.element_sets,
            "node_sets": self.node_sets,
            "surfaces": self.surfaces,
        }
        for kind, named in sets.items():
            for name in sorted(named):
                yield [kind, name], named[name]
