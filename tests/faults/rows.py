"""One row of the table of faults: what was done, how often, what was lost, what the user saw."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Row:
    """part: of the table. lost: in words; "nothing" where nothing was."""

    part: str
    fault: str
    times: int
    lost: str
    seen: str


NOTHING = "nothing"


def lost_of(losses: list[str]) -> str:
    """Every loss once, with how often it came; "nothing" without any."""
    texts = [f"{text} ({losses.count(text)} times)" for text in dict.fromkeys(losses)]
    return "; ".join(texts) or NOTHING
