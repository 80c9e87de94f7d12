"""How much memory a study takes, estimated before it is taken, and refused where it is not there.

The estimates are sums of what is largest: the bricks of a cell while they are assembled, what a
solver holds on a line, and the responses with all that is derived from them. Their factors were
measured on peaks of the resident size; tests hold them against such peaks.
"""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefrf.case.files import MAX_FILE_BYTES
from tyrefrf.errors import SolveError
from tyrefrf.limits import resident_now, room_of_process
from tyrefrf.solvers import RingProblem
from tyrefrf.solvers.footprint import COMPLEX, line_memory, modes_memory, waves_memory
from tyrefrf.solvers.memory import available_memory

if TYPE_CHECKING:
    from tyrefrf.case import Case, Solver

MAIN = 165e6
"""Bytes of the main process with all that it imports, plots included."""
WORKER = 60e6
"""Of a worker, what it shares with the others counted once."""
PER_BRICK = {"hex8i": 62e3, "hex8": 62e3, "hex20": 370e3, "hex20r": 260e3}
"""Of a brick while its cell is assembled: strains at Gauss points, matrices, and their places."""
INFLATED = 1.5
"""As much, where the cell is inflated."""
PER_ENTRY = 55.0
"""Of an entry of the cell's pattern that is held: its matrices, and what made them."""
PER_BYTE = {".inp": 25.0, ".npz": 4.0, ".mtx": 3.0, ".sti": 4.0, ".mas": 4.0}
"""Of a byte of a file while it is read; of other files"""
PER_BYTE_ELSE = 15.0
PER_NODE = 2e3
"""Of a node of the ring whose motion is written, with its part of the bricks."""
PER_PLACE = 5e3
"""Of a load or a probe: its place and its column."""
HELD, AT_WORK, BY_LOADS = 1.0, 4.0, 2.0
"""Copies of the responses at once: what is held; what is derived of it, written or exported; and
what is derived of every two loads."""


@dataclass(frozen=True, slots=True)
class Part:
    """Something that takes memory [bytes], and how it could take less."""

    name: str
    size: float
    advice: str


@dataclass(frozen=True, slots=True)
class Need:
    """The memory of a study at its peak.

    main: parts that the main process holds, beside itself. worker: parts that each of the `jobs`
    workers of this machine holds; without workers the main process does their work.
    """

    main: tuple[Part, ...]
    worker: tuple[Part, ...] = ()
    jobs: int = 0

    @property
    def of_main(self) -> float:
        """Bytes of the main process."""
        return MAIN + sum(part.size for part in self.main)

    @property
    def of_worker(self) -> float:
        """Bytes of every other process."""
        return WORKER + sum(part.size for part in self.worker) if self.jobs else 0.0

    @property
    def total(self) -> float:
        """Bytes of all processes."""
        return self.of_main + self.jobs * self.of_worker

    @property
    def largest(self) -> Part:
        """What takes the most, in all processes together."""
        of_workers = (Part(p.name, self.jobs * p.size, p.advice) for p in self.worker)
        return max((*self.main, *of_workers), key=lambda part: part.size)


def check_fits(need: Need) -> None:
    """Raises SolveError where a study needs more memory than there is, with both numbers.

    What counts as there: what the machine, or the control group, can still give, and what this
    process may take by its own limits.
    """
    here = resident_now()
    room = room_of_process()
    available = available_memory()
    if available is not None and need.total > available + here:
        raise SolveError(_refusal(need, need.total, available + here, "are available"))
    of_one = max(need.of_main - here, need.of_worker)
    if of_one > room:
        words = "are left by the limit on a process (ulimit -v)"
        raise SolveError(_refusal(need, max(need.of_main, need.of_worker), room + here, words))


def _refusal(need: Need, needed: float, there: float, words: str) -> str:
    """What is needed, what is there, and what takes less."""
    each = f" ({_gigabytes(need.of_worker)} for each of {need.jobs} jobs)" if need.jobs > 1 else ""
    fits = int((there - need.of_main) // need.of_worker) if need.jobs else 0
    fewer = f"--jobs {fits} would fit; " if 0 < fits < need.jobs else ""
    largest = need.largest
    return (
        f"needs {_gigabytes(needed)} of memory{each}, and {_gigabytes(there)} {words}: {fewer}"
        f"the most is {largest.name}, {_gigabytes(largest.size)}: {largest.advice}"
    )


def _gigabytes(size: float) -> str:
    return f"{size / 1e9:.3g} GB"


def need_of_files(paths: Sequence[Path]) -> Need:
    """Of reading the files that a case names."""
    size = sum(_size(path) * PER_BYTE.get(path.suffix.lower(), PER_BYTE_ELSE) for path in paths)
    return Need((Part("reading the case's files", size, "bring smaller ones"),))


def _size(path: Path) -> float:
    """Bytes of what a file holds, unpacked where it says so; 0 where it is not to be had."""
    with suppress(OSError, ValueError, zipfile.BadZipFile):
        if path.suffix.lower() == ".npz":
            with zipfile.ZipFile(path) as packed:
                return float(sum(member.file_size for member in packed.infolist()))
        size = float(path.stat().st_size)
        return size if size <= MAX_FILE_BYTES else 0.0  # it is refused for that
    return 0.0


def need_of_cell(case: Case, n_bricks: int) -> Need:
    """Of meshing and assembling one cell of so many bricks."""
    size = n_bricks * PER_BRICK[case.cell.element]
    if case.inflation.pressure:
        size *= INFLATED
    return Need((Part("the matrices of a cell", size, "mesh more coarsely"),))


def need_of_run(case: Case, problems: Sequence[RingProblem], jobs: int) -> Need:
    """Of solving the problems of a run or a sweep by the case's solver, and keeping the responses.

    jobs: processes of this machine that solve; 1: the main process does, 0: none.
    """
    problem, n = problems[0], len(problems)
    solver = _solver_part(problem, case.solver)
    main = (_cells(problems), *_responses(case, problem, n))
    if jobs > 1:
        return Need(main, (solver,), jobs)
    return Need((*main, solver) if jobs else main)


def need_of_comparison(case: Case, problem: RingProblem, solvers: Sequence[Solver]) -> Need:
    """Of solvers one after another, each in a process of its own."""
    parts = [_solver_part(problem, solver) for solver in solvers]
    worker = (_cells([problem]), max(parts, key=lambda part: part.size))
    return Need((_cells([problem]), *_responses(case, problem, len(solvers))), worker, 1)


def need_of_modes(problem: RingProblem, n_modes: int) -> Need:
    """Of finding so many natural modes, and keeping their shapes."""
    n_modes = min(n_modes, problem.n_ring_dofs)
    shapes = 4.0 * COMPLEX * problem.cell.n_own * n_modes / 2.0
    solved = modes_memory(problem, n_modes)
    advice = "ask for fewer modes, or mesh more coarsely"
    return Need((_cells([problem]), Part("the modes", solved + shapes, advice)))


def need_of_deflections(case: Case, problem: RingProblem) -> Need:
    """Of the fields of all loads on one line, written for other programs."""
    nodes = problem.n_ring_dofs / 3.0
    size = PER_NODE * nodes + 3.0 * COMPLEX * problem.n_loads * problem.n_ring_dofs
    fields = Part("the fields of the whole tyre", size, "take fewer loads, or mesh more coarsely")
    return Need((_cells([problem]), _solver_part(problem, case.solver), fields))


def need_of_waves(problem: RingProblem, jobs: int) -> Need:
    """Of finding the free waves of a cell."""
    part = Part("the free waves", waves_memory(problem), "mesh more coarsely")
    cells = _cells([problem])
    return Need((cells,), (part,), jobs) if jobs > 1 else Need((cells, part) if jobs else (cells,))


def _solver_part(problem: RingProblem, solver: Solver) -> Part:
    advice = "take fewer loads, or mesh more coarsely"
    if solver.name == "direct":
        advice = "'cyclic' and 'recursive' give the same answer in a fraction of it"
    elif solver.name == "recursive":
        advice = "'cyclic' takes less; or take fewer loads, or mesh more coarsely"
    return Part(f"the solver '{solver.name}'", line_memory(problem, solver), advice)


def _cells(problems: Sequence[RingProblem]) -> Part:
    """The matrices of all points, and the columns of their loads and probes."""
    size = sum(
        PER_ENTRY * len(problem.cell.indices)
        + 8.0 * len(problem.cell.K) * len(problem.cell.indices)
        + PER_PLACE * sum(problem.shape)
        for problem in problems
    )
    return Part("the matrices of the cells", size, "mesh more coarsely, or take fewer points")


def _responses(case: Case, problem: RingProblem, n_points: int) -> tuple[Part, ...]:
    """What is kept of the lines of all points, and what is made of it at once."""
    n_lines = len(case.frequency.lines())
    n_probes, n_loads = problem.shape
    one = COMPLEX * n_lines * n_loads * n_probes
    of_loads = COMPLEX * n_lines * n_loads**2
    size = n_points * ((HELD + AT_WORK) * one + BY_LOADS * of_loads)
    advice = "take fewer frequency lines, loads or probes"
    return (Part("the responses", size, advice),)
