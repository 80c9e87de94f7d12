"""A second look at a run: another solver on a sample of its lines, and a ring of finer cells.

The first says whether the equations were solved; the second, how far the answer still changes
when the cells are halved around the axle. The section's own mesh is not refined. A cell with a
groove in its tread cannot be halved: it has twice the elements around instead.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray, IntArray
from tyrefrf.case import AtNode, Case, Load, Probe, Solver, build_case, resolved
from tyrefrf.errors import CaseError, MeshError, Problem, SolveError
from tyrefrf.mesh.grooves import groove_layers
from tyrefrf.mesh.place import Place
from tyrefrf.results import Results
from tyrefrf.results.certificate import Certificate
from tyrefrf.results.proof import TRUNCATED
from tyrefrf.solvers import Field, Maker, RingProblem, field_of, prepare, responses
from tyrefrf.solvers import Solver as RingSolver
from tyrefrf.study.choose import with_solver
from tyrefrf.study.cost import line_seconds
from tyrefrf.study.executor import Executor, Task, Workers, executor_of, map_unordered
from tyrefrf.study.local import pinned
from tyrefrf.study.memory import check_fits, need_of_run
from tyrefrf.study.model import Model, build_model
from tyrefrf.study.spectrum import Progress, solve_spectrum

CHECKED = 8  # lines for the second solver, beside the one with the largest residual
SAMPLED = 24  # lines for the refined ring
STILL = 1e-9
"""Response, relative to the load's largest on the line, up to which a probe does not move: zero
by symmetry, but for rounding."""

REFINER = Solver.model_validate({"name": "cyclic"})
"""Who solves the refined ring."""


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """What a certificate takes.

    second: the solver that solves `checked` lines of the results again. refined: the ring of
    finer cells, on which the `sampled` lines are solved; None where it is left out, and why.
    """

    results: Results
    model: Model
    second: Solver
    checked: IntArray
    refined: Model | None
    sampled: IntArray
    left_out: str

    @property
    def n_lines(self) -> int:
        """Lines to be solved."""
        return len(self.checked) + len(self.sampled)

    def words(self, jobs: int) -> str:
        """The plan in a sentence, with what it costs."""
        finer = f"none of a refined ring: {self.left_out}"
        if self.refined is not None:
            finer = f"{len(self.sampled)} lines of {self.refined.problem.n_cells} cells"
        return (
            f"certify: {len(self.checked)} lines again by `{self.second.name}`, {finer};"
            f" about {self._seconds() / jobs:.0f} s"
        )

    def _seconds(self) -> float:
        """Of one process [s]; the run's own solver goes along with the second, if not truncated."""
        seconds = len(self.checked) * line_seconds(self.second.name, self.model.problem)
        if self.model.case.solver.name not in TRUNCATED:
            seconds += float(self.results.solve_time[self.checked].sum())
        if self.refined is not None:
            seconds += len(self.sampled) * line_seconds(REFINER.name, self.refined.problem)
        return seconds


@pinned
def plan_certificate(case: Case, results: Results) -> Plan:
    """What would certify these results of a case. Raises CaseError and MeshError as a run."""
    case = with_solver(case, results.provenance.solver)
    model = build_model(case)
    second = "recursive" if case.solver.name == "cyclic" else "cyclic"
    solved = np.flatnonzero(results.solved)
    checked = _spread(solved, CHECKED)
    if len(solved):
        checked = np.union1d(checked, solved[np.argmax(results.residual[solved])])
    refined, left_out = None, ""
    try:
        refined = build_model(refined_case(case, model))
    except (CaseError, MeshError) as error:
        left_out = str(error)
    return Plan(
        results=results,
        model=model,
        second=Solver.model_validate({"name": second}),
        checked=checked,
        refined=refined,
        sampled=_spread(solved, SAMPLED if refined else 0),
        left_out=left_out,
    )


@pinned
def certified(plan: Plan, workers: Workers, progress: Progress = lambda n_lines: None) -> Results:
    """The results with their certificate. Raises SolveError where nothing can be solved."""
    results = plan.results
    executor = executor_of(workers, plan.n_lines)
    problems = [m.problem for m in (plan.model, plan.refined) if m is not None]
    check_fits(need_of_run(plan.model.case, problems[-1:], executor.here))
    again = _checked_again(plan, executor, progress)
    certificate = Certificate(
        solver=plan.second.name,
        frequency=results.frequency[plan.checked],
        residual=np.array([line.residual for line in again]),
        difference=_by_load(results, [line.difference for line in again]),
        cell_difference=_by_load(results, [line.cell_difference for line in again]),
        n_cells=plan.refined.problem.n_cells if plan.refined else 0,
        refined_frequency=results.frequency[plan.sampled],
        level_change=_level_change(plan, executor, progress),
        left_out=plan.left_out,
    )
    return replace(results, certificate=certificate)


def refined_case(case: Case, model: Model) -> Case:
    """The case with cells of half the angle, its loads and probes where they were.

    A cell with grooves keeps its angle and has twice the elements around, in grooves and blocks.
    What snaps to a node keeps the plane that it has in the model: those planes are in the finer
    ring too. Raises CaseError where such cells are not allowed.
    """
    if case.mesh is not None and case.mesh.kind == "cell":
        message = f"{case.mesh.file} is one cell of {case.cell.sector_angle:g} deg, as it is"
        raise CaseError([Problem(("mesh", "file"), message)])
    if case.matrices is not None:
        message = f"the matrices are of cells of {case.cell.sector_angle:g} deg, as they are"
        raise CaseError([Problem(("matrices",), message)])
    data = {key: value for key, value in resolved(case).items() if key != "sweep"}
    tread = case.geometry.tread if case.geometry else None
    if case.geometry is None or tread is None or tread.grooves is None:
        data["cell"] = {**data["cell"], "sector_angle": case.cell.sector_angle / 2.0}
    else:
        layers = groove_layers(tread.grooves, case.geometry.outer_radius, case.cell)
        across = int(layers.grooved.sum()) // tread.grooves.number
        data["cell"] = {**data["cell"], "elements_around": 2 * case.cell.elements_around}
        data["geometry"]["tread"]["grooves"]["elements_across"] = 2 * across
    data["loads"] = _kept(data["loads"], case.loads, model.loads)
    data["probes"] = _kept(data["probes"], case.probes, model.probes[len(model.loads) :])
    return build_case(data, case.name).with_files_of(case)


def _kept(
    entries: Sequence[dict[str, Any]], points: Sequence[Load | Probe], places: Sequence[Place]
) -> list[dict[str, Any]]:
    """Loads or probes as plain data, nodes at the angles of their places."""
    degrees = {place.name: float(np.rad2deg(place.angle)) for place in places}
    return [
        {**entry, "angle": degrees[point.name]} if isinstance(point, AtNode) else entry
        for entry, point in zip(entries, points, strict=True)
    ]


def _spread(lines: IntArray, n: int) -> IntArray:
    """About n of the lines, evenly spread, the first and the last among them."""
    if not len(lines) or not n:
        return lines[:0]
    return lines[np.unique(np.linspace(0, len(lines) - 1, n).round().astype(int))]


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class _Pair:
    """Two solvers of a problem: a process is given this once, and makes them once.

    own: makes the run's solver; None for a truncated one, whose modes would be sought again.
    """

    problem: RingProblem
    own: Maker | None
    second: Maker

    def __call__(self) -> Callable[[_Line], _Again]:
        """What solves a line again."""
        own = self.own() if self.own else None
        return partial(_solve_again, self.problem, own, self.second())


@dataclass(frozen=True, slots=True, eq=False)
class _Line:
    """A line to be solved again; receptance: (p, l) that the run found."""

    index: int
    omega: float
    receptance: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class _Again:
    """What the second solver found on a line; the arrays as in `Certificate`, (l,)."""

    index: int
    residual: float
    difference: FloatArray
    cell_difference: FloatArray


def _checked_again(plan: Plan, executor: Executor, progress: Progress) -> list[_Again]:
    """The second solver's lines, in their order."""
    case, problem, results = plan.model.case, plan.model.problem, plan.results
    own = None if case.solver.name in TRUNCATED else prepare(problem, case.solver, executor.here)
    pair = _Pair(problem, own, prepare(problem, plan.second, executor.here))
    lines = [
        _Line(
            index=int(index),
            omega=float(results.omega[index]),
            receptance=results.receptance[:, :, index].T,
        )
        for index in plan.checked
    ]
    found = []
    for line in map_unordered((Task(pair, line) for line in lines), executor, _unsolved):
        found.append(line)
        progress(1)
    return sorted(found, key=lambda line: line.index)


def _solve_again(
    problem: RingProblem, own_solver: RingSolver | None, second: RingSolver, line: _Line
) -> _Again:
    """One line by the second solver; NaN where it finds no answer."""
    try:
        field = field_of(problem, second, line.omega)
        own = field_of(problem, own_solver, line.omega) if own_solver else None
    except (SolveError, MemoryError):
        return _no_answer(line)
    n_loads = problem.shape[1]  # those at the sensors' places come after them
    none = np.full(n_loads, np.nan)
    H = responses(problem, field, line.omega)
    n_probes = len(line.receptance)  # the hub's components, of other units, come after them
    return _Again(
        index=line.index,
        residual=field.residual,
        difference=_relative(H[:n_probes], line.receptance, axis=0),
        cell_difference=_cell_difference(field, own, n_loads) if own else none,
    )


def _no_answer(line: _Line) -> _Again:
    none = np.full(line.receptance.shape[1], np.nan)
    return _Again(line.index, np.nan, none, none)


def _unsolved(task: Task[_Line, _Again], reason: str) -> _Again:
    """A line that kills its process has no answer either."""
    return _no_answer(task.item)


def _cell_difference(field: Field, own: Field, n_loads: int) -> FloatArray:
    """(n_loads,) the largest of any cell, under the first of the loads."""
    q, expected = (found.q[..., :n_loads] for found in (field, own))
    largest: FloatArray = _relative(q, expected, axis=1).max(axis=0)
    return largest


def _relative(a: ComplexArray, b: ComplexArray, axis: int) -> FloatArray:
    """||a - b|| / ||b|| along an axis."""
    relative: FloatArray = np.linalg.norm(a - b, axis=axis) / np.linalg.norm(b, axis=axis)
    return relative


def _by_load(results: Results, lines: list[FloatArray]) -> FloatArray:
    """(l, k) from k lines (l,)."""
    return np.array(lines).reshape(len(lines), len(results.loads)).T.copy()


def _level_change(plan: Plan, executor: Executor, progress: Progress) -> FloatArray:
    """(l, p, m) level of the refined ring less that of the results [dB]."""
    frequency = plan.results.frequency[plan.sampled]
    H = plan.results.receptance[:, :, plan.sampled]
    if plan.refined is None or not len(frequency):
        return np.empty(H.shape)
    spectrum = solve_spectrum(plan.refined.problem, REFINER, frequency, executor, progress)
    finer = np.abs(spectrum.receptance.transpose(1, 0, 2)[:, : H.shape[1]])
    return 20.0 * np.log10(_moving(finer) / _moving(np.abs(H)))


def _moving(H: FloatArray) -> FloatArray:
    """Magnitudes (l, p, m), NaN where the probe does not move."""
    return np.where(H / H.max(axis=1, keepdims=True) > STILL, H, np.nan)
