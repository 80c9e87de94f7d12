"""From a file, a text or plain data to a `Case`; every problem of it in one `CaseError`."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from itertools import chain, islice
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from tyrefrf.case.bounds import size_faults
from tyrefrf.case.cross import cross_faults
from tyrefrf.case.locate import with_lines
from tyrefrf.case.messages import problems_of
from tyrefrf.case.model import Case
from tyrefrf.case.parameters import sweep_faults
from tyrefrf.errors import CaseError, Problem

MAX_BYTES = 10_000_000
MAX_SIGNS = {"=": 200_000, "[": 100_000, ",": 1_200_000}
"""How many keys, tables and values a case may have: twice what the largest can use. A text with
more of them would keep the parser busy for minutes, and only then be refused."""
MAX_PARTS = 50
MAX_PROBLEMS = 100

_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
_LONG_KEY = re.compile(rf"(?<![\w-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{MAX_PARTS}}}")
"""A dotted key of too many parts; the parser's time grows with their square."""


def load_case(path: str | Path) -> Case:
    """Read a case file; its name is the case's, unless it gives another."""
    path = Path(path)
    case = parse_case(read_text(path), str(path), path.stem)
    return case.beside(path.parent)


def read_text(path: Path) -> str:
    """Return the text of a case file, or raise CaseError where there is none."""
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        reason = getattr(error, "strerror", None) or error
        raise CaseError([Problem((), f"cannot be read: {reason}")], str(path)) from None
    if len(data) > MAX_BYTES:
        message = f"is larger than {MAX_BYTES // 1_000_000} MB; not a case file"
        raise CaseError([Problem((), message)], str(path))
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        message = f"is not UTF-8 text: byte 0x{data[error.start]:02x}"
        raise CaseError([Problem((), message, line)], str(path)) from None


def parse_case(text: str, file: str, name: str) -> Case:
    """Return the case of a TOML text; `file` is for messages, `name` the default name."""
    data = _parse_toml(text, file)
    try:
        return build_case(data, name)
    except CaseError as error:
        raise with_lines(error, text, file) from None


def build_case(data: Mapping[str, Any], name: str) -> Case:
    """Return the case of plain data, as tomllib reads it; the problems have no lines."""
    named = {"name": name, **data}
    try:
        case = Case.model_validate(named)
    except ValidationError as error:
        between = (Problem(fault.key, fault.message) for fault in cross_faults(named))
        raise CaseError(_not_too_many(chain(problems_of(error), between))) from None
    faults = chain(size_faults(case), sweep_faults(case))
    found = _not_too_many(Problem(fault.key, fault.message) for fault in faults)
    if found:
        raise CaseError(found)
    return case


def _not_too_many(problems: Iterator[Problem]) -> list[Problem]:
    """The problems, or the first hundred: a file that is no case may have a million."""
    found = list(islice(problems, MAX_PROBLEMS + 1))
    if len(found) <= MAX_PROBLEMS:
        return found
    return [*found[:-1], Problem((), f"more problems than these {MAX_PROBLEMS}; is this a case?")]


def _parse_toml(text: str, file: str) -> dict[str, Any]:
    _refuse_huge(text, file)
    try:
        return tomllib.loads(text)
    except RecursionError:
        problem = Problem((), "not valid TOML: nested too deeply", _deepest(text))
    except ValueError as error:  # TOMLDecodeError, or a number with too many digits
        problem = _syntax_problem(str(error), text)
    raise CaseError([problem], file)


def _refuse_huge(text: str, file: str) -> None:
    """Raise CaseError for a text that would take the parser long, and can be no case."""
    for sign, most in MAX_SIGNS.items():
        if text.count(sign) > most:
            line = 1 + _newlines_to(text, sign, most)
            message = f"has more than {most} '{sign}': too much for a case"
            raise CaseError([Problem((), message, line)], file)
    if long_key := _LONG_KEY.search(text):
        line = 1 + text.count("\n", 0, long_key.start())
        raise CaseError([Problem((), f"a key of more than {MAX_PARTS} parts", line)], file)


def _newlines_to(text: str, sign: str, number: int) -> int:
    """Newlines before the sign of that number, from 0."""
    found = islice(re.finditer(re.escape(sign), text), number, None)
    return text.count("\n", 0, next(found).start())


def _deepest(text: str) -> int:
    """The line, from 1, in which most brackets are open: of a text that is nested too deeply."""
    deepest = depth = at = 0
    for bracket in re.finditer(r"[\[{}\]]", text):
        depth += 1 if bracket[0] in "[{" else -1
        if depth > deepest:
            deepest, at = depth, bracket.start()
    return 1 + text.count("\n", 0, at)


def _syntax_problem(reason: str, text: str) -> Problem:
    """Take the line out of the parser's words: Python 3.11 has it nowhere else."""
    place = re.search(r" \(at (?:line (\d+), (column \d+)|end of document)\)$", reason)
    if place is None:
        return Problem((), f"not valid TOML: {reason}", _longest_number(text))
    words = reason[: place.start()]
    if place[1] is None:
        end = text.rstrip().count("\n") + 1
        return Problem((), f"not valid TOML: {words} (at the end of the file)", end)
    return Problem((), f"not valid TOML: {words} ({place[2]})", int(place[1]))


def _longest_number(text: str) -> int:
    """The line, from 1, of the longest number: what the parser refuses without saying where."""
    longest = max(re.finditer(r"[0-9_]+", text), key=lambda found: len(found[0]), default=None)
    return 1 + text.count("\n", 0, longest.start()) if longest else 1
