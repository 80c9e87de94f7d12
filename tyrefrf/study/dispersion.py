"""Free waves of a case's cell over its range of frequencies, joined into branches."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.case import Case, load_case, read_text
from tyrefrf.errors import CaseError, Problem, SolveError, short_of_memory
from tyrefrf.results.dispersion import DIRECTIONS, NEPER, Dispersion
from tyrefrf.solvers.problem import RingProblem
from tyrefrf.solvers.waves import FreeWaves, Waves
from tyrefrf.study.branches import Frame, branches
from tyrefrf.study.executor import Task, Workers, executor_of, map_unordered
from tyrefrf.study.local import cores, pinned
from tyrefrf.study.memory import check_fits, need_of_waves
from tyrefrf.study.model import build_model
from tyrefrf.study.run import provenance_of, sizes, static_state
from tyrefrf.study.spectrum import Progress

LINES = 100
DECAY = 20.0  # dB/rad: to a tenth within a radian, 57 degrees


def dispersion(
    case: Case | str | Path,
    *,
    lines: int = LINES,
    decay: float = DECAY,
    at_rest: bool = False,
    jobs: Workers | None = None,
) -> Dispersion:
    """Free waves of a case, or of the case in a file: `tyrefrf.dispersion("case.toml")`.

    Arguments and errors as those of `dispersion_of`.
    """
    text = ""
    if not isinstance(case, Case):
        text, case = read_text(Path(case)), load_case(Path(case))
    return dispersion_of(case, lines=lines, decay=decay, at_rest=at_rest, jobs=jobs, case_text=text)


@pinned
def dispersion_of(
    case: Case,
    *,
    lines: int = LINES,
    decay: float = DECAY,
    at_rest: bool = False,
    jobs: Workers | None = None,
    case_text: str = "",
    progress: Progress = lambda n_lines: None,
) -> Dispersion:
    """All free waves that decay by at most `decay` [dB/rad], and the branches they form.

    lines: so many frequencies, evenly spread over the case's range, 0 Hz left out. at_rest:
    without the case's pressure. jobs, case_text, progress: as `run_case`.

    A line whose waves cannot be proved to be all is NaN, with the reason in `remark`. Raises as
    `run_case`.
    """
    start = time.perf_counter()
    if at_rest:
        inflation = case.inflation.model_copy(update={"pressure": 0.0})
        case = case.model_copy(update={"inflation": inflation})
    frequency = spread(case, lines)
    executor = executor_of(jobs or cores(), len(frequency))
    model = build_model(case)
    check_fits(need_of_waves(model.problem, executor.here))
    found = search_lines(model.problem, frequency, decay / NEPER, executor, progress)
    counts = np.array([(w.found, w.counted) if (w := line.waves) else (-1, -1) for line in found])
    numbers = {**sizes(model), "seconds": time.perf_counter() - start}
    return Dispersion(
        frequency=frequency,
        **in_branches(frequency, found, model.problem.n_cells),
        found=counts[:, 0].copy(),
        counted=counts[:, 1].copy(),
        solve_time=np.array([line.seconds for line in found]),
        remark=tuple(line.remark for line in found),
        bound=decay / NEPER,
        section=model.mesh.left,
        provenance=replace(provenance_of(case, case_text, numbers), solver="free waves"),
        inflation=None if model.inflation is None else static_state(model, model.inflation),
    )


def spread(case: Case, lines: int) -> FloatArray:
    """So many frequencies [Hz] over the case's range, without 0 Hz."""
    asked = case.frequency.lines()
    first, last = min(asked), max(asked)
    if last <= 0.0:
        message = "at 0 Hz alone there are no free waves; give a range"
        raise CaseError([Problem(("frequency",), message)])
    if first == last:
        return np.array([last])
    return np.linspace(first or last / lines, last, lines)


@dataclass(frozen=True, slots=True, eq=False)
class FoundLine:
    """One line's waves, None where it failed, with the reason, and what it took [s].

    shape: (n, m) of the section, weighted by the root of the diagonal mass, of unit norm.
    """

    index: int
    waves: Waves | None
    shape: ComplexArray
    seconds: float
    remark: str = ""


def search_lines(
    problem: RingProblem, frequency: FloatArray, bound: float, workers: Workers, progress: Progress
) -> list[FoundLine]:
    """The free waves of every line [Hz], in order; bound: on their decay [Np/rad]."""
    free_waves = FreeWaves(problem.cell, problem.n_cells, 2.0 * np.pi * float(np.median(frequency)))
    solve = partial(partial, _solve_line, free_waves, frequency, bound)
    tasks = (Task(solve, index) for index in range(len(frequency)))
    found: list[FoundLine] = []
    for line in map_unordered(tasks, workers, partial(_lost_line, free_waves)):
        found.append(line)
        progress(1)
    return sorted(found, key=lambda line: line.index)


def _solve_line(
    free_waves: FreeWaves, frequency: FloatArray, bound: float, index: int
) -> FoundLine:
    """One line; one that fails is data."""
    cell, start = free_waves.cell, time.perf_counter()
    try:
        waves = free_waves.at(2.0 * np.pi * float(frequency[index]), bound)
    except (SolveError, MemoryError) as error:
        reason = str(error)
        if isinstance(error, MemoryError):
            reason = f"{frequency[index]:.6g} Hz: {short_of_memory(error)}"
        return _failed_line(cell.n_face, index, time.perf_counter() - start, reason)
    mass = cell.sparse(cell.M).diagonal()[: cell.n_face]
    shape = np.sqrt(mass)[:, None] * waves.q[: cell.n_face]
    shape /= np.linalg.norm(shape, axis=0)
    return FoundLine(index, waves, shape, time.perf_counter() - start)


def _lost_line(free_waves: FreeWaves, task: Task[int, FoundLine], reason: str) -> FoundLine:
    """A line that kills its process; the time it took counts as nothing."""
    return _failed_line(free_waves.cell.n_face, task.item, 0.0, reason)


def _failed_line(n_face: int, index: int, seconds: float, reason: str) -> FoundLine:
    return FoundLine(index, None, np.empty((n_face, 0), complex), seconds, reason)


def in_branches(
    frequency: FloatArray, found: Sequence[FoundLine], n_cells: int
) -> dict[str, FloatArray]:
    """Arrays (b, f) of what is stored of every wave, NaN where a branch is not on a line.

    Lines that failed are passed over.
    """
    solved = [(line, line.waves) for line in found if line.waves is not None]
    numbers = branches(
        [
            Frame(
                omega=2.0 * np.pi * float(frequency[line.index]),
                exponent=waves.decay + 1j * waves.order,
                velocity=waves.velocity,
                shape=line.shape,
            )
            for line, waves in solved
        ],
        n_cells,
    )
    n_branches = 1 + max((int(number.max(initial=-1)) for number in numbers), default=-1)
    arrays = {
        name: np.full((n_branches, len(frequency)), np.nan)
        for name in ("order", "decay", "velocity", "residual")
    }
    arrays["share"] = np.full((n_branches, len(DIRECTIONS), len(frequency)), np.nan)
    for number, (line, waves) in zip(numbers, solved, strict=True):
        for name in ("order", "decay", "velocity", "residual"):
            arrays[name][number, line.index] = getattr(waves, name)
        n_nodes = len(line.shape) // len(DIRECTIONS)
        energy = np.abs(line.shape.reshape(n_nodes, len(DIRECTIONS), len(number))) ** 2
        arrays["share"][number, :, line.index] = energy.sum(axis=0).T
    return arrays
