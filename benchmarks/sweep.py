"""What the paper's parameter studies cost, beside runs of their points alone.

    python -m benchmarks.sweep

The promise: on both cores, start-up plus at most 1.05 times the points times one point's solving
time. A point's solving time is what its lines take in a run on as many cores, without start-up,
meshing and assembly. The first, short sweep starts the worker processes; it is not timed.
"""

from __future__ import annotations

import statistics
import time
from pathlib import Path

import numpy as np

from benchmarks.machine import description, table
from benchmarks.tyres import with_solver
from tyrefrf.case import Case, load_case, make_grid
from tyrefrf.study.local import cores
from tyrefrf.study.model import build_model
from tyrefrf.study.spectrum import solve_spectrum
from tyrefrf.study.sweep import run_sweep

CASES = Path(__file__).parents[1] / "cases" / "paper"
STUDIES = {"figure09": ("E_rubber", 3), "figure10": ("pressure", 1)}
"""The paper's two parameter studies: what each sweeps, and how often it is measured."""

PROMISE = 1.05


def measured() -> str:
    """The table, in Markdown."""
    warm = load_case(CASES / "figure05.toml")
    run_sweep(make_grid(warm, {"E_rubber": (8e7,)}), jobs=cores())  # starts the workers
    rows = [_row(name, *study) for name, study in STUDIES.items()]
    head = (
        f"{cores()} processes; median (and range where measured more than once). Promised: at most "
        f"{PROMISE} and start-up. By `cyclic`, every line solved. Not shown: plots and writing."
    )
    columns = ["case", "lines", "points", "one point [s]", "sweep [s]"]
    columns += ["sweep over points x one", "share of the cores' time in lines"]
    return f"{head}\n\n" + table(columns, rows)


def _row(name: str, parameter: str, repeats: int) -> list[str]:
    """One study measured; its points' solving times are those of runs of each alone."""
    case = with_solver(load_case(CASES / f"{name}.toml"), "cyclic")
    every = case.frequency.model_copy(update={"adaptive": False})
    grid = make_grid(case.model_copy(update={"frequency": every}), {parameter: None})
    ones, sweeps, shares, busy = [], [], [], []
    for _ in range(repeats):  # in turn: others on the machine disturb both alike
        ones.append(statistics.mean(_seconds_of_one(point) for point in grid.cases))
        start = time.perf_counter()
        swept = run_sweep(grid, jobs=cores())
        sweeps.append(time.perf_counter() - start)
        shares.append(sweeps[-1] / (len(grid.cases) * ones[-1]))
        busy.append(float(swept.solve_time.sum()) / (cores() * sweeps[-1]))
    lines = str(len(case.frequency.lines()))
    return [name, lines, str(len(grid.cases)), *map(_spread, (ones, sweeps, shares, busy))]


def _seconds_of_one(case: Case) -> float:
    """Wall time [s] of one point's lines, everything else done before."""
    model = build_model(case)
    frequency = np.array(case.frequency.lines())
    start = time.perf_counter()
    solve_spectrum(model.problem, case.solver, frequency, cores())
    return time.perf_counter() - start


def _spread(values: list[float]) -> str:
    median = f"{statistics.median(values):.3f}"
    return f"{median} ({min(values):.3f} to {max(values):.3f})" if len(values) > 1 else median


if __name__ == "__main__":
    print(description())
    print(measured())
