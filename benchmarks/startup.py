"""What the command line takes before, and beside, the lines that it solves.

    python -m benchmarks.startup

Each is a process of its own, from the shell prompt to the next, all of them in turn. A run of one
line meshes, assembles, solves one line, writes the results and draws every plot.
"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.command import Outcome, command, run_case_file
from benchmarks.machine import description, interleaved, table
from benchmarks.tyres import tyres
from tyrefrf.case import Case, Frequency, Output

ROUNDS = 5
IMPORTS = "import numpy, scipy.sparse.linalg, h5py"


def measured(rounds: int = ROUNDS) -> str:
    """The table, in Markdown."""
    with TemporaryDirectory() as scratch:
        functions = _commands(Path(scratch))
        seconds = interleaved(functions, rounds, share=0.0)
    rows = [[name, f"{time:.2f}"] for name, time in seconds.items()]
    return f"Shortest of {rounds}.\n\n" + table(["command", "wall [s]"], rows)


def _commands(scratch: Path) -> dict[str, partial[Outcome]]:
    """What is started, by what a reader calls it."""
    python = partial(command, program=(sys.executable, "-c"))
    found: dict[str, partial[Outcome]] = {
        "`python -c pass`": partial(python, "pass"),
        f"`python -c '{IMPORTS}'`": partial(python, IMPORTS),
        "`tyrefrf --version`": partial(command, "--version"),
        "`tyrefrf --help`": partial(command, "--help"),
    }
    for name, case in tyres().items():
        file = scratch / f"{case.name}.toml"
        found[f"`tyrefrf check`, {name}"] = partial(command, "check", str(file))
        found[f"`tyrefrf run`, {name}, 1 line"] = partial(run_case_file, one_line(case), scratch)
        found[f"`tyrefrf run`, {name}, 1 line, no plots"] = partial(
            run_case_file, one_line(case, plots=False), scratch
        )
        run_case_file(one_line(case), scratch)  # writes the file, and warms the disk's cache
    return found


def one_line(case: Case, *, plots: bool = True) -> Case:
    """The case with one line, and with its plots or without any."""
    frequency = Frequency.model_validate({"values": [700.0]})
    output = case.output if plots else Output(plots=())
    return case.model_copy(update={"frequency": frequency, "output": output})


if __name__ == "__main__":
    print(description())
    print(measured())
