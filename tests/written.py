"""Sections written as other programs write them: shuffled, renumbered, in other units and axes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.mesh.section import SectionMesh

PER_METRE = {"m": 1.0, "mm": 1e3, "in": 1.0 / 0.0254}
COLUMNS = {"x": (1, 0, 2), "y": (0, 1, 2), "z": (0, 2, 1)}
"""Where r, y and 0 stand in the file for each axle."""


@dataclass(frozen=True, slots=True, eq=False)
class Written:
    """A section as it stands in a file.

    numbers: of its nodes, in the section's order. points: (n, 3) coordinates in the same order.
    quads: places of the nodes in the section, each from another corner and way round.
    """

    section: SectionMesh
    numbers: IntArray
    points: FloatArray
    quads: IntArray
    nodes_first: IntArray
    elements_first: IntArray

    @property
    def sets(self) -> dict[str, IntArray]:
        """Places of the elements by material, in capital letters."""
        names = [name.upper() for name in self.section.materials]
        return {n: np.flatnonzero(self.section.material == i) for i, n in enumerate(names)}


def as_drawn(section: SectionMesh, unit: str = "mm", axis: str = "y") -> Written:
    """The section in its own order, numbered from 1."""
    n, e = section.n_nodes, section.n_elements
    return Written(
        section,
        1 + np.arange(n),
        _points(section, unit, axis),
        section.quads,
        *map(np.arange, (n, e)),
    )


def shuffled(section: SectionMesh, seed: int, unit: str = "mm", axis: str = "y") -> Written:
    """The section with nodes, elements, starting corners and senses at random."""
    rng = np.random.default_rng(seed)
    n, e = section.n_nodes, section.n_elements
    corner = (rng.integers(4, size=e)[:, None] + np.arange(4)) % 4
    quads = np.take_along_axis(section.quads[:, :4], corner, axis=1)
    if section.quads.shape[1] == 8:
        quads = np.hstack([quads, np.take_along_axis(section.quads[:, 4:], corner, axis=1)])
    backwards = rng.random(e) < 0.5
    quads[backwards] = quads[backwards][:, [0, 3, 2, 1, 7, 6, 5, 4][: quads.shape[1]]]
    return Written(
        section,
        5 + 3 * rng.permutation(n),
        _points(section, unit, axis),
        quads,
        rng.permutation(n),
        rng.permutation(e),
    )


def _points(section: SectionMesh, unit: str, axis: str) -> FloatArray:
    flat = np.column_stack([section.points, np.zeros(section.n_nodes)])
    return PER_METRE[unit] * flat[:, COLUMNS[axis]]


def inp_text(written: Written, *more: str) -> str:
    """An Abaqus deck: CAX4 or CAX8 by material, sets RIM and INNER, and more lines."""
    of = written.numbers
    lines = ["** a section", "*Heading", "made for a test", "*NODE"]
    lines += [f"{of[i]}, {_row(written.points[i])}" for i in written.nodes_first]
    kind = {4: "CAX4R", 8: "CAX8"}[written.quads.shape[1]]
    for name, members in written.sets.items():
        lines += [f"*Element, type={kind}, elset={name}"]
        for e in written.elements_first[np.isin(written.elements_first, members)]:
            lines += [f"{e + 1}, {', '.join(map(str, of[written.quads[e]]))}"]
    lines += ["*NSET, NSET=RIM", *(f"{of[i]}," for i in written.section.rim)]
    lines += ["*SURFACE, NAME=LINER, TYPE=ELEMENT"]
    lines += [f"{e + 1}, S{face}" for e, face in _faces(written, written.section.inner)]
    return "\n".join([*lines, *more, "*MATERIAL, NAME=X", "*ELASTIC", "1., 0.3", ""])


def _faces(written: Written, edges: IntArray) -> list[tuple[int, int]]:
    """Elements, and their faces as written, that have these edges."""
    wanted = {frozenset(edge) for edge in edges[:, :2].tolist()}
    return [
        (e, face + 1)
        for e, quad in enumerate(written.quads[:, :4].tolist())
        for face in range(4)
        if frozenset((quad[face], quad[(face + 1) % 4])) in wanted
    ]


def msh_text(written: Written) -> str:
    """A Gmsh file, version 4.1: physical surfaces by material, physical curves RIM and LINER."""
    of, section = written.numbers, written.section
    e = section.quads.shape[1] // 4  # order of the elements
    curves = {"RIM": _on_rim(section), "LINER": section.inner}
    names = [*((1, name) for name in curves), *((2, name) for name in written.sets)]
    rows = {"RIM": curves["RIM"], "LINER": curves["LINER"]}
    rows |= {name: written.quads[members] for name, members in written.sets.items()}
    box = "0 0 0 1 1 0"
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    lines += [f'{dim} {tag} "{name}"' for tag, (dim, name) in enumerate(names, start=11)]
    lines += ["$EndPhysicalNames", "$Entities", f"0 2 {len(written.sets)} 0"]
    lines += [f"{tag} {box} 1 {10 + tag} 0" for tag, _ in enumerate(names, start=1)]
    lines += ["$EndEntities", "$Nodes", f"1 {len(of)} {of.min()} {of.max()}", f"2 3 0 {len(of)}"]
    lines += [str(of[i]) for i in written.nodes_first]
    lines += [_row(written.points[i], " ") for i in written.nodes_first]
    n = sum(map(len, rows.values()))
    lines += ["$EndNodes", "$Elements", f"{len(rows)} {n} 1 {n}"]
    number = 100
    for tag, (dim, name) in enumerate(names, start=1):
        kind = {(1, 1): 1, (1, 2): 8, (2, 1): 3, (2, 2): 16}[dim, e]
        lines += [f"{dim} {tag} {kind} {len(rows[name])}"]
        for row in rows[name]:
            number += 1
            lines += [f"{number} {' '.join(map(str, of[row]))}"]
    return "\n".join([*lines, "$EndElements", ""])


def _on_rim(section: SectionMesh) -> IntArray:
    """The edges (k, 2) or (k, 3) of the end faces, on the rim."""
    q = section.quads
    ends = [q[:, :4], np.roll(q[:, :4], -1, axis=1), *([q[:, 4:]] if q.shape[1] == 8 else [])]
    edges = np.stack(ends, axis=2).reshape(-1, len(ends))
    return edges[np.isin(edges, section.rim).all(axis=1)]


def cdb_text(written: Written) -> str:
    """An Ansys archive: PLANE182 or PLANE183, materials from 1, the component RIM."""
    of, n_nodes = written.numbers, written.quads.shape[1]
    lines = [
        "/PREP7",
        f"ET,1,{ {4: 182, 8: 183}[n_nodes] }",
        f"NBLOCK,6,SOLID,{of.max()},{len(of)}",
    ]
    lines += ["(3i9,6e24.16e3)"]
    for i in written.nodes_first[np.argsort(of[written.nodes_first])]:
        lines += [f"{of[i]:9d}{0:9d}{0:9d}" + "".join(f"{x:24.16E}" for x in written.points[i])]
    lines += ["N,R5.3,LOC,       -1,", f"EBLOCK,19,SOLID,{len(written.quads)},{len(written.quads)}"]
    lines += ["(19i9)"]
    for e in written.elements_first:
        head = [written.section.material[e] + 1, 1, 1, 1, 0, 0, 0, 0, n_nodes, 0, e + 1]
        lines += ["".join(f"{x:9d}" for x in [*head, *of[written.quads[e]]])]
    rim = of[written.section.rim]
    lines += ["       -1", f"CMBLOCK,RIM,NODE,{len(rim):8d}", "(8i10)"]
    lines += ["".join(f"{x:10d}" for x in rim[k : k + 8]) for k in range(0, len(rim), 8)]
    return "\n".join([*lines, "FINISH", ""])


def _row(point: FloatArray, between: str = ", ") -> str:
    return between.join(repr(float(x)) for x in point)


def write(folder: Path, name: str, text: str) -> Path:
    """A file of that text."""
    path = folder / name
    path.write_text(text)
    return path
