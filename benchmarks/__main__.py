"""Run every benchmark; write RESULTS.md and the README's tables: `python -m benchmarks`."""

from __future__ import annotations

import re
from pathlib import Path

from benchmarks import (
    accuracy,
    adaptive,
    cells,
    element_accuracy,
    footprint,
    kernels,
    lines,
    machine,
    memory,
    operations,
    section,
    speed,
    startup,
    sweep,
)

HERE = Path(__file__).parent
IN_README = ("Speed", "Accuracy of the solvers", "A whole run")
SECTIONS = {
    "Speed": speed.measured,
    "Operations": operations.measured,
    "Factorisation of a join": kernels.measured,
    "Section dofs": section.measured,
    "Cells": cells.measured,
    "Lines": lines.measured,
    "Start-up": startup.measured,
    "Memory": memory.measured,
    "A whole run": footprint.measured,
    "Accuracy of the solvers": accuracy.measured,
    "Accuracy of the elements": element_accuracy.table,
    "A sweep": sweep.measured,
    "Adaptive lines": adaptive.measured,
}


BLOCK = re.compile(r"(<!-- results -->\n).*?(<!-- /results -->)", re.DOTALL)
"""In the README: where its tables stand."""


def main() -> None:
    """Measure everything, one after the other, on a machine that should do nothing else."""
    origin = f"Made by `python -m benchmarks` on {machine.description()}."
    found = {}
    for title, measured in SECTIONS.items():
        print(title, flush=True)
        found[title] = measured()
        (HERE / "RESULTS.md").write_text(page(origin, found), encoding="utf-8")
    readme = HERE.parent / "README.md"
    text = readme.read_text(encoding="utf-8")
    readme.write_text(with_tables(text, origin, found), encoding="utf-8")


def page(origin: str, found: dict[str, str]) -> str:
    """RESULTS.md: all tables by their titles."""
    parts = [f"# Benchmarks\n\n{origin}", *(f"## {name}\n\n{found[name]}" for name in found)]
    return "\n\n".join(parts) + "\n"


def with_tables(readme: str, origin: str, found: dict[str, str]) -> str:
    """The README with some of the tables in their block."""
    tables = "\n\n".join([origin, *(f"{name}. {found[name]}" for name in IN_README)])
    return BLOCK.sub(lambda m: f"{m[1]}\n{tables}\n\n{m[2]}", readme)


if __name__ == "__main__":
    main()
