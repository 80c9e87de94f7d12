"""A case's own matrices: read from their files, checked, and its loads and probes placed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TypeVar, get_args

import numpy as np
from scipy.sparse import csc_array

from tyrefrf.arrays import IntArray
from tyrefrf.case import AtNode, Case, HubProbe, Matrices, Point, RegionProbe, files_of
from tyrefrf.case.faults import did_you_mean
from tyrefrf.case.places import Direction
from tyrefrf.errors import CaseError, Key, MeshError, Problem
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.fem.brought import UNIT_SYSTEMS, BroughtMatrices, CellFiles, Sets, bring
from tyrefrf.fem.columns import node_column
from tyrefrf.fem.matrix_files import read_dofs, read_matrix
from tyrefrf.fem.soundness import Soundness, examined
from tyrefrf.mesh.node_cell import NodeCell
from tyrefrf.mesh.node_files import read_node_set, read_nodes
from tyrefrf.mesh.outside import OutsideMesh
from tyrefrf.mesh.place import Place
from tyrefrf.solvers.inertia import negative_masses
from tyrefrf.solvers.stability import instability
from tyrefrf.study.memory import check_fits, need_of_files

Read = TypeVar("Read")


@dataclass(frozen=True, slots=True, eq=False)
class BroughtCell:
    """A case's matrices in the program's dofs, and what was found of them.

    files: what each of the matrices was like, in words.
    """

    matrices: BroughtMatrices
    soundness: Soundness
    files: tuple[str, ...]

    @property
    def facts(self) -> tuple[str, ...]:
        """What was read and checked, in words."""
        found, sound = self.matrices, self.soundness
        said = [*self.files]
        if found.sections.exchanged:
            said.append(
                "left and right are named the other way round: theta grows from x towards z"
            )
        said.append(
            f"sections: {found.nodes.n_face} nodes fall on each other within "
            f"{1e3 * found.sections.gap:.1e} mm"
        )
        if found.n_inner:
            said.append(f"{found.n_inner} unknowns belong to no node; they stay inside the cell")
        if found.left_out:
            said.append(f"{found.left_out} nodes with coordinates are not in the matrices")
        said.append(
            f"rigid motions: K u is at most {sound.translation:.1e} of |K| |u| for translations, "
            f"{sound.rotation:.1e} for rotations"
        )
        return tuple(said)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What may be meant so, and may be a mistake."""
        held = "K has no rows for the rim, which was held: its reaction is not known"
        return (*self.soundness.warnings(), *([] if self.matrices.rim_whole else [held]))


def bring_matrices(case: Case) -> BroughtCell:
    """Read and check the matrices of a case.

    Raises CaseError with every file that is wrong, or at [matrices] where they do not fit.
    """
    assert case.matrices is not None
    check_fits(need_of_files([file.path for file in files_of(case)]))
    files = _read(case.matrices, case.directory)
    try:
        matrices = bring(files, 2.0 * np.pi / case.cell.n_cells)
        cell = matrices.cell(case.matrices.K, case.damping)
        sound = examined(cell, matrices.nodes)
    except MeshError as error:
        raise CaseError([Problem(("matrices",), str(error))]) from error
    _check_stable(cell, case.cell.n_cells)
    _check_hub(case, matrices)
    return BroughtCell(matrices, sound, tuple(_words(files)))


def _read(source: Matrices, directory: Path) -> CellFiles:
    """What all files of a [matrices] table hold. Raises CaseError with all that are wrong."""
    files = _Reading(directory)
    units = UNIT_SYSTEMS[source.units]
    K = {part: files.read(("K", part, "file"), K.file, read_matrix) for part, K in source.K.items()}
    others = {
        name: files.read((name,), file, read_matrix)
        for name in ("M", "C", "K_G")
        if (file := getattr(source, name))
    }
    dofs = files.read(("dofs",), source.dofs, read_dofs) if source.dofs else None
    nodes = partial(read_nodes, length=units.length, axis=source.axis)
    mesh = files.read(("nodes",), source.nodes, nodes)
    sets: dict[str, IntArray] = {key: np.empty(0, np.int64) for key in ("left", "right", "rim")}
    for key, name in source.sets.items():
        reader = partial(_named_set, name, mesh) if source.has_named_sets else read_node_set
        found = files.read((key,), name, reader)
        sets[key] = sets[key] if found is None else found
    files.check()
    assert mesh is not None
    return CellFiles(
        stiffness=_whole(K),
        others=_whole(others),
        dofs=dofs,
        mesh=mesh,
        sets=Sets(**sets),
        units=units,
        axis=source.axis,
        is_cylindrical=source.directions == "cylindrical",
    )


class _Reading:
    """Reads the files of a case and keeps what is wrong with any."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._problems: list[Problem] = []

    def read(self, key: Key, file: str, reader: Callable[[Path], Read]) -> Read | None:
        """What a file holds, None where it is wrong."""
        try:
            return reader(self._directory / file)
        except MeshError as error:
            self._problems.append(Problem(("matrices", *key), str(error)))
            return None

    def check(self) -> None:
        """Raise CaseError with everything that was wrong."""
        if self._problems:
            raise CaseError(self._problems)


def _named_set(name: str, mesh: OutsideMesh | None, _: Path) -> IntArray:
    """The numbers of a node set of a mesh file; none where that file has an error of its own."""
    if mesh is None:
        return np.empty(0, np.int64)
    if name not in mesh.node_sets:
        there = ", ".join(mesh.node_sets) or "none"
        hint = did_you_mean(name, mesh.node_sets)
        raise MeshError(f"{mesh.path} has no node set {name!r}; there are {there}{hint}")
    return mesh.numbers[mesh.node_sets[name]]


def _whole(read: Mapping[str, Read | None]) -> dict[str, Read]:
    """What was read, when nothing was wrong."""
    return {name: value for name, value in read.items() if value is not None}


def _words(files: CellFiles) -> Iterator[str]:
    """What each matrix was like."""
    K = files.stiffness
    named = {f"K.{part}" if len(K) > 1 else "K": A for part, A in K.items()}
    for name, A in (named | dict(files.others)).items():
        shape = (
            f"its {A.triangle} triangle made whole"
            if A.triangle
            else f"symmetric to {A.asymmetry:.1e}"
        )
        yield f"{name}: {A.path.name}, {A.size} rows, {A.matrix.nnz} entries, {shape}"


def _check_stable(cell: CellMatrices, n_cells: int) -> None:
    """Raise CaseError where static stiffness or mass has a negative direction at some order."""
    found = instability(cell, n_cells)
    if found is not None:
        bears = f", though it bears {found.share:.3g} of K_G" if found.share else ""
        message = (
            f"the static stiffness is {found.words}: such a tyre is not stable{bears}; see to K, "
            "and K_G"
        )
        raise CaseError([Problem(("matrices", "K"), message)])
    if lacking := negative_masses(cell, n_cells):
        message = (
            "M is no mass: some motions of circumferential order "
            f"{', '.join(map(str, lacking))} would have negative kinetic energy"
        )
        raise CaseError([Problem(("matrices", "M"), message)])


def _check_hub(case: Case, matrices: BroughtMatrices) -> None:
    """Raise CaseError where the force on the rim is asked for and cannot be known."""
    for i, probe in enumerate(case.probes):
        if isinstance(probe, HubProbe) and not (len(matrices.nodes.rim) and matrices.rim_whole):
            message = "the matrices have no rows for the rim; write them without its supports"
            if not len(matrices.nodes.rim):
                message = "nothing is held; name the rim's nodes in matrices.rim"
            raise CaseError([Problem(("probes", i, "kind"), message)])


class NodeFinder:
    """Finds loads and probes on nodes by the numbers that their own file gives them."""

    def __init__(self, nodes: NodeCell) -> None:
        self.nodes = nodes
        self._places: dict[int, list[int]] = {}
        for place, number in enumerate(nodes.numbers.tolist()):
            self._places.setdefault(number, []).append(place)

    def find_all(self, point: Point | RegionProbe) -> list[tuple[Place, csc_array]]:
        """The one place of a point. Raises MeshError as `find`, and for a region."""
        if isinstance(point, RegionProbe):
            raise MeshError("brought matrices have no surface, and hence no region of it")
        return [self.find(point)]

    def all_directions(self, point: Point) -> Iterator[csc_array]:
        """The columns of a place along r, y and theta. Raises MeshError as `find`."""
        for direction in get_args(Direction):
            yield self.find(point.model_copy(update={"direction": direction}))[1]

    def find(self, point: Point) -> tuple[Place, csc_array]:
        """The node that stands nearest to the angle, and its column over the ring's dofs.

        Raises MeshError where there is no such node, or it is on the rim, which is fixed.
        """
        if not isinstance(point, AtNode) or point.node is None:
            raise MeshError(
                'brought matrices have no surface; use kind = "node" with the node\'s number'
            )
        if point.node not in self._places:
            raise MeshError(f"node {point.node} is not in the matrices")
        nodes, place = self.nodes, self._places[point.node][0]
        if place in nodes.rim:
            raise MeshError(
                f"{point.name!r} lies on the rim, which is fixed; move it off the rim "
                'or, for the force on the rim, use a probe of kind = "hub"'
            )
        r, y, theta = (float(x) for x in nodes.points[place])
        n_cells = round(2.0 * np.pi / nodes.sector_angle)
        cell = round((np.deg2rad(point.angle) - theta) / nodes.sector_angle) % n_cells
        if place >= nodes.n_own:  # of the right section: the same node of the next cell's left one
            place, cell = place - nodes.n_own, (cell + 1) % n_cells
        angle = float(nodes.points[place, 2] + cell * nodes.sector_angle)
        angle = round(angle, 12) % (2.0 * np.pi)  # 0, not 1e-14, where a cell begins
        found = Place(point.name, "node", "", float("nan"), r, y, angle, point.direction)
        found = replace(found, sensor_mass=getattr(point, "sensor_mass", None) or 0.0)
        return found, node_column(nodes, cell, place, point.direction)
