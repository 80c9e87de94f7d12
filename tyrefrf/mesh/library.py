"""Meshes in the formats that meshlane reads: Gmsh, MED, VTK, Nastran and others.

Meshlane 5.5 (a kept-up fork of meshio) is wrapped, as it calls sys.exit on what it cannot read,
prints, and forgets the numbers of nodes and elements: they are numbered from 1 in the order of
the file here, but for Gmsh's text files, whose own numbers are read beside it.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tyrefrf.arrays import IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.outside import Elements, OutsideMesh

TAGS = ("gmsh:physical", "cell_tags", "medit:ref", "nastran:ref", "cell_id", "material")
"""Cell data that number the sets of elements, in formats whose sets have no names."""

DIMENSIONS = {"vertex": 0, "line": 1, "triangle": 2, "quad": 2}
"""Of the kinds of elements; of all others 3."""


def read_by_meshlane(path: Path) -> OutsideMesh:
    """The mesh of a file, in its own unit and axes. Raises MeshError, naming the file."""
    mesh = _read(path)
    try:
        _refuse_absent(mesh, str(path))
        return _outside(mesh, path)
    except (AttributeError, TypeError, ValueError, IndexError, OverflowError) as error:
        raise MeshError(f"{path}: is damaged, or no such mesh: {error}") from error


def in_memory(mesh: Any, name: str) -> OutsideMesh:
    """A copy of a mesh as meshio and meshlane have it in memory, in its own unit and axes.

    mesh: with points, cells, point_sets, cell_sets and the like, as meshio.Mesh. Nodes and elements
    are numbered from 1 in their order. name: for messages, in place of a file's.
    Raises MeshError where it is no such mesh, or names nodes or elements that it has not.
    """
    try:
        _refuse_absent(mesh, name)
        return _outside(mesh, Path(name), numbered=False)
    except (AttributeError, TypeError, ValueError, IndexError) as error:
        raise MeshError(f"{name}: is no mesh as meshio.Mesh is one: {error}") from error


def _refuse_absent(mesh: Any, name: str) -> None:
    """Raise MeshError where a mesh names what it has not, or a point is nowhere."""
    if not np.isfinite(mesh.points).all():
        raise MeshError(f"{name}: a point is not finite")
    n = len(mesh.points)
    named = [(f"cells of {block.type}", "point", block.data, n) for block in mesh.cells]
    named += [(f"point set {key!r}", "point", nodes, n) for key, nodes in mesh.point_sets.items()]
    named += [
        (f"cell set {key!r}", f"{block.type} of its block", part, len(block.data))
        for key, parts in mesh.cell_sets.items()
        for block, part in zip(mesh.cells, parts, strict=False)
        if part is not None
    ]
    for where, what, members, size in named:
        places = np.asarray(members)
        if wrong := places[(places < 0) | (places >= size)].tolist():
            words = f"no {what} is {wrong[0]}; there are 0 to {size - 1}"
            raise MeshError(f"{name}: {where}: {words}")


def _outside(mesh: Any, path: Path, *, numbered: bool = True) -> OutsideMesh:
    """Meshlane's mesh as ours. numbered: whether the file may have numbers of its own."""
    blocks = [(block.type, np.array(block.data, dtype=np.int64)) for block in mesh.cells]
    blocks = [(kind, nodes) for kind, nodes in blocks if len(nodes)]
    if not blocks:
        raise MeshError(f"{path}: holds no elements")
    first = np.cumsum([0, *(len(nodes) for _, nodes in blocks)])
    n_elements = int(first[-1])
    numbers = _numbers(path, "Elements", n_elements) if numbered else 1 + np.arange(n_elements)
    elements = tuple(
        Elements(kind, nodes, numbers[start : start + len(nodes)])
        for (kind, nodes), start in zip(blocks, first[:-1].tolist(), strict=True)
    )
    points = np.asarray(mesh.points, dtype=float)
    points = np.hstack([points, np.zeros((len(points), 3 - points.shape[1]))])
    n_points = len(points)
    return OutsideMesh(
        path=str(path),
        points=points,
        numbers=_numbers(path, "Nodes", n_points) if numbered else 1 + np.arange(n_points),
        elements=elements,
        element_sets={name: numbers[members - 1] for name, members in _element_sets(mesh)},
        node_sets=_node_sets(mesh),
        surfaces={},
    )


def _read(path: Path) -> Any:
    """Meshlane's mesh."""
    try:
        import meshlane
    except ImportError:
        raise MeshError(
            f'{path}: meshes other than .inp need meshlane: pip install "tyrefrf[mesh]"'
        ) from None
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            mesh = meshlane.read(path)
    except (Exception, SystemExit) as error:  # any: a bad file brings out whatever NumPy raises
        words = " ".join(said.getvalue().split()) if isinstance(error, SystemExit) else str(error)
        raise MeshError(f"{path}: meshlane cannot read it: {words or repr(error)}") from error
    if said.getvalue().strip():
        words = " ".join(said.getvalue().split())
        raise MeshError(f"{path}: meshlane does not read all of it: {words}")
    return mesh


def _element_sets(mesh: Any) -> Iterator[tuple[str, IntArray]]:
    """Elements, counted from 1, by set: named, or else by the numbers they are tagged with."""
    sizes = [len(block.data) for block in mesh.cells]
    first = np.cumsum([1, *sizes])
    for name, members in mesh.cell_sets.items():
        if not name.startswith("gmsh:") and len(members) == len(sizes):
            parts = [
                start + np.asarray(part, dtype=np.int64)
                for start, part in zip(first, members, strict=False)
                if part is not None
            ]
            yield name, np.concatenate(parts)
    names = {(int(tag), int(dim)): name for name, (tag, dim) in mesh.field_data.items()}
    if set(names.values()) & set(mesh.cell_sets):
        return  # the format's own sets; their tags say the same, but only the first of several
    dims = [DIMENSIONS.get(block.type.rstrip("0123456789"), 3) for block in mesh.cells]
    dim = np.repeat(dims, sizes)
    for data in (mesh.cell_data[name] for name in TAGS if name in mesh.cell_data):
        tag = np.concatenate([np.asarray(part, dtype=np.int64).ravel() for part in data])
        for value, d in sorted(set(zip(tag.tolist(), dim.tolist(), strict=True))):
            members = 1 + np.flatnonzero((tag == value) & (dim == d))
            yield names.get((value, d), str(value)), members
        return


def _node_sets(mesh: Any) -> dict[str, IntArray]:
    """Places of nodes by set, where the format has them."""
    return {
        name: np.unique(np.asarray(members, dtype=np.int64))
        for name, members in mesh.point_sets.items()
    }


def _numbers(path: Path, section: str, count: int) -> IntArray:
    """Numbers of Gmsh's nodes or elements, where its file is text; else from 1 on."""
    numbers: list[int] = []
    if path.suffix.lower() == ".msh":
        text = path.read_bytes().decode("ascii", errors="replace")
        version, is_binary = text.partition("$MeshFormat")[2].split()[:2]
        if is_binary == "0":
            body = text.partition(f"${section}\n")[2].partition(f"$End{section}")[0]
            rows = [row.split() for row in body.splitlines()[1:]]
            numbers = list(_of_blocks(rows) if version.startswith("4") else _firsts(rows))
    return np.array(numbers) if len(numbers) == count else 1 + np.arange(count)


def _of_blocks(rows: list[list[str]]) -> Iterator[int]:
    """Numbers in version 4, block by block: after a header with their count.

    In a block of nodes all numbers come before the coordinates.
    """
    k = 0
    while k < len(rows):
        n = int(rows[k][3])
        yield from _firsts(rows[k + 1 : k + 1 + n])
        k += 1 + n * (2 if n and len(rows[k + 1]) == 1 else 1)


def _firsts(rows: list[list[str]]) -> Iterator[int]:
    return (int(row[0]) for row in rows)
