"""Several solvers at the same lines of a case: what they answer, and what that takes.

As the paper's section 3 did against Ansys. The solvers work one after another, each in a process
of its own with one BLAS thread: times and peak memory are the solver's own. Times are CPU times,
as in the paper's table 2: on a busy machine wall times would be what others leave.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import get_args

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray, IntArray
from tyrefrf.case import Case, Frequency, SolverName, load_case, read_text
from tyrefrf.case.faults import did_you_mean
from tyrefrf.errors import CommandError, SolveError
from tyrefrf.results import Comparison, write_results
from tyrefrf.results.comparison import reference_of
from tyrefrf.solvers import Field, RingProblem, Solver, answer, field_of, prepare
from tyrefrf.study.choose import with_solver
from tyrefrf.study.estimate import memory_of_run, seconds_of_run
from tyrefrf.study.local import pinned
from tyrefrf.study.machine import blas, machine
from tyrefrf.study.memory import check_fits, need_of_comparison
from tyrefrf.study.model import Model, build_model
from tyrefrf.study.own_process import Say, in_own_process, peak_memory
from tyrefrf.study.run import provenance_of, results_of, sizes, static_state
from tyrefrf.study.spectrum import Progress, Spectrum

SECTION_LINES = 12
"""Lines at which the displacements of all sections are kept and compared."""

DEFAULT = ("recursive", "cyclic", "direct")

Watch = Callable[[str], AbstractContextManager[Progress]]
"""Called with a solver's name before it starts; gives what to call with lines just finished."""


@dataclass(frozen=True, slots=True)
class Cost:
    """What a solver is expected to take: wall time [s], and memory of all processes [bytes]."""

    seconds: float
    memory: float


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """What a solver's process is given: a case with its solver, and where files may go."""

    case: Case
    case_text: str
    samples: IntArray
    scratch: Path


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """What a solver's process reports; memory and disk in bytes, as in `Comparison`."""

    spectrum: Spectrum
    base_memory: float
    peak_memory: float
    disk: float
    blas: str


def compare(
    case: Case | str | Path, solvers: Sequence[str] = DEFAULT, *, lines: int | None = None
) -> Comparison:
    """Compare solvers at a case's lines: `tyrefrf.compare("case.toml", ["cyclic", "direct"])`.

    solvers: by name, each once; the one that the case itself names keeps its options. lines: so
    many of the case's, evenly picked; all by default.

    Raises as `run_comparison`.
    """
    if isinstance(case, Case):
        return run_comparison(case, solvers, lines=lines)
    path = Path(case)
    return run_comparison(load_case(path), solvers, lines=lines, case_text=read_text(path))


def run_comparison(
    case: Case,
    solvers: Sequence[str] = DEFAULT,
    *,
    lines: int | None = None,
    case_text: str = "",
    tell: Callable[[Mapping[str, Cost]], None] = lambda costs: None,
    watch: Watch = lambda solver: nullcontext(lambda n_lines: None),
) -> Comparison:
    """Solve the same lines by every solver, one after another.

    tell: called with what each is expected to take, before the first begins.
    A solver that refuses or whose process dies has no answers; `failure` says why. Raises
    CommandError for solvers that are unknown or named twice, CaseError and MeshError for a case
    that cannot be computed.
    """
    cases = {name: with_solver(case, name) for name in known_solvers(solvers)}
    picked = [with_lines(each, lines) for each in cases.values()]
    model = build_model(picked[0])
    choices = [each.solver for each in picked]
    check_fits(need_of_comparison(picked[0], model.problem, choices))
    tell({each.solver.name: _cost(each, model) for each in picked})
    samples = evenly(len(picked[0].frequency.lines()), SECTION_LINES)
    with TemporaryDirectory(prefix="tyrefrf_") as scratch:
        tasks = [Task(each, case_text, samples, Path(scratch)) for each in picked]
        outcomes = [_outcome(task, watch) for task in tasks]
        answered = [isinstance(found, Answer) for found in outcomes]
        section_error = _section_errors(tasks, answered)
    return _gathered(model, tuple(cases), outcomes, samples, section_error, case_text)


@pinned
def _cost(case: Case, model: Model) -> Cost:
    return Cost(seconds_of_run(case, model.problem, 1), memory_of_run(case, model, 1))


def known_solvers(names: Sequence[str]) -> tuple[str, ...]:
    """The names, if all are solvers' and each stands once. Raises CommandError."""
    known = [name for name in get_args(SolverName) if name != "auto"]
    for name in names:
        if name not in known:
            hint = did_you_mean(name, known) or f"; there are: {', '.join(known)}"
            raise CommandError(f"no solver '{name}'{hint}")
        if list(names).count(name) > 1:
            raise CommandError(f"solver '{name}' is named twice; each is compared once")
    if not names:
        raise CommandError(f"no solvers to compare; name some of: {', '.join(known)}")
    return tuple(names)


def with_lines(case: Case, n_lines: int | None) -> Case:
    """The case with so many of its frequency lines, evenly picked; all of them with None."""
    every = case.frequency.lines()
    if n_lines is None or n_lines >= len(every):
        return case
    values = [every[i] for i in evenly(len(every), n_lines)]
    return case.model_copy(update={"frequency": Frequency.model_validate({"values": values})})


def evenly(n: int, wanted: int) -> IntArray:
    """At most so many of n numbers from 0, evenly spread, both ends included."""
    return np.unique(np.linspace(0, n - 1, min(n, wanted)).round().astype(np.int64))


def _outcome(task: Task, watch: Watch) -> Answer | str:
    """A solver's answer, or why there is none."""
    with watch(task.case.solver.name) as advance:
        try:
            return in_own_process(partial(solve_alone, task), advance)
        except SolveError as error:
            return str(error)


def solve_alone(task: Task, say: Say) -> Answer:
    """What a solver's process does: assemble, prepare, solve, measure; says 1 after every line."""
    case = task.case
    model = build_model(case)
    base_memory = peak_memory()
    start = time.process_time()
    solver = prepare(model.problem, case.solver)()
    prepared = time.process_time() - start
    spectrum = _spectrum(model.problem, solver, prepared, task, say)
    memory = peak_memory()
    numbers = {**sizes(model), "seconds": time.process_time() - start}
    origin = provenance_of(case, task.case_text, numbers)
    results = results_of(model, np.array(case.frequency.lines()), spectrum, origin)
    file = task.scratch / f"{case.solver.name}.h5"
    write_results(file, results)
    disk = file.stat().st_size
    file.unlink()
    return Answer(spectrum, base_memory, memory, float(disk), blas())


def _spectrum(
    problem: RingProblem, solver: Solver, prepared: float, task: Task, say: Say
) -> Spectrum:
    """All lines, one after another; the sections' fields at the samples go to files."""
    lines, seconds = [], []
    for index, frequency in enumerate(task.case.frequency.lines()):
        keeping = _Keeping(problem, solver)
        sampled = index in task.samples
        start = time.process_time()
        lines.append(answer(problem, keeping if sampled else solver, 2.0 * np.pi * frequency))
        seconds.append(time.process_time() - start)
        if keeping.kept is not None:
            _keep(_field_file(task, index), keeping.kept.q[:, : problem.cell.n_face])
        say(1)
    return Spectrum(
        receptance=np.stack([line.receptance for line in lines], axis=-1),
        residual=np.array([line.residual for line in lines]),
        solve_time=np.array(seconds),
        remark=tuple(line.remark for line in lines),
        prepare_time=prepared,
    )


def _keep(file: Path, sections: ComplexArray) -> None:
    try:
        np.save(file, sections)
    except OSError as error:
        raise SolveError(
            f"{file.parent}, for what is compared, cannot be written: {error.strerror or error}; "
            "TMPDIR names another directory"
        ) from error


class _Keeping:
    """A solver whose last field is kept."""

    def __init__(self, problem: RingProblem, solver: Solver) -> None:
        self.problem, self.solver, self.exact = problem, solver, solver.exact
        self.kept: Field | None = None

    def field(self, omega: float) -> Field:
        self.kept = field_of(self.problem, self.solver, omega)
        return self.kept


def _field_file(task: Task, line: int) -> Path:
    return task.scratch / f"{task.case.solver.name}_{line}.npy"


def _section_errors(tasks: Sequence[Task], answered: Sequence[bool]) -> FloatArray:
    """(s, s, k) of every solver against every other, at the samples; NaN without both fields."""
    samples = tasks[0].samples
    errors = np.full((len(tasks), len(tasks), len(samples)), np.nan)
    for k, line in enumerate(samples):
        files = {i: _field_file(task, line) for i, task in enumerate(tasks) if answered[i]}
        fields = {i: np.load(file) for i, file in files.items() if file.exists()}
        for i, q in fields.items():
            for j, expected in fields.items():
                errors[i, j, k] = section_error(q, expected)
    return errors


def section_error(q: ComplexArray, expected: ComplexArray) -> float:
    """Largest ||q - expected|| / ||expected|| over sections and loads.

    q, expected: (n_sections, n_face, n_loads); the norms are over a section's dofs.
    """
    lack, size = (np.linalg.norm(x, axis=1) for x in (q - expected, expected))
    return float(_relative(lack, size).max())


def response_difference(H: ComplexArray, expected: ComplexArray) -> FloatArray:
    """(f,) largest difference of responses (l, p, f), relative to the norm over the probes.

    A line's norm is that of `expected` under the same load: single responses may be zero by
    symmetry.
    """
    lack = np.abs(H - expected).max(axis=1)
    return _relative(lack, np.linalg.norm(expected, axis=1)).max(axis=0)


def _relative(lack: FloatArray, size: FloatArray) -> FloatArray:
    """What is lacking over the size; 0 / 0 is no difference at all."""
    without = np.where(lack == 0.0, 0.0, np.inf)
    return np.divide(lack, size, out=without, where=size != 0.0)


def _gathered(
    model: Model,
    solvers: tuple[str, ...],
    outcomes: Sequence[Answer | str],
    samples: IntArray,
    section_error: FloatArray,
    case_text: str,
) -> Comparison:
    """Everything under the names that users know."""
    frequency = np.array(model.case.frequency.lines())
    n_probes = len(model.probes)
    failure = tuple(found if isinstance(found, str) else "" for found in outcomes)
    answers = [_nothing(model, f) if isinstance(f, str) else f for f in outcomes]
    receptance = np.array([a.spectrum.receptance[:n_probes].swapaxes(0, 1) for a in answers])
    truth = receptance[solvers.index(reference_of(solvers, failure))]
    inflation = model.inflation
    origin = provenance_of(model.case, case_text, sizes(model))
    return Comparison(
        frequency=frequency,
        solvers=solvers,
        loads=model.loads,
        probes=model.probes,
        receptance=receptance,
        seconds=np.array([a.spectrum.solve_time for a in answers]),
        prepare_seconds=np.array([a.spectrum.prepare_time for a in answers]),
        peak_memory=np.array([a.peak_memory for a in answers]),
        base_memory=np.array([a.base_memory for a in answers]),
        disk=np.array([a.disk for a in answers]),
        residual=np.array([a.spectrum.residual for a in answers]),
        difference=np.array([response_difference(H, truth) for H in receptance]),
        samples=samples,
        section_error=section_error,
        remark=tuple(a.spectrum.remark for a in answers),
        failure=failure,
        machine=machine() | {"BLAS": next((a.blas for a in answers if a.blas), "unknown")},
        section=model.mesh.left,
        provenance=origin,
        inflation=None if inflation is None else static_state(model, inflation),
    )


def _nothing(model: Model, why: str) -> Answer:
    """The answer of a solver that gave none."""
    problem, n = model.problem, len(model.case.frequency.lines())
    nan, lines = float("nan"), np.full(n, np.nan)
    nowhere = np.full((*problem.shape, n), complex(nan, nan))
    return Answer(Spectrum(nowhere, lines, lines.copy(), (why,) * n, nan), nan, nan, nan, "")
