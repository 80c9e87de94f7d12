"""Sets of a mesh file by the names that a case calls them, and what of the mesh they choose."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.arrays import IntArray
from tyrefrf.case.faults import did_you_mean, shown
from tyrefrf.case.laid import laid_name
from tyrefrf.errors import CaseError, Key, MeshError, Problem
from tyrefrf.mesh.outside import NAMING, Elements, OutsideMesh

if TYPE_CHECKING:
    from tyrefrf.case import MeshFile

ADVICE = {
    "triangle": "mesh with quadrilaterals (Gmsh: Mesh.RecombineAll = 1)",
    "triangle6": "mesh with quadrilaterals (Gmsh: Mesh.RecombineAll = 1)",
    "quad9": "leave out the nodes in the middle (Gmsh: Mesh.SecondOrderIncomplete = 1)",
    "hexahedron27": "leave out the nodes in the middle (Gmsh: Mesh.SecondOrderIncomplete = 1)",
    "tetra": "mesh with bricks",
    "tetra10": "mesh with bricks",
    "wedge": "mesh with bricks",
    "wedge15": "mesh with bricks",
}
"""What to do about elements that are not read."""


@dataclass(frozen=True, slots=True, eq=False)
class Chosen:
    """The elements of a mesh that are the tyre: all of one kind.

    nodes: (e, a) places in the mesh's points. numbers: (e,) as the file numbers them.
    region: (e,) index of the element set, in the order of [mesh.materials].
    material: (e,) index into `materials`, the names as in `Case.laid_materials`.
    """

    kind: str
    nodes: IntArray
    numbers: IntArray
    region: IntArray
    material: IntArray
    materials: tuple[str, ...]


def set_named(
    mesh: OutsideMesh, sets: Mapping[str, IntArray], name: str, key: Key, what: str
) -> IntArray:
    """The members of a set; capital letters count only where nothing else tells sets apart.

    what: "element set", for the message. Raises CaseError at the key where there is none.
    """
    alike = [other for other in sets if other.casefold() == name.casefold()]
    if name in sets or len(alike) == 1:
        return sets[name if name in sets else alike[0]]
    there = f"there are {', '.join(sets)}" if sets else "there are none"
    file = Path(mesh.path).name
    message = f"{file} has no {what} {shown(name)}; {there}{did_you_mean(name, sets)}"
    raise CaseError([Problem(key, message)])


def choose(mesh: OutsideMesh, source: MeshFile, kinds: tuple[str, ...]) -> Chosen:
    """The elements with a material; every one of the file must have one, or be left out.

    kinds: that are wanted. Raises CaseError at the key for unknown sets and for elements in none
    of them, MeshError, naming the element, for those in two, of another kind, or of several.
    """
    left_out = _members(mesh, source.leave_out, "leave_out")
    sets = {
        name: set_named(mesh, mesh.element_sets, name, ("mesh", "materials", name), "element set")
        for name in source.regions
    }
    blocks = [_without(block, left_out) for block in mesh.elements if block.kind not in NAMING]
    owners = [_owners(mesh, block, sets) for block in blocks]
    for block, owner in zip(blocks, owners, strict=True):
        _refuse_unowned(mesh, block, owner)
    of_kind = [i for i, block in enumerate(blocks) if len(block.numbers)]
    for i in of_kind:
        _refuse_kind(mesh, blocks[i], kinds)
    found = sorted({blocks[i].kind for i in of_kind}, key=kinds.index)
    if len(found) != 1:
        _refuse_number_of_kinds(mesh, [blocks[i] for i in of_kind], kinds)
    region = np.concatenate([owners[i] for i in of_kind])
    _refuse_empty(mesh, list(sets), region)
    names = [laid_name(entry) for entry in source.regions.values()]
    materials = tuple(dict.fromkeys(names))
    return Chosen(
        kind=found[0],
        nodes=np.concatenate([blocks[i].nodes for i in of_kind]),
        numbers=np.concatenate([blocks[i].numbers for i in of_kind]),
        region=region,
        material=np.array([materials.index(name) for name in names])[region],
        materials=materials,
    )


def _members(mesh: OutsideMesh, names: tuple[str, ...], key: str) -> IntArray:
    """Numbers of the elements in any of these sets."""
    found = [
        set_named(mesh, mesh.element_sets, name, ("mesh", key, i), "element set")
        for i, name in enumerate(names)
    ]
    return np.unique(np.concatenate([np.empty(0, dtype=np.int64), *found]))


def _without(block: Elements, numbers: IntArray) -> Elements:
    kept = ~np.isin(block.numbers, numbers)
    return Elements(block.kind, block.nodes[kept], block.numbers[kept])


def _owners(mesh: OutsideMesh, block: Elements, sets: Mapping[str, IntArray]) -> IntArray:
    """Index (e,) of the set that every element is in, -1 for none."""
    owner = np.full(len(block.numbers), -1)
    for i, (name, members) in enumerate(sets.items()):
        inside = np.isin(block.numbers, members)
        if np.any(twice := inside & (owner >= 0)):
            e = int(np.argmax(twice))
            raise MeshError(
                f"{mesh.path}: element {block.numbers[e]} is in two sets of [mesh.materials], "
                f"'{list(sets)[owner[e]]}' and '{name}'"
            )
        owner[inside] = i
    return owner


def _refuse_unowned(mesh: OutsideMesh, block: Elements, owner: IntArray) -> None:
    bare = block.numbers[owner < 0]
    if len(bare):
        others = f" and {len(bare) - 1} more have" if len(bare) > 1 else " has"
        within = [name for name, found in mesh.element_sets.items() if bare[0] in found]
        where = f"{Path(mesh.path).name}: element {bare[0]} ({block.kind}){others} no material"
        message = (
            f"{where}; it is in the set(s) {', '.join(within)}: give that a material, or name it "
            "in mesh.leave_out"
        )
        raise CaseError([Problem(("mesh", "materials"), message)])


def _refuse_kind(mesh: OutsideMesh, block: Elements, kinds: tuple[str, ...]) -> None:
    if block.kind not in kinds:
        advice = ADVICE.get(block.kind, f"elements may be {' or '.join(kinds)}")
        message = f"element {block.numbers[0]} is a {block.kind}, which is not read; {advice}"
        raise MeshError(f"{mesh.path}: {message}")


def _refuse_number_of_kinds(
    mesh: OutsideMesh, blocks: list[Elements], kinds: tuple[str, ...]
) -> None:
    if not blocks:
        raise MeshError(f"{mesh.path}: holds no {' or '.join(kinds)}")
    each = {block.kind: f"element {block.numbers[0]} is a {block.kind}" for block in blocks}
    message = ", ".join(each.values())
    raise MeshError(f"{mesh.path}: {message}: linear and quadratic elements do not mix")


def _refuse_empty(mesh: OutsideMesh, names: list[str], region: IntArray) -> None:
    for i, name in enumerate(names):
        if i not in region:
            message = f"element set {shown(name)} of {Path(mesh.path).name} holds no element here"
            raise CaseError([Problem(("mesh", "materials", name), message)])
