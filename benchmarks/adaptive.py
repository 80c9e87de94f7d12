"""What adaptive lines save, and how wrong the fitted ones are.

    python -m benchmarks.adaptive

Every case is run twice by `cyclic`, with all lines solved and adaptively, at the default
tolerance. The error is the worst of any response on any line, relative to the peak of its load's
driving point, in receptance and in mobility; the hub's forces relative to their largest peak.
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from benchmarks.machine import description, table
from tyrefrf.case import Case, Solver, load_case
from tyrefrf.results import Results
from tyrefrf.study.local import cores
from tyrefrf.study.run import run_case

CASES = Path(__file__).parents[1] / "cases"
STEPS = {"homogeneous": 1.0, "paper/layered": 1.0}
"""Distance of the lines from 0 to 2000 Hz."""
DAMPING = {"as it is": None, "eta = 0.001": 0.001}


def measured() -> str:
    """The table, in Markdown."""
    rows = [
        _row(name, step, words, eta)
        for name, step in STEPS.items()
        for words, eta in DAMPING.items()
        if name == "homogeneous" or eta is None
    ]
    head = (
        f"{cores()} processes, meshing and assembly included, plots and writing not. The error "
        "found is that on held-back lines; the true one is against all lines solved."
    )
    columns = ["case", "damping", "lines", "solved", "at narrow resonances"]
    columns += ["error found", "true error", "all solved [s]", "adaptive [s]"]
    return f"{head}\n\n" + table(columns, rows)


def _row(name: str, step: float, words: str, eta: float | None) -> list[str]:
    """One case, both ways."""
    case = _case(name, step, eta)
    solved, all_seconds = _timed(case)
    fitted, seconds = _timed(_adaptive(case))
    numbers = fitted.provenance.numbers
    counts = (len(fitted.frequency), numbers["solved_lines"], numbers["narrow_lines"])
    errors = (float(numbers["fit_error"]), largest_error(fitted, solved))
    return [
        *(name, words),
        *map(str, counts),
        *(f"{error:.1e}" for error in errors),
        *(f"{time:.1f}" for time in (all_seconds, seconds)),
    ]


def _case(name: str, step: float, eta: float | None) -> Case:
    case = load_case(CASES / f"{name}.toml")
    frequency = case.frequency.model_copy(
        update={"start": 0.0, "stop": 2000.0, "step": step, "adaptive": False}
    )
    materials = {
        key: stuff if eta is None else stuff.model_copy(update={"eta": eta})
        for key, stuff in case.materials.items()
    }
    solver = Solver(name="cyclic")
    changes = {"frequency": frequency, "materials": materials, "solver": solver}
    return case.model_copy(update=changes)


def _adaptive(case: Case) -> Case:
    frequency = case.frequency.model_copy(update={"adaptive": True})
    return case.model_copy(update={"frequency": frequency})


def _timed(case: Case) -> tuple[Results, float]:
    start = time.perf_counter()
    results = run_case(case)
    return results, time.perf_counter() - start


def largest_error(fitted: Results, solved: Results) -> float:
    """As the module says."""
    errors = []
    for i, load in enumerate(solved.loads):
        for here, there, peak in (
            (fitted.receptance, solved.receptance, solved.driving_point(load.name, "receptance")),
            (fitted.mobility, solved.mobility, solved.driving_point(load.name, "mobility")),
            (fitted.blocked_force, solved.blocked_force, solved.blocked_force[i, :3]),
        ):
            difference = np.abs(here[i] - there[i]).max(initial=0.0)
            errors.append(difference / np.abs(peak).max(initial=1e-300))
    return float(max(errors))


if __name__ == "__main__":
    print(description())
    print(measured())
