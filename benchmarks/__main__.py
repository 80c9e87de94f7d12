"""Run every benchmark; write RESULTS.md and the README's tables: `python -m benchmarks`."""

from __future__ import annotations

import re
from pathlib import Path

from benchmarks import accuracy, adaptive, element_accuracy, footprint, machine, speed, sweep

HERE = Path(__file__).parent
IN_README = ("Speed", "Accuracy of the solvers", "A whole run")
SECTIONS = {
    "Speed": speed.measured,
    "Accuracy of the solvers": accuracy.measured,
    "Accuracy of the elements": element_accuracy.table,
    "A whole run": footprint.measured,
    "A sweep": sweep.measured,
    "Adaptive lines": adaptive.measured,
}


def main() -> None:
    """Measure everything, one after the other, on a machine that should do nothing else."""
    origin = f"Made by `python -m benchmarks` on {machine.description()}."
    found = {}
    for title, measured in SECTIONS.items():
        print(title, flush=True)
        found[title] = measured()
    parts = [f"# Benchmarks\n\n{origin}", *(f"## {name}\n\n{found[name]}" for name in found)]
    (HERE / "RESULTS.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")

    readme = HERE.parent / "README.md"
    tables = "\n\n".join([origin, *(f"{name}. {found[name]}" for name in IN_README)])
    marked = re.compile(r"(<!-- results -->\n).*?(<!-- /results -->)", re.DOTALL)
    text = marked.sub(lambda m: f"{m[1]}\n{tables}\n\n{m[2]}", readme.read_text(encoding="utf-8"))
    readme.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
