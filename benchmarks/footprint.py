"""Wall time, peak memory and file size of whole runs, from the shell prompt to the last plot.

    python -m benchmarks.footprint

The homogeneous tyre's case as it is, by one process and by two; and the whole of the paper's figure
7, the layered tyre with all its probes at 2001 lines from 0 to 2000 Hz, by the cyclic solver and by
the recursion, adaptively and with every line solved. Memory is what Linux's /proc says of the main
process, and of it and its workers together at one moment. The paper's method needed 2 MB of data.
"""

from __future__ import annotations

import json
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.command import bytes_in, run_case_file
from benchmarks.machine import description, table
from benchmarks.tyres import with_lines, with_solver
from tyrefrf.case import Case, load_case

CASES = Path(__file__).parents[1] / "cases"
LINES = 2001
WAYS = (("cyclic", True, 3), ("recursive", True, 2), ("cyclic", False, 1), ("recursive", False, 1))
"""Of figure 7: solver, whether its lines are adaptive, and how many runs; the quickest counts."""


def measured() -> str:
    """The table, in Markdown."""
    homogeneous = load_case(CASES / "homogeneous.toml")
    seventh = load_case(CASES / "paper" / "figure07.toml")
    rows = [_row(homogeneous, "as it is", jobs, 1) for jobs in (1, 2)]
    for solver, adaptive, runs in WAYS:
        case = with_lines(with_solver(seventh, solver), LINES, adaptive=adaptive)
        rows.append(_row(case, "adaptive" if adaptive else "all lines", 2, runs))
    header = ["case", "solver", "lines", "solved", "jobs", "wall [s]", "main process [MB]"]
    header += ["all processes [MB]", "results [MB]", "with plots [MB]", "residual"]
    head = "`tyrefrf run`, plots and all; a page that processes share counts once in all of them."
    return f"{head}\n\n" + table(header, rows)


def _row(case: Case, words: str, jobs: int, runs: int) -> list[str]:
    """One case, run so often."""
    with TemporaryDirectory() as scratch:
        directory = Path(scratch)
        options = ("--jobs", str(jobs))
        found = [run_case_file(case, directory, *options, watch=True) for _ in range(runs)]
        facts = json.loads(found[-1].out)
        results = bytes_in(directory, "*.h5")
        everything = bytes_in(directory / case.name)
    solved = facts.get("solved_lines", facts["lines"])
    quickest = min(found, key=lambda outcome: outcome.seconds)
    return [
        *(f"{case.name}, {words}", f"`{case.solver.name}`"),
        *(str(facts["lines"]), str(solved), str(jobs), f"{quickest.seconds:.1f}"),
        *(f"{size / 1e6:.0f}" for size in (quickest.main, quickest.together)),
        *(f"{size / 1e6:.2f}" for size in (results, everything)),
        f"{facts['largest_residual']:.1e}",
    ]


if __name__ == "__main__":
    print(description())
    print(measured())
