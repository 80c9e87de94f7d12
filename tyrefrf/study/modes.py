"""Natural modes of a case's tyre, counted and described."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from tyrefrf.case import Case, Ply, load_case, read_text
from tyrefrf.errors import SolveError
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.mesh.node_cell import NodeCell
from tyrefrf.results.modes import Modes
from tyrefrf.solvers import RingProblem
from tyrefrf.solvers.modal_loss import modal_loss
from tyrefrf.solvers.modes import OrderModes, Pencils, cutoff_for, lowest, modes_below
from tyrefrf.solvers.own_moduli import RelaxingOrders, own_modes_below
from tyrefrf.study.local import pinned
from tyrefrf.study.memory import check_fits, need_of_modes
from tyrefrf.study.model import Model, build_model
from tyrefrf.study.run import provenance_of, sizes, static_state

COUNT = 100
"""Modes that are computed where nothing is said."""


def modes(
    case: Case | str | Path,
    *,
    count: int | None = None,
    below: float | None = None,
    at: float | None = None,
    at_rest: bool = False,
) -> Modes:
    """Natural modes of a case, or of the case in a file: `tyrefrf.modes("case.toml")`.

    Arguments as of `modes_of_case`, which says what it raises.
    """
    if isinstance(case, Case):
        return modes_of_case(case, count=count, below=below, at=at, at_rest=at_rest)
    path = Path(case)
    return modes_of_case(
        load_case(path), count=count, below=below, at=at, at_rest=at_rest, case_text=read_text(path)
    )


@pinned
def modes_of_case(
    case: Case,
    *,
    count: int | None = None,
    below: float | None = None,
    at: float | None = None,
    at_rest: bool = False,
    case_text: str = "",
) -> Modes:
    """The undamped modes of the tyre that a case describes, and their loss factors.

    count: the lowest so many, both members of a pair counted and none split; COUNT by default.
    below: all below that frequency [Hz] instead. at: frequency [Hz] at which the moduli are
    taken; by default each mode's own where a material depends on frequency. at_rest: without
    the case's inflation.
    Raises CaseError and MeshError as `build_model`, SolveError where the tyre has buckled or the
    modes cannot be made as many as they are counted.
    """
    start = time.perf_counter()
    if at_rest:
        resting = case.inflation.model_copy(update={"pressure": 0.0})
        case = case.model_copy(update={"inflation": resting})
    model = build_model(case)
    parts = case.matrices.K.values() if case.matrices is not None else case.materials.values()
    if at is None and not any(map(_relaxes, parts)):
        at = 0.0
    omega, top = (None if hertz is None else 2.0 * np.pi * hertz for hertz in (at, below))
    wanted = None if top is not None else count or COUNT
    check_fits(need_of_modes(model.problem, wanted or modes_under(model.problem, top, omega)))
    found = complete(model.problem.cell, model.problem.n_cells, wanted, top, omega)
    numbers = {**sizes(model), "seconds": time.perf_counter() - start}
    return _results(model, found, omega, case_text, numbers)


def modes_under(problem: RingProblem, top: float | None, at: float | None) -> int:
    """How many modes have a frequency below the top [rad/s]."""
    assert top is not None  # there is no count
    return Pencils(problem.cell, problem.n_cells, top if at is None else at).count_below(top)


def _relaxes(stuff: object) -> bool:
    """Whether a material's modulus depends on frequency."""
    return getattr(stuff.rubber if isinstance(stuff, Ply) else stuff, "modulus", None) is not None


@dataclass(frozen=True, slots=True, eq=False)
class Counted:
    """All modes below a cut-off [rad/s], and how many there are of each order by inertia."""

    modes: tuple[OrderModes, ...]
    cutoff: float
    counted: IntArray


def complete(
    cell: CellMatrices, n_cells: int, count: int | None, below: float | None, at: float | None
) -> Counted:
    """The lowest `count` modes of the ring, or those below a frequency [rad/s], counted.

    at: omega of the moduli; None: each mode's own. With a count the cut-off comes to stand half
    way to the first mode left out. Raises SolveError as `modes_of_case`.
    """
    pencils = Pencils(cell, n_cells, at or 0.0)

    def moduli_at(omega: float) -> Pencils:
        return pencils if at is not None else pencils.at(omega)

    cutoff = below
    if cutoff is None:
        assert count is not None
        cutoff = cutoff_for(lambda omega: moduli_at(omega).count_below(omega), pencils, count)
    if at is None and np.isinf(cutoff):
        raise SolveError("this mesh has no more modes than that; ask for fewer of them")
    if at is not None:
        found = tuple(modes_below(pencil, cutoff) for pencil in pencils)
    else:
        orders = RelaxingOrders(cell, n_cells)
        found = tuple(own_modes_below(orders, h, cutoff) for h in range(n_cells // 2 + 1))
    if count is not None:
        kept = lowest(found, count)
        cutoff, found = _gap_above(kept, found, cutoff), kept
    counted = np.array([pencil.count_below(cutoff) for pencil in moduli_at(cutoff)])
    if not np.array_equal(counted, [len(order.omega) for order in found]):
        raise SolveError(
            f"a mode lies on the cut-off, {cutoff / (2.0 * np.pi):.9g} Hz, to rounding, and cannot "
            "be counted; choose another"
        )
    return Counted(found, cutoff, counted)


def _gap_above(kept: tuple[OrderModes, ...], found: tuple[OrderModes, ...], cutoff: float) -> float:
    """Half way from the last mode that is kept to the first that is not, or to the cut-off."""
    last = max((m.omega[-1] for m in kept if len(m.omega)), default=0.0)
    left_out = (
        more.omega[len(m.omega)]
        for m, more in zip(kept, found, strict=True)
        if len(more.omega) > len(m.omega)
    )
    first = min(left_out, default=cutoff)
    return float((last + first) / 2.0)


def _results(
    model: Model, found: Counted, at: float | None, case_text: str, numbers: dict[str, float | int]
) -> Modes:
    """All orders' modes in one ascending row, with what can be said of each."""
    cell, N, mesh = model.problem.cell, model.problem.n_cells, model.mesh
    losses = modal_loss(cell, N, found.modes, at)
    pencils = Pencils(cell, N)
    omega = np.concatenate([m.omega for m in found.modes])
    row = np.argsort(omega, kind="stable")
    shapes = [_on_nodes(model.problem.free, m.shapes) for m in found.modes]
    motion = [_motion(pencils, model.problem.free, m) for m in found.modes]
    diameters = [
        nodal_diameters(mesh, N, m.order, shape)
        for m, shape in zip(found.modes, shapes, strict=True)
    ]
    repeated = np.repeat(
        [[m.order, m.n_members] for m in found.modes], [len(m.omega) for m in found.modes], axis=0
    )
    provenance = provenance_of(model.case, case_text, numbers)
    return Modes(
        frequency=omega[row] / (2.0 * np.pi),
        order=repeated[row, 0],
        members=repeated[row, 1],
        loss_factor=np.concatenate([loss.loss_factor for loss in losses])[row],
        diameters=np.concatenate(diameters)[row],
        motion=np.concatenate(motion)[row],
        energy_share=np.concatenate([loss.energy_share for loss in losses])[row],
        loss_share=np.concatenate([loss.loss_share for loss in losses])[row],
        shape=np.concatenate(shapes)[row],
        residual=np.concatenate([m.residual for m in found.modes])[row],
        points=mesh.points[: mesh.n_own].copy(),
        cutoff=found.cutoff / (2.0 * np.pi),
        counted=found.counted,
        moduli_at=np.nan if at is None else at / (2.0 * np.pi),
        section=mesh.left,
        provenance=replace(provenance, solver="modes"),
        inflation=None if model.inflation is None else static_state(model, model.inflation),
    )


def _on_nodes(free: BoolArray, shapes: ComplexArray) -> ComplexArray:
    """Shapes (m, n, 3) on the cell's own nodes, from those (n_free, m) on the dofs that move."""
    all_dofs = np.zeros((len(free), shapes.shape[1]), complex)
    all_dofs[free] = shapes
    return all_dofs.T.reshape(shapes.shape[1], len(free) // 3, 3)


def _motion(pencils: Pencils, free: BoolArray, modes: OrderModes) -> FloatArray:
    """Shares (m, 3) of the kinetic energy along r, y and theta."""
    energy = (modes.shapes.conj() * (pencils.of(modes.order).M @ modes.shapes)).real
    direction = np.flatnonzero(free) % 3
    return np.stack([energy[direction == i].sum(axis=0) for i in range(3)], axis=1)


def nodal_diameters(
    mesh: CellMesh | NodeCell, n_cells: int, order: int, shapes: ComplexArray
) -> IntArray:
    """Which of n = |order + k N| each shape (m, n_own, 3) within the cell comes closest to: (m,).

    By the discrete Fourier transform over the cell's planes, each weighted by half the angle
    between its neighbours, on the section nodes that stand in all of them: p planes tell p aliases
    apart, one plane none.
    """
    planes = mesh.planes[:-1, np.all(mesh.planes[:-1] >= 0, axis=0)]
    p = len(planes)
    gap = np.diff(mesh.plane_angles)
    n = order + n_cells * np.arange(-(p // 2), (p + 1) // 2)
    kernel = (gap + np.roll(gap, 1)) * np.exp(-1j * np.outer(n, mesh.plane_angles[:-1]))
    waves = np.einsum("np,mpai->mnai", kernel, shapes[:, planes])
    power = np.sum(np.abs(waves) ** 2, axis=(2, 3))
    return np.abs(n[np.argmax(power, axis=1)])
