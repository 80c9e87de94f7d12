"""A case's mesh file: read, revolved or taken as a cell, and what was read in words."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from tyrefrf.case import Case, CellFile, MeshFile, SectionFile, files_of, load_case
from tyrefrf.errors import CaseError, MeshError, Problem
from tyrefrf.fem.constitutive import constitutive
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.mesh.cell import CellMesh, revolve
from tyrefrf.mesh.library import in_memory
from tyrefrf.mesh.outside import OutsideMesh
from tyrefrf.mesh.outside_cell import outside_cell
from tyrefrf.mesh.outside_section import outside_section
from tyrefrf.mesh.reader import as_said, read_mesh
from tyrefrf.study.memory import check_fits, need_of_cell, need_of_files


def with_mesh(case: Case | str | Path, mesh: Any) -> Case:
    """A case whose mesh is in memory: `tyrefrf.run(tyrefrf.with_mesh("cell.toml", mesh))`.

    mesh: a meshio.Mesh or meshlane.Mesh, or what has its points, cells, point_sets and cell_sets;
    it is copied. It is taken in place of the file of the case's [mesh], whose name remains for
    messages and need not exist; unit, axis, sets and materials are as that table says. Nodes and
    elements count from 1 in their order. The case's hash has a digest of the mesh.
    Raises CaseError for a case that is wrong or has no [mesh], MeshError for what is no mesh.
    """
    if not isinstance(case, Case):
        case = load_case(case)
    if case.mesh is None:
        message = "missing; it says what the mesh's unit, axis and sets are"
        raise CaseError([Problem(("mesh",), message)])
    return case.holding(in_memory(mesh, case.mesh.file))


def mesh_of_file(case: Case) -> CellMesh:
    """The cell that a case's [mesh] describes.

    Raises CaseError at the key, where it cannot be made of the file; MeshError of a mesh in memory.
    """
    try:
        return _cell_of_file(case)
    except MeshError as error:
        if case.held_mesh is not None:
            raise
        raise CaseError([Problem(("mesh", "file"), str(error))]) from error


def _cell_of_file(case: Case) -> CellMesh:
    source = _source(case)
    outside = _read(case)
    sector_angle = 2.0 * np.pi / case.cell.n_cells
    if isinstance(source, CellFile):
        check_fits(need_of_cell(case, sum(len(block.numbers) for block in outside.elements)))
        cell = outside_cell(outside, source, sector_angle, _oriented(case))
        _refuse_element(case, cell.bricks.shape[1], cell.bricks.shape[1])
        return cell
    section = outside_section(outside, source, _oriented(case))
    n_nodes = section.quads.shape[1]
    _refuse_element(case, n_nodes, {4: 8, 8: 20}[n_nodes])
    check_fits(need_of_cell(case, section.n_elements * case.cell.elements_around))
    return revolve(section, sector_angle, case.cell.elements_around)


def described(case: Case) -> tuple[str, ...]:
    """What a case's mesh file holds, and what became of it, in lines."""
    source, outside = _source(case), _read(case)
    used = np.unique(np.concatenate([block.nodes.ravel() for block in outside.elements]))
    x, y, z = 1e3 * outside.points[used].T
    r = np.hypot(x, z)
    count: Counter[str] = Counter()
    for block in outside.elements:
        count[block.kind] += len(block.numbers)
    kinds = ", ".join(f"{n} {kind}" for kind, n in count.items())
    sets = [
        f"{name} {len(members)}{_made_of(source, name)}"
        for name, members in outside.element_sets.items()
    ]
    nodes = [f"{name} {len(members)}" for name, members in outside.node_sets.items()]
    surfaces = [f"{name} {len(members)}" for name, members in outside.surfaces.items()]
    found = {"sets of elements": sets, "sets of nodes": nodes, "surfaces": surfaces}
    return (
        f"{source.file}: {len(outside.points)} nodes, {kinds}; r {r.min():.4g} to {r.max():.4g} "
        f"mm, y {y.min():.4g} to {y.max():.4g} mm",
        *(f"{what}: {', '.join(names)}" for what, names in found.items() if names),
    )


def _source(case: Case) -> SectionFile | CellFile:
    assert case.mesh is not None  # who asks has seen to it
    return case.mesh


def _read(case: Case) -> OutsideMesh:
    if isinstance(case.held_mesh, OutsideMesh):
        return as_said(case.held_mesh, _source(case))
    files = [file for file in files_of(case) if file.key == ("mesh", "file")]
    for file in files:
        file.digest()  # so that what is not there is said at the key
    check_fits(need_of_files([file.path for file in files]))
    return read_mesh(files[0].path, _source(case))


def _made_of(source: MeshFile, name: str) -> str:
    return f" ({source.regions[name].material})" if name in source.regions else ""


def _oriented(case: Case) -> list[str]:
    """The materials that have to know how their layers lie."""
    return [
        name for name, stuff in case.laid_materials.items() if not constitutive(stuff).is_isotropic
    ]


def _refuse_element(case: Case, n_nodes: int, of_brick: int) -> None:
    """Raise CaseError where the case's element has not the nodes that a brick of the file has."""
    name = case.cell.element
    if ELEMENTS[name].n_nodes != of_brick:
        fit = [other for other, e in ELEMENTS.items() if e.n_nodes == of_brick]
        message = f"{name} does not fit {_source(case).file}, which has elements of {n_nodes} nodes"
        raise CaseError([Problem(("cell", "element"), f"{message}; use {' or '.join(fit)}")])
