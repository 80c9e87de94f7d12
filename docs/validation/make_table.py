"""Measure this program's table 2.

    python docs/validation/make_table.py

Writes table2.md beside this; wants a quiet machine. Nothing is typed but the paper's own numbers.
"""

from __future__ import annotations

from pathlib import Path

from tyrefrf.cli.comparing import comparison_summary, in_markdown, pair_table, table_of
from tyrefrf.results import Comparison
from tyrefrf.solvers.direct import check_library
from tyrefrf.study.compare import compare

HERE = Path(__file__).parent
CASES = HERE.parents[1] / "cases" / "paper"
LINES = 24

PAGE = """\
# Table 2

The paper's layered tyre under 2 bar (`cases/paper/figure08.toml`), {lines} lines from {low:g} to
{high:g} Hz, one solver after another, each in a process and on a core of its own:

{table}

Times are processor time per line, median and the tenths at both ends; memory is the process's peak,
and what of it the solver added; on disk is the results file. The difference is that of section
displacements, largest of all sections. `modal` superposes 1000 modes, to {last}, and is compared
at all lines, above that too. `direct` factorises by {library}.

{machine}.

Largest difference of the solver of the row to that of the column:

{pairs}

The paper's table 2, on its computer of 2011 (core 2 quad, 4 GB):

| method | CPU time per frequency | data size |
| --- | --- | --- |
| Ansys 3D direct solver | 133 s | 26 GB |
| Ansys 3D with 1000 modes | 3 s | 28 GB |
| recursive method | 10 s | 2 MB |

Made by `python docs/validation/make_table.py`; the same for any case: `tyrefrf compare CASE
--solvers recursive,cyclic,direct,modal`.

How far the recursion and modal synthesis agree, and up to which frequency, is figure 8 of the
[gallery](../gallery/index.rst).
"""


def main() -> None:
    """Measure it."""
    case = CASES / "figure08.toml"
    measured = compare(case, ["recursive", "cyclic", "direct", "modal"], lines=LINES)
    page = HERE / "table2.md"
    page.write_text(page_of(measured), encoding="utf-8")
    print(page)


def page_of(measured: Comparison) -> str:
    """The page."""
    facts = comparison_summary(measured, [])
    remarks = {text for text in facts["remarks"] if "last mode" in text}
    known = {name: value for name, value in facts["machine"].items() if name != "system"}
    machine = ", ".join(f"{name} {value}" for name, value in known.items())
    return PAGE.format(
        lines=facts["lines"],
        low=facts["first_frequency"],
        high=facts["last_frequency"],
        table=in_markdown(table_of(facts)),
        pairs=in_markdown(pair_table(facts)),
        machine=machine,
        library=check_library("auto"),
        last=min(remarks).rpartition("at ")[2] if remarks else "above the last line",
    )


if __name__ == "__main__":
    main()
