"""From a file's mesh to the section: its elements, materials, rim and surfaces."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.arrays import BoolArray, FloatArray, IntArray
from tyrefrf.case.faults import shown
from tyrefrf.errors import CaseError, Problem
from tyrefrf.mesh.abaqus import ANY_FACE
from tyrefrf.mesh.named import Chosen, choose, set_named
from tyrefrf.mesh.outside import OutsideMesh
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.mesh.sheet import (
    Sheet,
    boundary_loop,
    counter_clockwise,
    in_half_plane,
    refuse_cracks,
)
from tyrefrf.mesh.surfaces import part_boundary, refuse_other_inner
from tyrefrf.mesh.through import CLEAR, outwards, turn

if TYPE_CHECKING:
    from tyrefrf.case import SectionFile

QUADS = ("quad", "quad8")


def outside_section(
    mesh: OutsideMesh, source: SectionFile, oriented: Collection[str] = ()
) -> SectionMesh:
    """The section of a file's mesh, each element turned as the section's layers lie.

    oriented: materials, by their names in `Case.laid_materials`, that are not isotropic: what
    they are laid along has to be clear. Nodes keep the file's order, without those that no
    element has. Raises CaseError at the key for sets that do not fit, and MeshError, naming
    element or node, for a mesh that is no section.
    """
    chosen = choose(mesh, source, QUADS)
    used, quads = np.unique(chosen.nodes, return_inverse=True)
    nodes = mesh.numbers[used]
    drawn = Sheet(
        path=mesh.path,
        points=in_half_plane(mesh.path, mesh.points[used], nodes),
        nodes=nodes,
        quads=quads.reshape(chosen.nodes.shape),
        numbers=chosen.numbers,
    )
    sheet = counter_clockwise(drawn)
    refuse_cracks(sheet)
    rim = _rim(mesh, source, drawn, used)
    surfaces = part_boundary(sheet, boundary_loop(sheet), rim)
    if source.inner is not None:
        named = _on_surface(mesh, source, drawn, used, surfaces.inner)
        refuse_other_inner(sheet, surfaces.inner, named, source.inner)
    turned, clear = turn(sheet, _through(source, chosen, outwards(sheet, surfaces)))
    _refuse_unclear(turned, clear, source, chosen, oriented)
    return SectionMesh(
        points=sheet.points,
        quads=turned.quads,
        material=chosen.material,
        materials=chosen.materials,
        rim=rim,
        outer=surfaces.outer,
        inner=surfaces.inner,
        numbers=nodes,
    )


def _rim(mesh: OutsideMesh, source: SectionFile, drawn: Sheet, used: IntArray) -> IntArray:
    """Nodes of the section that are in the rim's set; CaseError where there are none."""
    on_faces = {name: used[_nodes_of(drawn, faces)] for name, faces in mesh.surfaces.items()}
    members = set_named(
        mesh, {**on_faces, **mesh.node_sets}, source.rim, ("mesh", "rim"), "node set"
    )
    rim = np.flatnonzero(np.isin(used, members))
    if not len(rim):
        file = Path(mesh.path).name
        held = f"its {len(members)} node(s) are none of the section's" if len(members) else "empty"
        message = f"node set {shown(source.rim)} of {file} holds nothing: {held}"
        raise CaseError([Problem(("mesh", "rim"), message)])
    return rim


def _nodes_of(drawn: Sheet, faces: IntArray) -> IntArray:
    """Nodes of the edges that are these faces of elements; an unnumbered face has none here."""
    row = {number: e for e, number in enumerate(drawn.numbers.tolist())}
    edges = [
        drawn.edges[row[number], face - 1]
        for number, face in faces.tolist()
        if number in row and face in (1, 2, 3, 4)
    ]
    return np.unique(np.array(edges, dtype=np.int64))


def _on_surface(
    mesh: OutsideMesh, source: SectionFile, drawn: Sheet, used: IntArray, edges: IntArray
) -> BoolArray:
    """Whether each edge (k,) is on the surface, or between nodes of the set, named `inner`."""
    assert source.inner is not None
    name = source.inner
    if any(other.casefold() == name.casefold() for other in mesh.surfaces):
        faces = set_named(mesh, mesh.surfaces, name, ("mesh", "inner"), "surface")
        pairs = _edges_of(drawn, faces)
        return np.array([(min(a, b), max(a, b)) in pairs for a, b in edges[:, :2].tolist()])
    sets = {**mesh.node_sets, **mesh.surfaces}
    members = set_named(mesh, sets, name, ("mesh", "inner"), "surface or node set")
    return np.asarray(np.isin(used, members)[edges[:, :2]].all(axis=1))


def _edges_of(drawn: Sheet, faces: IntArray) -> set[tuple[int, int]]:
    """The edges, by their two ends, that are faces of elements as the file numbers them."""
    row = {number: e for e, number in enumerate(drawn.numbers.tolist())}
    edges = np.sort(drawn.edges[:, :, :2], axis=2)
    return {
        (int(a), int(b))
        for number, face in faces.tolist()
        if number in row
        for a, b in (
            edges[row[number]] if face == ANY_FACE else edges[row[number], face - 1 : face]
        )
    }


def _through(source: SectionFile, chosen: Chosen, found: FloatArray) -> FloatArray:
    """Directions (e, 2) through the layers: as found, or as their set says."""
    through = found.copy()
    for i, region in enumerate(source.regions.values()):
        if region.through is not None:
            through[chosen.region == i] = np.array(region.through) / np.linalg.norm(region.through)
    return through


def _refuse_unclear(
    sheet: Sheet,
    clear: FloatArray,
    source: SectionFile,
    chosen: Chosen,
    oriented: Collection[str],
) -> None:
    """Raise CaseError for layers of which no edge tells how they lie."""
    laid = np.array([name in oriented for name in chosen.materials])
    layered = laid[chosen.material]
    unclear = layered & (clear < CLEAR)
    if unclear.any():
        e = int(np.argmax(unclear))
        name = list(source.regions)[chosen.region[e]]
        message = (
            f"{Path(sheet.path).name}: how the layers of element {sheet.numbers[e]} lie is not "
            f"clear, as its edges stand askew in the wall; give this set through = [dr, dy]"
        )
        raise CaseError([Problem(("mesh", "materials", name), message)])
