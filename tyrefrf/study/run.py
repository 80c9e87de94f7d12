"""The main job: a case becomes results."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import numpy as np

from tyrefrf.arrays import FloatArray
from tyrefrf.case import Case, case_hash, file_digests, load_case, read_text, resolved_toml
from tyrefrf.errors import CommandError
from tyrefrf.fem.inflation import Inflation
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.results import Provenance, Results, StaticState, read_measured
from tyrefrf.study.adaptive import solve_case
from tyrefrf.study.certify import certified, plan_certificate
from tyrefrf.study.choose import decided_model
from tyrefrf.study.executor import Workers, executor_of
from tyrefrf.study.local import cores, pinned
from tyrefrf.study.memory import check_fits, need_of_run
from tyrefrf.study.model import Model, build_model
from tyrefrf.study.resume import recorded
from tyrefrf.study.spectrum import UNRECORDED, Fit, Progress, Record, Spectrum


def run(
    case: Case | str | Path,
    *,
    jobs: Workers | None = None,
    certify: bool = False,
    journal: str | Path | None = None,
) -> Results:
    """Compute a case, or the case in a file, from Python: `tyrefrf.run("case.toml")`.

    jobs: processes, all cores by default, or a cluster's: `with tyrefrf.cluster(address) as jobs`.
    certify: whether another solver and a ring of finer cells solve a sample of the lines too.
    journal: file to which every line is added as soon as it is solved. Where it is there, its lines
        are not solved again; it stays until you remove it.
    Raises CaseError and MeshError as `run_case`; CommandError where the journal is that of another
    case.
    """
    text = ""
    if not isinstance(case, Case):
        path = Path(case)
        case, text = load_case(path), read_text(path)
    with recorded(case, journal, Results) as (decided, record, _):
        results = run_case(decided, jobs=jobs, case_text=text, record=record)
    return certified(plan_certificate(case, results), jobs or cores()) if certify else results


@pinned
def run_case(
    case: Case,
    *,
    jobs: Workers | None = None,
    case_text: str = "",
    progress: Progress = lambda n_lines: None,
    record: Record = UNRECORDED,
) -> Results:
    """Compute the responses that a case describes.

    jobs: processes, all cores by default, or an executor; results do not depend on it. case_text:
    the file as its author wrote it, kept with the results. progress: called with lines just
    finished. record: where lines are kept as they are solved; those that it knows are not solved
    again.
    Raises CaseError and MeshError for a case that cannot be computed, CommandError where a file
    that it names changes while it is read, SolveError where memory is too short for it; a line that
    cannot be solved is NaN in the results, with the reason in `remark`.
    """
    start = time.perf_counter()
    frequency = np.array(case.frequency.lines())
    executor = executor_of(jobs or cores(), len(frequency))
    with read_once(case):
        measured = read_measured(case.measured, case.directory)
        model, expected = decided_model(build_model(case))
        origin = provenance_of(model.case, case_text, {**sizes(model), **expected})
    check_fits(need_of_run(model.case, [model.problem], executor.here))
    blank = results_of(model, frequency, no_line(model, len(frequency)), origin)
    record.begin(replace(blank, measured=measured))
    spectrum = solve_case([model.problem], model.case, executor, progress, record)[0]
    origin = ended(origin, start, record)
    return replace(results_of(model, frequency, spectrum, origin), measured=measured)


@contextmanager
def read_once(case: Case) -> Iterator[None]:
    """For the time in which the files that a case names are read.

    Raises CommandError where one is another at the end: nobody would know which has been read.
    """
    before = file_digests(case)
    yield
    if file_digests(case) != before:
        names = ", ".join(name for name, _ in before)
        raise CommandError(f"what the case names ({names}) was changed while it was read")


def ended(origin: Provenance, start: float, record: Record) -> Provenance:
    """Where results come from whose last line has just been solved."""
    numbers = {**resumed_lines(record), "seconds": time.perf_counter() - start}
    return replace(origin, numbers=origin.numbers | numbers, created=now())


def no_line(model: Model, n_lines: int) -> Spectrum:
    """What is there before the first line."""
    unknown = np.full(n_lines, np.nan)
    receptance = np.full((*model.problem.shape, n_lines), complex(np.nan, np.nan))
    return Spectrum(receptance, unknown, unknown.copy(), ("",) * n_lines, 0.0)


def resumed_lines(record: Record) -> dict[str, float | int]:
    """How many lines were there from an earlier run; nothing where none was."""
    return {"resumed_lines": len(record.known)} if record.known else {}


def sizes(model: Model) -> dict[str, float | int]:
    """How large a model is, and how far a linear inflation strains it."""
    strain = model.inflation.strain if model.inflation else np.nan
    return {
        **({} if np.isnan(strain) else {"inflation_strain": strain}),
        "section_nodes": model.mesh.n_face,
        "cell_nodes": model.mesh.n_nodes,
        "ring_nodes": model.mesh.n_own * model.case.cell.n_cells,
        "ring_dofs": model.problem.n_ring_dofs,
    }


def results_of(
    model: Model,
    frequency: FloatArray,
    spectrum: Spectrum,
    origin: Provenance,
) -> Results:
    """Put the arrays under the names that users know."""
    n_probes = len(model.probes)
    by_load = spectrum.receptance.transpose(1, 0, 2)
    return Results(
        frequency=frequency,
        loads=model.loads,
        probes=model.probes,
        receptance=by_load[:, :n_probes].copy(),
        blocked_force=by_load[:, n_probes:].copy(),
        solved=~np.isnan(spectrum.residual),
        residual=spectrum.residual,
        solve_time=spectrum.solve_time,
        remark=spectrum.remark,
        section=model.mesh.left,
        provenance=replace(origin, numbers=origin.numbers | _fit_numbers(spectrum.fit)),
        inflation=None if model.inflation is None else static_state(model, model.inflation),
    )


def _fit_numbers(fit: Fit | None) -> dict[str, float | int]:
    """What became of adaptive lines, by the names that results keep; nothing without."""
    if fit is None:
        return {}
    return {
        "solved_lines": fit.n_solved,
        "narrow_lines": fit.n_narrow,
        "fit_tolerance": fit.tolerance,
        "fit_error": fit.error,
    }


def static_state(model: Model, state: Inflation) -> StaticState:
    """What of an inflation is kept: that of the left section and its elements."""
    assert isinstance(model.mesh, CellMesh)  # brought matrices are not inflated
    return StaticState(
        pressure=model.case.inflation.pressure,
        displacement=state.displacement[: model.mesh.n_face, :2].copy(),
        stress=state.stress[model.mesh.left_bricks],
        resultant=state.resultant,
        share=np.array([step.share for step in state.steps]),
        iterations=np.array([step.iterations for step in state.steps]),
        lack=np.array([step.residual for step in state.steps]),
    )


def provenance_of(case: Case, case_text: str, numbers: dict[str, float | int]) -> Provenance:
    """Where results of this case come from, made now."""
    return Provenance(
        case_name=case.name,
        title=case.title or case.name,
        case_text=case_text,
        resolved_case=resolved_toml(case),
        case_hash=case_hash(case),
        version=version("tyrefrf"),
        solver=case.solver.name,
        created=now(),
        n_cells=case.cell.n_cells,
        sector_angle=2.0 * np.pi / case.cell.n_cells,
        numbers=numbers,
    )


def now() -> str:
    """The time, as results keep it."""
    return datetime.now(UTC).isoformat(timespec="seconds")
