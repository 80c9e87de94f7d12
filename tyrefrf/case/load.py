"""From a file, a text or plain data to a `Case`; every problem of it in one `CaseError`."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from tyrefrf.case.cross import cross_faults
from tyrefrf.case.locate import with_lines
from tyrefrf.case.messages import problems_of
from tyrefrf.case.model import Case
from tyrefrf.case.parameters import sweep_faults
from tyrefrf.errors import CaseError, Problem

MAX_BYTES = 10_000_000


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
        between = [Problem(fault.key, fault.message) for fault in cross_faults(named)]
        raise CaseError([*problems_of(error), *between]) from None
    swept = [Problem(fault.key, fault.message) for fault in sweep_faults(case)]
    if swept:
        raise CaseError(swept)
    return case


def _parse_toml(text: str, file: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except RecursionError:
        problem = Problem((), "not valid TOML: nested too deeply")
    except ValueError as error:  # TOMLDecodeError, or a number with too many digits
        problem = _syntax_problem(str(error), text)
    raise CaseError([problem], file)


def _syntax_problem(reason: str, text: str) -> Problem:
    """Take the line out of the parser's words: Python 3.11 has it nowhere else."""
    place = re.search(r" \(at (?:line (\d+), (column \d+)|end of document)\)$", reason)
    if place is None:
        return Problem((), f"not valid TOML: {reason}")
    words = reason[: place.start()]
    if place[1] is None:
        end = text.rstrip().count("\n") + 1
        return Problem((), f"not valid TOML: {words} (at the end of the file)", end)
    return Problem((), f"not valid TOML: {words} ({place[2]})", int(place[1]))
