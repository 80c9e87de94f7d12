"""What a case's own rules find wrong, in plain words.

Rules raise one `refusal` holding every fault that they found; `messages` turns each into a
`Problem` of its own.
"""

from __future__ import annotations

import datetime
import difflib
from collections.abc import Iterable
from typing import NamedTuple

from pydantic_core import PydanticCustomError

from tyrefrf.errors import Key

_LONGEST_SHOWN = 40


class Fault(NamedTuple):
    """One broken rule: the place, from the table that is being read, and the message."""

    key: Key
    message: str


def refusal(*faults: Fault) -> PydanticCustomError:
    """Return the error by which a pydantic validator reports these faults."""
    text = "; ".join(fault.message for fault in faults)
    return PydanticCustomError("faults", "{text}", {"text": text, "faults": faults})


def shown(value: object) -> str:
    """Return a value as its author would recognise it, shortened.

    >>> shown("7 degg"), shown(True), shown(7.0), shown([1, 2])
    ("'7 degg'", 'true', '7.0', 'a list')
    """
    match value:
        case bool():
            return "true" if value else "false"
        case int() if value.bit_length() > 100:  # Python refuses to print really long ones
            return "a huge number"
        case str():
            return repr(value if len(value) <= _LONGEST_SHOWN else value[:_LONGEST_SHOWN] + "...")
        case dict():
            return "a table"
        case list() | tuple():
            return "a list"
        case datetime.date() | datetime.time():
            return f"the date or time {value}"
    return repr(value)


def number_text(value: float) -> str:
    """Return a number with ten digits at most: exact enough for a message or a case file."""
    return f"{value:.10g}"


def did_you_mean(word: str, choices: Iterable[str]) -> str:
    """Return "; did you mean 'eta'?", or nothing where no choice is close.

    >>> did_you_mean("etha", ["E", "nu", "eta"])
    "; did you mean 'eta'?"
    """
    by_lower = {choice.lower(): choice for choice in choices}
    close = difflib.get_close_matches(word[:_LONGEST_SHOWN].lower(), by_lower, n=1)
    return f"; did you mean '{by_lower[close[0]]}'?" if close else ""
