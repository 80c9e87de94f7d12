"""See how far digits depend on BLAS threads and on the processor; write digits.md beside this.

    python docs/validation/make_digits.py

Everything is computed in processes of their own, which OpenBLAS is told to treat as other
processors, with other kernels, or to start more threads in. Nothing in the page is typed.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
CASES = HERE.parents[1] / "cases"
TYRES = {
    "homogeneous": "homogeneous.toml",
    "inflated": "paper/figure08.toml",
    "layered, with steel": "paper/layered.toml",
}
SOLVERS = ("recursive", "cyclic", "direct")
LINES = (0.0, 100.0, 700.0, 2000.0)  # Hz
ONE = {"OPENBLAS_NUM_THREADS": "1"}
SETTINGS = {
    "two threads": {"OPENBLAS_NUM_THREADS": "2"},
    "AVX2 (Haswell)": ONE | {"OPENBLAS_CORETYPE": "HASWELL"},
    "AVX2 (Zen)": ONE | {"OPENBLAS_CORETYPE": "ZEN"},
    "SSE3 (Prescott)": ONE | {"OPENBLAS_CORETYPE": "PRESCOTT"},
}
HEAD = """\
# The same digits

On one machine a run gives the same digits to the bit, however often it is repeated: with any number
of jobs, with lines in any order and any company, with any setting of `OPENBLAS_NUM_THREADS` and its
like (`run` uses one thread). tests/study/test_same_digits.py proves it for every solver. With
`solver.name = "auto"` two runs may take different solvers; results say which, and a case that names
it leaves nothing to the clock.

Solvers that are called from Python use as many threads as BLAS is set to, and other processors have
other kernels; these round differently. Below: the largest difference to one thread of this machine
(kernel {kernel}), as the norm over a section's displacement relative to that section's own, of
all sections, loads and the lines {lines} Hz. 0: equal to the bit.

Made by `python docs/validation/make_digits.py` on {machine}.
"""


def main() -> None:
    """Compute everything."""
    from tyrefrf.study.machine import machine

    with tempfile.TemporaryDirectory() as directory:
        own, kernel = answers(Path(directory, "own.npz"), ONE)
        others = {name: answers(Path(directory, f"{name}.npz"), s) for name, s in SETTINGS.items()}
    names = [
        name for name, (_, found) in others.items() if name == "two threads" or found != kernel
    ]
    rows = [["tyre", "solver", *names], ["---"] * (2 + len(names))]
    for key, q in own.items():
        differences = (difference(others[name][0][key], q) for name in names)
        rows.append([*key.split("/"), *(f"{found:.0e}" if found else "0" for found in differences)])
    table = "\n".join(f"| {' | '.join(row)} |" for row in rows)
    known = machine()
    packages = [f"{name} {known[name]}" for name in ("Python", "numpy", "scipy", "tyrefrf")]
    here = ", ".join([known["processor"], *packages, f"{datetime.now(UTC):%Y-%m-%d}"])
    head = HEAD.format(kernel=kernel, machine=here, lines=", ".join(f"{f:g}" for f in LINES))
    (HERE / "digits.md").write_text(f"{head}\n{table}\n", encoding="utf-8")
    print(HERE / "digits.md")


def answers(file: Path, setting: dict[str, str]) -> tuple[dict[str, np.ndarray], str]:
    """Displacements (f, n_cells, n_own, n_loads) by tyre and solver, and the kernel they are by."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("OPENBLAS")}
    command = [sys.executable, __file__, str(file)]
    subprocess.run(command, env=environment | setting, check=True)
    with np.load(file) as found:
        return {key: found[key] for key in found if key != "kernel"}, str(found["kernel"])


def answer_here(file: Path) -> None:
    """The same, by this process as it is."""
    from threadpoolctl import threadpool_info

    from tyrefrf.case import Solver, load_case
    from tyrefrf.solvers import prepare
    from tyrefrf.study.model import build_model

    found = {}
    for tyre, case in TYRES.items():
        problem = build_model(load_case(CASES / case)).problem
        for name in SOLVERS:
            library = {"library": "superlu"} if name == "direct" else {}
            solver = prepare(problem, Solver.model_validate({"name": name, **library}))()
            fields = [solver.field(2.0 * np.pi * f) for f in LINES]
            found[f"{tyre}/{name}"] = np.array([field.q for field in fields])
    (kernel,) = {pool["architecture"] for pool in threadpool_info() if "architecture" in pool}
    np.savez(file, kernel=kernel, **found)


def difference(q: np.ndarray, own: np.ndarray) -> float:
    """The largest ||q' - q|| / ||q|| of a section."""
    return float(np.max(np.linalg.norm(q - own, axis=2) / np.linalg.norm(own, axis=2)))


if __name__ == "__main__":
    if len(sys.argv) > 1:
        answer_here(Path(sys.argv[1]))
    else:
        main()
