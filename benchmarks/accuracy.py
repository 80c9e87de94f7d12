"""How far the solvers differ on the paper's homogeneous tyre, at every section.

    python -m benchmarks.accuracy

The error is the norm of the difference over a section's displacement, relative to the norm of
that section's displacement; the largest over all sections, both loads and 20 lines in 5-2000 Hz.
The paper's own comparison, of its recursion with the full model, gave 4e-6.
"""

from __future__ import annotations

import numpy as np

from benchmarks.machine import description, table
from tyrefrf.case import parse_case, starter_text
from tyrefrf.solvers import SOLVERS
from tyrefrf.study.model import build_model

FREQUENCIES = np.linspace(5.0, 2000.0, 20)


def measured() -> str:
    """The table, in Markdown."""
    problem = build_model(parse_case(starter_text(), "starter", "homogeneous")).problem
    solvers = {name: build(problem) for name, build in SOLVERS.items()}
    worst = dict.fromkeys(solvers, 0.0)
    for omega in 2.0 * np.pi * FREQUENCIES:
        q = {name: solver.field(omega).q for name, solver in solvers.items()}
        size = np.linalg.norm(q["direct"], axis=1)
        for name in solvers:
            error = np.linalg.norm(q[name] - q["direct"], axis=1) / size
            worst[name] = max(worst[name], float(error.max()))
    rows = [[f"`{name}`", f"{error:.1e}"] for name, error in worst.items() if name != "direct"]
    return "Largest difference to `direct` over all sections, loads and lines.\n\n" + table(
        ["solver", "error"], rows
    )


if __name__ == "__main__":
    print(description())
    print(measured())
