"""Time per line of every solver against the number of dofs of a section.

    python -m benchmarks.section

The homogeneous tyre, its section meshed ever finer along and through the wall; one thread. The
recursion's matrices have a row for every dof of the section, and cost its cube; the bands of the
cyclic solver are as wide as the wall has nodes through it.
"""

from __future__ import annotations

from benchmarks.growth import COLUMNS, LEFT_OUT, grown
from benchmarks.machine import description, one_thread, table
from benchmarks.tyres import (
    OBLIQUE,
    problem_under,
    section_dofs,
    tyres,
    with_elements,
)

ELEMENTS = ((18, 1), (28, 1), (56, 1), (56, 2), (84, 2), (84, 3), (100, 4), (112, 5))
"""Along and through the wall: 102 to 1998 dofs; 28 by 1 are the paper's."""


def measured(elements: tuple[tuple[int, int], ...] = ELEMENTS) -> str:
    """The table, in Markdown."""
    case = tyres()["homogeneous"]
    problems = [problem_under(with_elements(case, *mesh), OBLIQUE) for mesh in elements]
    with one_thread():
        found = grown(problems)
    rows = [
        [f"{along} x {through}", str(section_dofs(problem)), *(row[name] for name in COLUMNS)]
        for (along, through), problem, row in zip(elements, problems, found, strict=True)
    ]
    head = f"Homogeneous tyre, {problems[0].n_cells} cells, load {OBLIQUE}; ms per line, one thread"
    header = ["elements along x through", "section dofs", *COLUMNS]
    return f"{head}. {LEFT_OUT}\n\n" + table(header, rows)


if __name__ == "__main__":
    print(description())
    print(measured())
