"""Time per line of every solver on a row of growing rings, as far as time and memory allow."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from benchmarks.machine import interleaved, ms
from benchmarks.tyres import ALONE, Line, libraries, library_line, line_of, section_dofs
from tyrefrf.errors import SolveError
from tyrefrf.solvers import RingProblem
from tyrefrf.solvers.memory import check_memory

COLUMNS = ("recursive", "cyclic", "plain", *ALONE)
MOST_SECONDS = 8.0
LEFT_OUT = (
    f"Times in brackets are not measured but expected at least, from the last that was and N n^2: "
    f"more than {MOST_SECONDS:g} s per line are left out. 'memory': more than the machine has."
)


@dataclass(frozen=True, slots=True)
class Seen:
    """What a line took [s], or is expected to, on a ring of this size."""

    seconds: float
    size: float
    measured: bool = True

    def on(self, size: float) -> Seen:
        """What is expected of another size."""
        return Seen(self.seconds * size / self.size, size, measured=False)

    @property
    def words(self) -> str:
        """In milliseconds, for a table; in brackets if nobody measured it."""
        return ms(self.seconds) if self.measured else f"({ms(self.seconds)})"


def grown(rings: Iterable[RingProblem]) -> list[dict[str, str]]:
    """What every solver takes on each of the rings, the smallest first: words by column."""
    seen: dict[str, Seen] = {}
    rows = []
    for problem in rings:
        size = size_of(problem)
        seen = {name: before.on(size) for name, before in seen.items()}
        tried = [name for name in _here() if name not in seen or seen[name].seconds < MOST_SECONDS]
        fitting = [name for name in tried if _fits(name, problem)]
        seconds = interleaved({name: _line(name, problem) for name in fitting}, rounds=2)
        seen |= {name: Seen(seconds[name], size) for name in fitting}
        row = dict.fromkeys(COLUMNS, "-") | {name: known.words for name, known in seen.items()}
        rows.append(row | {name: "memory" for name in tried if name not in fitting})
    return rows


def size_of(problem: RingProblem) -> float:
    """N n^2: a sparse factorisation of the whole ring grows with this or more."""
    return problem.n_cells * float(section_dofs(problem)) ** 2


def _here() -> list[str]:
    """Of the columns, what is installed."""
    return [name for name in COLUMNS if name not in ALONE or name in libraries()]


def _line(name: str, problem: RingProblem) -> Line:
    return (library_line if name in ALONE else line_of)(name, problem)


def _fits(name: str, problem: RingProblem) -> bool:
    """Whether the machine has the memory for it."""
    if name not in ALONE:
        return True
    try:
        check_memory(problem, name.lower(), jobs=1)
    except SolveError:
        return False
    return True
