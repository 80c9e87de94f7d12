"""Parameter studies: a case at every combination of some parameters' values."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from tyrefrf.arrays import FloatArray
from tyrefrf.case import Case, Grid, Values, load_case, make_grid, read_text
from tyrefrf.results import Measured, Provenance, Results, SweepResults, read_measured
from tyrefrf.study.adaptive import solve_case
from tyrefrf.study.choose import decided, with_solver
from tyrefrf.study.executor import Workers, executor_of
from tyrefrf.study.local import cores, pinned
from tyrefrf.study.memory import check_fits, need_of_run
from tyrefrf.study.model import Model, Workshop
from tyrefrf.study.resume import check_axes, recorded
from tyrefrf.study.run import ended, no_line, provenance_of, read_once, results_of, sizes
from tyrefrf.study.spectrum import UNRECORDED, Progress, Record, Spectrum


def sweep(
    case: Case | str | Path,
    parameters: Mapping[str, Values | None],
    *,
    jobs: Workers | None = None,
    journal: str | Path | None = None,
) -> SweepResults:
    """Compute a case on a grid: `tyrefrf.sweep("case.toml", {"E_rubber": ["14 MPa", 28e6]})`.

    parameters: by place or short name, each with its values as `[sweep]` takes them, or None for
    the values in the case's own `[sweep]`. jobs, journal: as `run` takes them.
    Raises CaseError with everything that is wrong with any point; CommandError as `run`.
    """
    wanted = {
        name: tuple(values) if isinstance(values, list) else values
        for name, values in parameters.items()
    }
    text = ""
    if not isinstance(case, Case):
        path = Path(case)
        case, text = load_case(path), read_text(path)
    with recorded(case, journal, SweepResults) as (decided_case, record, left):
        grid = make_grid(decided_case, wanted)
        if left is not None:
            check_axes(grid.axes, left)
        return run_sweep(grid, jobs=jobs, case_text=text, record=record)


@pinned
def run_sweep(
    grid: Grid,
    *,
    jobs: Workers | None = None,
    case_text: str = "",
    progress: Progress = lambda n_lines: None,
    record: Record = UNRECORDED,
) -> SweepResults:
    """Compute every point of a grid, each to the bit as a run of that point's case alone.

    All points are meshed and assembled before the first line is solved; what they share, once.
    jobs, case_text, progress, record: as `run_case`. Raises CaseError with all points that cannot
    be meshed; a line that cannot be solved is NaN, with the reason in the point's `remark`.
    """
    start = time.perf_counter()
    frequency = np.array(grid.base.frequency.lines())
    executor = executor_of(jobs or cores(), len(frequency) * len(grid.cases))
    with read_once(grid.base):
        measured = read_measured(grid.base.measured, grid.base.directory)
        models = grid.each(Workshop().model)
        base, expected = decided(grid.base, models[0].problem)
        models = [replace(one, case=with_solver(one.case, base.solver.name)) for one in models]
        origins = [provenance_of(one.case, case_text, sizes(one)) for one in models]
        origin = provenance_of(base, case_text, {"points": len(models), **expected})
    problems = [model.problem for model in models]
    check_fits(need_of_run(base, problems, executor.here))
    points = partial(_points, models, frequency, measured, origins)
    blank = points([no_line(model, len(frequency)) for model in models])
    record.begin(SweepResults(grid.axes, blank, origin))
    spectra = solve_case(problems, base, executor, progress, record)
    return SweepResults(grid.axes, points(spectra), ended(origin, start, record))


def _points(
    models: Sequence[Model],
    frequency: FloatArray,
    measured: tuple[Measured, ...],
    origins: Sequence[Provenance],
    spectra: Sequence[Spectrum],
) -> tuple[Results, ...]:
    """The results of every point."""
    return tuple(
        replace(results_of(model, frequency, spectrum, origin), measured=measured)
        for model, spectrum, origin in zip(models, spectra, origins, strict=True)
    )
