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


class TyreFRFError(Exception):
    """Anything that tyrefrf itself reports."""


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing wrong with a case: where, and in words what, why and what to try.

    `line` is 1-based; 0 where the place in the file is not known (yet).
    """

    key: Key
    message: str
    line: int = 0

    @property
    def place(self) -> str:
        """The key as an engineer writes it: `probes[3].s`."""
        text = ""
        for part in self.key:
            text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
        return text


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
        return ": ".join(part for part in (where, problem.place, problem.message) if part)


class CommandError(TyreFRFError):
    """A command line that cannot be carried out."""


class MeshError(TyreFRFError):
    """A section or cell that cannot be meshed with the sizes given."""


class SolveError(TyreFRFError):
    """A frequency line that has no trustworthy answer."""


class SingularError(SolveError):
    """A matrix that is singular to working precision: an undamped resonance, or a mechanism."""


class ResultsError(TyreFRFError):
    """A results file that cannot be read or written."""
