"""What a sweep of three moduli costs, beside one run of the same tyre.

    python -m benchmarks.sweep

The promise: on both cores, start-up plus at most 1.05 times the points times one point's solving
time. A point's solving time is what its lines take in a run on as many cores, without start-up,
meshing and assembly. The first, short sweep starts the worker processes; it is not timed.
"""

from __future__ import annotations

import statistics
import time

import numpy as np

from benchmarks.machine import description, table
from tyrefrf.case import Case, make_grid, parse_case, starter_text
from tyrefrf.study.model import build_model
from tyrefrf.study.run import cores
from tyrefrf.study.spectrum import solve_spectrum
from tyrefrf.study.sweep import run_sweep

MODULI = (14e6, 28e6, 56e6)
REPEATS = 3
PROMISE = 1.05


def measured() -> str:
    """The table, in Markdown."""
    case = parse_case(starter_text(), "starter", "tyre")
    n_lines = len(case.frequency.lines())
    run_sweep(make_grid(case, {"E_rubber": MODULI[:1]}), jobs=cores())  # starts the workers
    singles, sweeps, busy = [], [], []
    for _ in range(REPEATS):  # in turn: others on the machine disturb both alike
        singles.append(_seconds_of_one(case, MODULI[0]))
        start = time.perf_counter()
        swept = run_sweep(make_grid(case, {"E_rubber": MODULI}), jobs=cores())
        sweeps.append(time.perf_counter() - start)
        busy.append(float(swept.solve_time.sum()) / (cores() * sweeps[-1]))
    shares = [all_ / (len(MODULI) * one) for all_, one in zip(sweeps, singles, strict=True)]
    rows = [
        ["one point, solving alone [s]", *_spread(singles)],
        [f"sweep of {len(MODULI)} points, all of it [s]", *_spread(sweeps)],
        [f"sweep over {len(MODULI)} x one point", *_spread(shares)],
        ["share of the cores' time that lines take, in the sweep", *_spread(busy)],
    ]
    head = (
        f"{n_lines} lines, moduli {', '.join(f'{E / 1e6:g}' for E in MODULI)} MPa, "
        f"{cores()} processes; median and range of {REPEATS}. Promised: at most {PROMISE} and "
        "start-up. Not shown: plots and writing."
    )
    return f"{head}\n\n" + table(["what", "median", "range"], rows)


def _seconds_of_one(case: Case, modulus: float) -> float:
    """Wall time [s] of one point's lines, everything else done before."""
    grid = make_grid(case, {"E_rubber": (modulus,)})
    model = build_model(grid.cases[0])
    frequency = np.array(case.frequency.lines())
    start = time.perf_counter()
    solve_spectrum(model.problem, case.solver.name, frequency, cores())
    return time.perf_counter() - start


def _spread(values: list[float]) -> list[str]:
    return [f"{statistics.median(values):.3f}", f"{min(values):.3f} to {max(values):.3f}"]


if __name__ == "__main__":
    print(description())
    print(measured())
