"""Meshes in Ansys' .cdb format (CDWRITE), by mapdl-archive; meshlane drops their materials.

Components become sets by their names, and the elements of material n the set `MAT n`.
"""

from __future__ import annotations

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np

from tyrefrf.arrays import IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.outside import Elements, OutsideMesh

KINDS = {
    **dict.fromkeys((25, 42, 182), ("quad", 4)),
    **dict.fromkeys((82, 83, 183), ("quad8", 8)),
    **dict.fromkeys((45, 185), ("hexahedron", 8)),
    **dict.fromkeys((95, 186), ("hexahedron20", 20)),
}
"""Meshio's kind of element and its nodes, by the number of Ansys' type."""

HEADER = 10
"""Numbers before an element's nodes: its material the first, its type the second, and"""
NUMBER = 8
"""its own number."""


def read_cdb(path: Path) -> OutsideMesh:
    """The mesh of a .cdb file, in its own unit and axes. Raises MeshError, naming the file."""
    archive = _read(path)
    try:
        return _outside(archive, path)
    except (AttributeError, IndexError, KeyError, OverflowError, TypeError, ValueError) as error:
        raise MeshError(f"{path}: is damaged: {error!r}") from error


def _outside(archive: Any, path: Path) -> OutsideMesh:
    """What mapdl-archive has read as ours."""
    numbers = np.asarray(archive.nnum, dtype=np.int64)
    place = {number: i for i, number in enumerate(numbers.tolist())}
    types = dict(np.asarray(archive.ekey)[:, :2].tolist())
    rows: dict[str, tuple[list[int], list[IntArray]]] = {}
    material: dict[int, list[int]] = {}
    for row in archive.elem:
        number, stuff, kind = int(row[NUMBER]), int(row[0]), types.get(int(row[1]), 0)
        name, n_nodes = KINDS.get(kind, (f"Ansys type {kind}", 0))
        nodes = row[HEADER : HEADER + n_nodes]
        lost = [node for node in nodes.tolist() if node not in place]
        if lost or len(nodes) < n_nodes:
            node = lost[0] if lost else 0
            message = f"has node {node}, which the file does not define" if node else "lacks nodes"
            raise MeshError(f"{path}: element {number} {message}")
        found = rows.setdefault(name, ([], []))
        found[0].append(number)
        found[1].append(np.array([place[node] for node in nodes.tolist()], dtype=np.int64))
        material.setdefault(stuff, []).append(number)
    if not rows:
        raise MeshError(f"{path}: holds no elements (only EBLOCK records with SOLID are read)")
    return OutsideMesh(
        path=str(path),
        points=np.asarray(archive.nodes, dtype=float)[:, :3],
        numbers=numbers,
        elements=tuple(
            Elements(kind, np.array(nodes).reshape(len(nodes), -1), np.array(elements))
            for kind, (elements, nodes) in rows.items()
        ),
        element_sets={
            **{f"MAT {n}": np.array(members) for n, members in sorted(material.items())},
            **{name: np.array(found) for name, found in archive.element_components.items()},
        },
        node_sets={
            name: np.array([place[node] for node in found.tolist() if node in place])
            for name, found in archive.node_components.items()
        },
        surfaces={},
    )


def _read(path: Path) -> Any:
    try:
        from mapdl_archive import Archive
    except ImportError:
        message = 'a .cdb file needs mapdl-archive: pip install "tyrefrf[ansys]"'
        raise MeshError(f"{path}: {message}") from None
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            archive = Archive(path, parse_vtk=False)
            assert len(archive.nodes) == len(archive.nnum)
            assert len(archive.elem) >= 0
    except (Exception, SystemExit) as error:  # any: what the file lacks shows as whatever it does
        raise MeshError(f"{path}: mapdl-archive cannot read it: {error!r}") from error
    return archive
