"""What a case would compute, how finely, and what that would cost: known before it is solved."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tyrefrf.case import Case, Solver
from tyrefrf.fem.constitutive import Constitutive, constitutive
from tyrefrf.fem.elements import ELEMENTS, Element
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.solvers import Cyclic, Recursive, RingProblem
from tyrefrf.solvers.direct import check_library
from tyrefrf.solvers.memory import memory_needed
from tyrefrf.study.model import Model, build_model
from tyrefrf.study.resolution import Resolution, element_sizes, resolutions

REACHED = {"recursive": 0.8, "cyclic": 0.12}
"""Of the machine's zgemm rate: by the recursion's operations, and by those of LAPACK's bands, the
substitution counted with them."""

CHECK, FIXED = 14_000.0, 3e-3
"""The field and its residual, cost at the zgemm rate over N n; and seconds that any line takes.
With these the homogeneous and the layered tyre are met within a third (benchmarks/RESULTS.md)."""

DIRECT = 35.0
"""Cost of SuperLU's `direct` at the zgemm rate over N n^3: both tyres within 10 %."""

PARDISO = 0.3
"""Of what SuperLU takes for `direct`: 0.22 on the layered tyre, 0.41 on the homogeneous one."""

MODAL = 35_000.0
"""Cost over N n: superposing 1000 modes, and the check of the field: 27 000 and 39 000."""

PROCESS_MEMORY = 130e6  # bytes of a process with numpy and scipy loaded
START_UP = 3.0  # s: imports, worker processes, plots


@dataclass(frozen=True, slots=True)
class Estimate:
    """Sizes of the model, how finely it is meshed, and what solving would take.

    mass: of the tyre [kg]; masses: by material. seconds: wall time. memory: of all processes
    together [bytes].
    """

    section_nodes: int
    section_elements: int
    cell_nodes: int
    cell_dofs: int
    n_cells: int
    ring_nodes: int
    ring_dofs: int
    free_section_dofs: int
    mass: float
    masses: dict[str, float]
    n_lines: int
    top_frequency: float
    n_loads: int
    n_probes: int
    resolution: tuple[Resolution, ...]
    warnings: tuple[str, ...]
    seconds: float
    memory: float


def estimate(case: Case, jobs: int) -> Estimate:
    """Mesh and assemble a case, solve nothing, and say what solving would take.

    Raises CaseError and MeshError as a run would.
    """
    model = build_model(case)
    mesh, problem = model.mesh, model.problem
    lines = case.frequency.lines()
    laws = {name: constitutive(case.materials[name]) for name in mesh.materials}
    resolution = resolutions(mesh, laws, lines[-1])
    return Estimate(
        section_nodes=mesh.n_face,
        section_elements=mesh.section.n_elements,
        cell_nodes=mesh.n_nodes,
        cell_dofs=problem.cell.n_dofs,
        n_cells=problem.n_cells,
        ring_nodes=mesh.n_own * problem.n_cells,
        ring_dofs=problem.n_ring_dofs,
        free_section_dofs=_section_dofs(problem),
        mass=tyre_mass(problem),
        masses=_masses(case, mesh, laws),
        n_lines=len(lines),
        top_frequency=lines[-1],
        n_loads=len(model.loads),
        n_probes=len(model.probes),
        resolution=resolution,
        warnings=(*_coarse(resolution), *_small_discs(model)),
        seconds=START_UP + len(lines) * line_seconds(case.solver.name, problem) / jobs,
        memory=_memory(case.solver, problem, jobs),
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


def _coarse(resolution: tuple[Resolution, ...]) -> list[str]:
    """A warning for every material that is meshed too coarsely, and what would mend it."""
    return [
        f"{r.material}: {r.per_wavelength:.1f} elements per wavelength at the top frequency "
        f"({r.enough:g} recommended); elements of {1e3 * r.per_wavelength * r.size / r.enough:.2g} "
        'mm would do (smaller cell.sector_angle, more geometry.elements_along, or "hex20")'
        for r in resolution
        if not r.fine
    ]


def _small_discs(model: Model) -> list[str]:
    """A warning for every patch that is smaller than the elements under it."""
    size = float(element_sizes(model.mesh).max())
    return [
        f"{place.name}: elements of up to {1e3 * size:.3g} mm are larger than the disc of "
        f"{1e3 * place.diameter:.3g} mm; its local compliance is the mesh's, not the tyre's"
        for place in (*model.loads, *model.probes[len(model.loads) :])
        if 0.0 < place.diameter < size
    ]


def _section_dofs(problem: RingProblem) -> int:
    """Dofs of a section that move: the size of the recursion's matrices."""
    return int(problem.free[: problem.cell.n_face].sum())


def line_seconds(solver: str, problem: RingProblem) -> float:
    """Seconds per line, from the operations of the solver and this machine's zgemm rate."""
    N, own = problem.n_cells, int(problem.free.sum())
    cost = CHECK * N * own
    if solver == "recursive":
        n = _section_dofs(problem)
        inside = 8.0 * (own - n) * ((own - n) / 3.0 + 2.0 * n) ** 2
        cost += (Recursive(problem).operations + inside) / REACHED["recursive"]
    elif solver == "cyclic":
        cost += Cyclic(problem).operations / REACHED["cyclic"]
    elif solver == "modal":
        cost = MODAL * N * own
    else:
        cost += DIRECT * N * own**3 * (PARDISO if check_library("auto") == "pardiso" else 1.0)
    return FIXED + cost / zgemm_rate()


def _memory(solver: Solver, problem: RingProblem, jobs: int) -> float:
    """Bytes that all processes take together."""
    if solver.name == "direct":
        return jobs * memory_needed(problem, solver.library)
    n = _section_dofs(problem)
    matrices = 6 * problem.n_cells.bit_length() if solver.name == "recursive" else 2
    cell = 16.0 * (int(problem.free.sum()) + n) ** 2
    field = 16.0 * problem.n_ring_dofs * problem.n_loads * 4
    return jobs * (PROCESS_MEMORY + 16.0 * matrices * n**2 + cell + field)


def zgemm_rate(n: int = 256, repeats: int = 3) -> float:
    """Operations per second of this machine's complex matrix product, one thread."""
    from threadpoolctl import threadpool_limits

    A = np.full((n, n), 1.0 + 1.0j)
    times = []
    with threadpool_limits(limits=1, user_api="blas"):
        for _ in range(repeats):
            start = time.perf_counter()
            _ = A @ A
            times.append(time.perf_counter() - start)
    return 8.0 * n**3 / min(times)
