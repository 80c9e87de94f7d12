"""A line's answer and where it belongs: what passes between processes, and what a journal keeps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tyrefrf.solvers.problem import Line


@dataclass(frozen=True, slots=True, eq=False)
class TimedLine:
    """One line's answer, where it belongs, and what it took.

    number: of the problem, where several are solved together. index: of the line in its problem.
    seconds: [s].
    """

    number: int
    index: int
    line: Line
    seconds: float

    @property
    def place(self) -> tuple[int, int]:
        """Problem and line: what no two lines have in common."""
        return self.number, self.index

    @property
    def has_answer(self) -> bool:
        """False for a line that failed."""
        return not np.isnan(self.line.receptance).any()
