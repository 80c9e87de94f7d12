"""How much memory a line takes by every solver.

    python -m benchmarks.memory

Each solver works in a process of its own; the peak is that of the process, Python, numpy and the
tyre included, and what of it the solver added. The paper's method needed 2 MB of data on disk,
whatever N, the direct solution of its table 2 26 GB; here nothing but results goes to disk.
"""

from __future__ import annotations

from benchmarks.machine import NOT_HERE, description, table
from benchmarks.tyres import size_of, tyres, with_cells
from tyrefrf.case import Case, Frequency, Solver
from tyrefrf.solvers import mkl
from tyrefrf.study.compare import compare
from tyrefrf.study.model import build_model

SOLVERS = ("recursive", "cyclic", "modal")
LIBRARIES = ("pardiso", "superlu")
MANY_CELLS = 720
"""Of the layered section, where only the solvers that this program is for are tried."""


def measured() -> str:
    """The table, in Markdown."""
    many = with_cells(tyres()["layered"], MANY_CELLS)
    rows = [_row(name, case, LIBRARIES) for name, case in tyres().items()]
    rows.append(_row("layered", many, ()))
    header = ["tyre", *(f"`{name}`" for name in SOLVERS)]
    header += [f"`direct`, {library}" for library in LIBRARIES]
    head = "Peak memory of a process that solves two lines [MB], and what of it the solver added."
    return f"{head}\n\n" + table(header, rows)


def _row(name: str, case: Case, libraries: tuple[str, ...]) -> list[str]:
    """One tyre by every solver."""
    solvers = SOLVERS if libraries else ("recursive", "cyclic")
    words = peaks(case, solvers)
    for library in libraries:
        if library == "superlu" or mkl.installed():
            direct = Solver.model_validate({"name": "direct", "library": library})
            there = peaks(case.model_copy(update={"solver": direct}), ("direct",))
            words[library] = there["direct"]
    cells = [words.get(column, NOT_HERE) for column in (*SOLVERS, *LIBRARIES)]
    return [f"{name}: {size_of(build_model(case).problem)}", *cells]


def peaks(case: Case, solvers: tuple[str, ...]) -> dict[str, str]:
    """Peak of each solver's process [MB], and in brackets what the solver added."""
    two = Frequency.model_validate({"values": [350.0, 700.0]})
    found = compare(case.model_copy(update={"frequency": two}), solvers)
    added = found.peak_memory - found.base_memory
    return {
        name: f"{peak / 1e6:.0f} ({more / 1e6:.0f})"
        for name, peak, more in zip(solvers, found.peak_memory, added, strict=True)
    }


if __name__ == "__main__":
    print(description())
    print(measured())
