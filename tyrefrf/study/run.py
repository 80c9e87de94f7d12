"""The main job: a case becomes results."""

from __future__ import annotations

import os
import time
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import numpy as np

from tyrefrf.case import Case, case_hash, load_case, read_text, resolved_toml
from tyrefrf.results import Provenance, Results
from tyrefrf.study.model import Model, build_model
from tyrefrf.study.spectrum import Progress, Spectrum, solve_spectrum


def run(case: Case | str | Path, *, jobs: int | None = None) -> Results:
    """Compute a case, or the case in a file, from Python: `tyrefrf.run("case.toml")`.

    jobs: processes, all cores by default. Raises CaseError and MeshError as `run_case`.
    """
    if isinstance(case, Case):
        return run_case(case, jobs=jobs)
    path = Path(case)
    return run_case(load_case(path), jobs=jobs, case_text=read_text(path))


def run_case(
    case: Case,
    *,
    jobs: int | None = None,
    case_text: str = "",
    progress: Progress = lambda n_lines: None,
) -> Results:
    """Compute the responses that a case describes.

    jobs: processes, all cores by default; results do not depend on it. case_text: the file as
    its author wrote it, kept with the results. progress: called with lines just finished.
    Raises CaseError and MeshError for a case that cannot be computed; a line that cannot be
    solved is NaN in the results, with the reason in `remark`.
    """
    start = time.perf_counter()
    model = build_model(case)
    frequency = np.array(case.frequency.lines())
    spectrum = solve_spectrum(model.problem, case.solver.name, frequency, jobs or cores(), progress)
    return _results(model, frequency, spectrum, case_text, time.perf_counter() - start)


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _results(
    model: Model, frequency: np.ndarray, spectrum: Spectrum, case_text: str, seconds: float
) -> Results:
    """Put the arrays under the names that users know."""
    case, n_probes = model.case, len(model.probes)
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
        section=model.mesh.section,
        provenance=Provenance(
            case_name=case.name,
            title=case.title or case.name,
            case_text=case_text,
            resolved_case=resolved_toml(case),
            case_hash=case_hash(case),
            version=version("tyrefrf"),
            solver=case.solver.name,
            created=datetime.now(UTC).isoformat(timespec="seconds"),
            n_cells=case.cell.n_cells,
            sector_angle=model.mesh.sector_angle,
            numbers={
                "section_nodes": model.mesh.n_face,
                "cell_nodes": model.mesh.n_nodes,
                "ring_nodes": model.mesh.n_own * case.cell.n_cells,
                "ring_dofs": model.problem.n_ring_dofs,
                "seconds": seconds,
            },
        ),
    )
