"""Time per line of every solver against the number of cells, and where the recursion's goes.

    python -m benchmarks.cells

The layered tyre's section, one element around in each of N cells; one thread. Joins grow with the
logarithm of N. The field of all sections has N times the dofs of one, by whatever solver, and so
has the proof of a line, its residual over the whole ring: both grow with N.
"""

from __future__ import annotations

from benchmarks.growth import COLUMNS, LEFT_OUT, grown
from benchmarks.machine import description, interleaved, ms, one_thread, table
from benchmarks.parts import CELL, CHECK, JOINS, LINE, parts_of, recovery
from benchmarks.tyres import OBLIQUE, problem_under, section_dofs, tyres, with_cells

CELLS = (4, 8, 15, 30, 45, 60, 90, 180, 360, 720, 1440)
FROM, TO = 45, 720
"""Cells between which the growth is stated."""


def measured(tyre: str = "layered", cells: tuple[int, ...] = CELLS) -> str:
    """The tables, in Markdown."""
    case = tyres()[tyre]
    problems = [problem_under(with_cells(case, N), OBLIQUE) for N in cells]
    with one_thread():
        found = grown(problems)
        parts = [interleaved(parts_of(problem)) for problem in problems]
    split = dict(zip(cells, parts, strict=True))
    every = [
        [str(N), *(row[name] for name in COLUMNS)] for N, row in zip(cells, found, strict=True)
    ]
    head = f"{tyre.capitalize()} tyre, {section_dofs(problems[0])} section dofs, load {OBLIQUE}; "
    every_solver = table(["cells", *COLUMNS], every)
    return (
        f"{head}ms per line, one thread. {LEFT_OUT}\n\n{every_solver}\n\n"
        f"What a line by `recursive` consists of [ms]. {growth_of(split)}\n\n{_parts(split)}"
    )


def _parts(split: dict[int, dict[str, float]]) -> str:
    """The recursion's line in its parts, by number of cells."""
    header = ["cells", CELL, JOINS, "recovery of all sections", CHECK, LINE]
    rows = [
        [str(N), *map(ms, (s[CELL], s[JOINS], recovery(s), s[CHECK], s[LINE]))]
        for N, s in split.items()
    ]
    return table(header, rows)


def growth_of(parts: dict[int, dict[str, float]]) -> str:
    """How many times more the larger ring costs, in a sentence; "" where it was not measured."""
    if FROM not in parts or TO not in parts:
        return ""
    line, joins = (parts[TO][part] / parts[FROM][part] for part in (LINE, JOINS))
    return f"From {FROM} to {TO} cells the joins cost {joins:.2f} times more, a line {line:.2f}."


if __name__ == "__main__":
    print(description())
    print(measured())
