"""From a file's mesh to a periodic cell: which of its sets is what."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.mesh.brick_faces import CORNERS, MID_SIDES
from tyrefrf.mesh.bricks import Bricks
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.mesh.cut import Side
from tyrefrf.mesh.free_surface import Surface
from tyrefrf.mesh.named import Chosen, choose, set_named
from tyrefrf.mesh.outside import Elements, OutsideMesh
from tyrefrf.mesh.periodic import CellSets, periodic_cell

if TYPE_CHECKING:
    from tyrefrf.case import CellFile

BRICKS = ("hexahedron", "hexahedron20")
FLAT = ("quad", "quad8", "quad9", "triangle", "triangle6")
"""Kinds that may name a surface: in Gmsh's files, its physical surfaces."""


def outside_cell(
    mesh: OutsideMesh, source: CellFile, sector_angle: float, oriented: Collection[str] = ()
) -> CellMesh:
    """The periodic cell of `sector_angle` [rad] of a file's mesh.

    oriented: materials, by their names in `Case.laid_materials`, that are not isotropic: what
    they are laid along has to be clear. Raises CaseError at the key for sets that do not fit, and
    MeshError, naming element or node, for a mesh that is no such cell.
    """
    named = {
        key: name
        for key in ("rim", "inner", "left", "right")
        if (name := getattr(source, key)) is not None
    }
    mesh = _without_flat(mesh, tuple(named.values()))
    chosen = choose(mesh, source, BRICKS)
    sets = CellSets(
        rim=_side(mesh, chosen, named["rim"], "rim"),
        inner=_surface(mesh, chosen, named["inner"]) if "inner" in named else None,
        left=_side(mesh, chosen, named["left"], "left") if "left" in named else None,
        right=_side(mesh, chosen, named["right"], "right") if "right" in named else None,
        through=_through(source, chosen),
        oriented=oriented,
    )
    bricks = Bricks(chosen.nodes, chosen.numbers, chosen.material, chosen.materials)
    return periodic_cell(mesh, bricks, sets, sector_angle, source.tolerance)


def _without_flat(mesh: OutsideMesh, names: tuple[str, ...]) -> OutsideMesh:
    """The mesh with the flat elements of these sets taken for node sets, and not for a skin."""
    lower = {name.casefold() for name in names}
    flat = {
        name: numbers for name, numbers in mesh.element_sets.items() if name.casefold() in lower
    }
    elements = []
    nodes: dict[str, list[IntArray]] = {name: [np.empty(0, np.int64)] for name in flat}
    for block in mesh.elements:
        naming = np.zeros(len(block.numbers), dtype=bool)
        for name, numbers in flat.items() if block.kind in FLAT else ():
            here = np.isin(block.numbers, numbers)
            nodes[name].append(block.nodes[here].ravel())
            naming |= here
        elements.append(Elements(block.kind, block.nodes[~naming], block.numbers[~naming]))
    found = {name: np.unique(np.concatenate(parts)) for name, parts in nodes.items()}
    found = {name: there for name, there in found.items() if len(there)}
    return replace(mesh, elements=tuple(elements), node_sets={**found, **mesh.node_sets})


def _side(mesh: OutsideMesh, chosen: Chosen, name: str, key: str) -> Side:
    """The nodes of a node set, or of a surface."""
    on_faces = {other: _nodes_on(chosen, faces) for other, faces in mesh.surfaces.items()}
    sets = {**on_faces, **mesh.node_sets}
    return Side(np.unique(set_named(mesh, sets, name, ("mesh", key), "node set")), name)


def _nodes_on(chosen: Chosen, faces: IntArray) -> IntArray:
    """Nodes of the faces (k, 2) of bricks; a face without a number has none here."""
    of_side = CORNERS if chosen.nodes.shape[1] == 8 else np.hstack([CORNERS, MID_SIDES])
    row = {number: e for e, number in enumerate(chosen.numbers.tolist())}
    nodes = [
        chosen.nodes[row[number], of_side[side - 1]]
        for number, side in faces.tolist()
        if number in row and 1 <= side <= 6
    ]
    return np.unique(np.array(nodes, dtype=np.int64))


def _surface(mesh: OutsideMesh, chosen: Chosen, name: str) -> Side | Surface:
    """The faces of a surface, or the nodes of a set."""
    if any(other.casefold() == name.casefold() for other in mesh.surfaces):
        return Surface(set_named(mesh, mesh.surfaces, name, ("mesh", "inner"), "surface"), name)
    sets = {**mesh.node_sets, **mesh.surfaces}
    nodes = set_named(mesh, sets, name, ("mesh", "inner"), "surface or node set")
    return Side(np.unique(nodes), name)


def _through(source: CellFile, chosen: Chosen) -> FloatArray:
    """Directions (e, 2) through the layers as their set says, else zero."""
    given = [region.through or (0.0, 0.0) for region in source.regions.values()]
    return np.array(given)[chosen.region]
