"""What a case would compute, how finely, and what that would cost: known before it is solved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tyrefrf.case import Case
from tyrefrf.fem.constitutive import Constitutive, constitutive
from tyrefrf.fem.elements import ELEMENTS, Element
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.mesh.grooves import groove_layers, groove_rows
from tyrefrf.mesh.node_cell import NodeCell
from tyrefrf.results import read_measured
from tyrefrf.solvers import RingProblem
from tyrefrf.solvers.digits import too_few_digits
from tyrefrf.solvers.reasons import loose
from tyrefrf.study.choose import decided
from tyrefrf.study.cost import line_seconds, section_dofs
from tyrefrf.study.inflate import strained
from tyrefrf.study.local import pinned
from tyrefrf.study.memory import need_of_cell, need_of_run
from tyrefrf.study.model import Model, build_model
from tyrefrf.study.outside import described
from tyrefrf.study.resolution import Resolution, element_sizes, resolutions

START_UP = 3.0  # s: imports, worker processes, plots


@dataclass(frozen=True, slots=True)
class Estimate:
    """Sizes of the model, how finely it is meshed, and what solving would take.

    grooves: those of the tread, as they are meshed; "" without. mass: of the tyre [kg]; masses: by
    material. seconds: wall time. memory: of all processes together [bytes]. mesh_file: what was
    read from the case's mesh file, if it has one. matrices: what was found of those that the case
    brings.
    """

    section_nodes: int
    section_elements: int
    cell_nodes: int
    cell_dofs: int
    n_cells: int
    ring_nodes: int
    ring_dofs: int
    free_section_dofs: int
    grooves: str
    mass: float
    masses: dict[str, float]
    n_lines: int
    top_frequency: float
    n_loads: int
    n_probes: int
    n_sensors: int
    resolution: tuple[Resolution, ...]
    mesh_file: tuple[str, ...]
    warnings: tuple[str, ...]
    matrices: tuple[str, ...]
    solver: str
    seconds: float
    memory: float


@pinned
def estimate(case: Case, jobs: int) -> Estimate:
    """Mesh and assemble a case, solve nothing, and say what solving would take.

    Raises CaseError and MeshError as a run would.
    """
    read_measured(case.measured, case.directory)
    model = build_model(case)
    mesh, problem = model.mesh, model.problem
    case = decided(case, problem)[0]
    solver = case.solver
    lines = case.frequency.lines()
    look = _elements(case, model, lines[-1])
    return Estimate(
        section_nodes=mesh.n_face,
        section_elements=mesh.left.n_elements,
        cell_nodes=mesh.n_nodes,
        cell_dofs=problem.cell.n_dofs,
        n_cells=problem.n_cells,
        ring_nodes=mesh.n_own * problem.n_cells,
        ring_dofs=problem.n_ring_dofs,
        free_section_dofs=section_dofs(problem),
        grooves=_grooves(case),
        mass=look.mass,
        masses=look.masses,
        n_lines=len(lines),
        top_frequency=lines[-1],
        n_loads=len(model.loads),
        n_probes=len(model.probes),
        n_sensors=len(problem.sensors.mass) if problem.sensors else 0,
        resolution=look.resolution,
        mesh_file=described(case) if case.mesh is not None else (),
        warnings=(*look.warnings, *loose(problem), *too_few_digits(problem)),
        matrices=model.brought.facts if model.brought is not None else (),
        solver=solver.name,
        seconds=seconds_of_run(case, problem, jobs),
        memory=memory_of_run(case, model, jobs),
    )


def seconds_of_run(case: Case, problem: RingProblem, jobs: int) -> float:
    """Wall time [s] of solving all of a case's lines by its solver."""
    n_lines = len(case.frequency.lines())
    return START_UP + n_lines * line_seconds(case.solver.name, problem) / jobs


@dataclass(frozen=True, slots=True)
class _Look:
    """What there is to say of the elements, or of matrices in their place."""

    mass: float
    masses: dict[str, float]
    resolution: tuple[Resolution, ...]
    warnings: tuple[str, ...]


def _elements(case: Case, model: Model, top: float) -> _Look:
    """How finely the elements resolve waves at the top frequency [Hz], and what they weigh."""
    mesh = model.mesh
    if isinstance(mesh, NodeCell):
        assert model.brought is not None
        return _Look(model.brought.soundness.mass[1], {}, (), model.brought.warnings)
    laws = {name: constitutive(case.laid_materials[name]) for name in mesh.materials}
    resolution = resolutions(mesh, laws, top)
    return _Look(
        mass=tyre_mass(model.problem),
        masses=_masses(case, mesh, laws),
        resolution=resolution,
        warnings=(
            *_coarse(case, resolution),
            *_small_discs(model, mesh),
            *strained(model.inflation.strain if model.inflation else np.nan),
        ),
    )


def _grooves(case: Case) -> str:
    """The tread's grooves and how they are meshed."""
    if case.geometry is None or case.geometry.tread is None:
        return ""
    tread, R = case.geometry.tread, case.geometry.outer_radius
    if tread.grooves is None:
        return ""
    grooves = tread.grooves
    count = grooves.number * case.cell.n_cells
    across = int(groove_layers(grooves, R, case.cell).grooved.sum())
    return (
        f"{count} grooves, {1e3 * grooves.width:.4g} mm wide ({across} of "
        f"{case.cell.elements_around} elements around a cell) and {1e3 * grooves.depth:.4g} mm "
        f"deep ({groove_rows(tread)} of {tread.elements_through} rows), between blocks of "
        f"{1e3 * (2.0 * np.pi * R / count - grooves.width):.4g} mm"
    )


def tyre_mass(problem: RingProblem) -> float:
    """Mass of the whole ring [kg]: that of a unit translation along the axle."""
    along = np.zeros(problem.cell.n_dofs)
    along[1::3] = 1.0
    return float(problem.n_cells * (along @ (problem.cell.sparse(problem.cell.M) @ along)))


def _masses(case: Case, mesh: CellMesh, laws: Mapping[str, Constitutive]) -> dict[str, float]:
    """Mass of the whole tyre [kg] by material, as it is assembled."""
    element = ELEMENTS[case.cell.element]
    return {
        name: case.cell.n_cells * _mass_along(element, mesh, index, laws[name].rho)
        for index, name in enumerate(mesh.materials)
    }


def _mass_along(element: Element, mesh: CellMesh, index: int, rho: float) -> float:
    """Mass [kg] in one cell of the material with this index: that of a unit translation along y."""
    X = mesh.cartesian[mesh.bricks[mesh.material == index]]
    return float(element.mass(X, rho)[:, 1::3, 1::3].sum())


def _coarse(case: Case, resolution: tuple[Resolution, ...]) -> list[str]:
    """A warning for every material that is meshed too coarsely, and what would mend it."""
    along = "more geometry.elements_along" if case.geometry else "a finer mesh file"
    return [
        f"{r.material}: {r.per_wavelength:.1f} elements per wavelength at the top frequency "
        f"({r.enough:g} recommended); elements of {1e3 * r.per_wavelength * r.size / r.enough:.2g} "
        "mm would do (smaller cell.sector_angle or more cell.elements_around, "
        f'{along}, or "hex20")'
        for r in resolution
        if not r.fine
    ]


def _small_discs(model: Model, mesh: CellMesh) -> list[str]:
    """A warning for every patch that is smaller than the elements under it."""
    size = float(element_sizes(mesh).max())
    return [
        f"{place.name}: elements of up to {1e3 * size:.3g} mm are larger than the disc of "
        f"{1e3 * place.diameter:.3g} mm; its local compliance is the mesh's, not the tyre's"
        for place in (*model.loads, *model.probes[len(model.loads) :])
        if 0.0 < place.diameter < size
    ]


def memory_of_run(case: Case, model: Model, jobs: int) -> float:
    """Bytes that all processes take together, at their peak: assembling the cell, or solving."""
    assembled = need_of_cell(case, len(getattr(model.mesh, "bricks", ())))
    return max(assembled.total, need_of_run(case, [model.problem], jobs).total)
