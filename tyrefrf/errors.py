"""What can go wrong, and who is told.

    TyreFRFError
    ├── CaseError          the case file or the command line is wrong      exit status 2
    ├── CommandError       a command line that cannot be carried out       exit status 2
    ├── MeshError          a section or cell that cannot be meshed         exit status 2
    ├── SolveError         a line without a trustworthy answer             exit status 1
    │   └── SingularError  a matrix that is singular to working precision
    └── ResultsError       a results file that cannot be read or written   exit status 1

The core raises; only the command line prints and exits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

Key = tuple[str | int, ...]
"""A place in a case, as pydantic's `loc`: ("probes", 3, "s")."""

LONGEST_KEY = 100  # letters that a message shows of a key


class TyreFRFError(Exception):
    """Anything that tyrefrf itself reports."""


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing wrong with a case: where, and in words what, why and what to try.

    `line` is 1-based; 0 where the place in the file is not known (yet). `at`: the key whose line
    it is to be, where that is another, as for a point of a sweep.
    """

    key: Key
    message: str
    line: int = 0
    at: Key = ()

    @property
    def place(self) -> str:
        """The key as an engineer writes it: `probes[3].s`."""
        return _joined(self.key)

    @property
    def words(self) -> str:
        """The same for a message: what would break it is escaped, what is long cut."""
        return _joined([_one_line(part) if isinstance(part, str) else part for part in self.key])


def _joined(key: Sequence[str | int]) -> str:
    text = ""
    for part in key:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def _one_line(part: str) -> str:
    """A key without what would break a message or a terminal."""
    part = part if len(part) <= LONGEST_KEY else f"{part[:LONGEST_KEY]}..."
    return part if part and part == part.strip() and part.isprintable() else repr(part)


class CaseError(TyreFRFError):
    """A case that cannot be computed: every problem of it, one message each."""

    def __init__(self, problems: Sequence[Problem], file: str = "") -> None:
        self.problems = tuple(problems)
        self.file = file
        super().__init__(str(self))

    def __str__(self) -> str:
        return "\n".join(self._describe(problem) for problem in self.problems)

    def _describe(self, problem: Problem) -> str:
        where = f"{self.file or 'case'}:{problem.line}" if problem.line else self.file or "case"
        message = "".join(c if c.isprintable() else repr(c)[1:-1] for c in problem.message)
        return ": ".join(part for part in (where, problem.words, message) if part)


class CommandError(TyreFRFError):
    """A command line that cannot be carried out."""


class MeshError(TyreFRFError):
    """A section or cell that cannot be meshed with the sizes given."""


class SolveError(TyreFRFError):
    """A frequency line that has no trustworthy answer."""


class SingularError(SolveError):
    """A matrix that is singular to working precision: an undamped resonance, or a mechanism."""


def short_of_memory(error: MemoryError) -> str:
    """What to say where memory ran out, and what would take less of it."""
    what = f": {error}" if str(error) else ""
    return (
        f"memory ran out{what}; fewer --jobs, frequency lines, loads or probes, or a coarser mesh "
        "take less (`tyrefrf check` says how much a case needs)"
    )


class ResultsError(TyreFRFError):
    """A results file that cannot be read or written."""
