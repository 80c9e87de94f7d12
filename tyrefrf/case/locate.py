"""Where in a TOML file a key stands. No maintained parser says, so one pass over the text does.

The text has been accepted by tomllib, so the scan only has to tell keys, strings, brackets and
commas apart. It is linear in the text and runs only to report an error.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from tyrefrf.errors import CaseError, Key, Problem

_PART = r"""(?:[A-Za-z0-9_-]+|"(?:\\.|[^"\\\n])*"|'[^'\n]*')"""
_PATH = rf"{_PART}(?:[ \t]*\.[ \t]*{_PART})*"
_HEADER = re.compile(rf"(\[\[?)[ \t]*({_PATH})[ \t]*\]\]?")
_TOKEN = re.compile(
    rf"""
      (?P<blank>   (?:\s|\#[^\n]*)+ )
    | (?P<key>     {_PATH}[ \t]*= )
    | (?P<value>   \"\"\"(?:\\.|[^\\])*?\"\"\"(?!") | '''.*?'''(?!')
                 | "(?:\\.|[^"\\])*" | '[^']*' | [^\s,\[\]{{}}\#]+ )
    | (?P<open>    [\[{{] )
    | (?P<close>   [\]}}] )
    | (?P<comma>   , )
    """,
    re.DOTALL | re.VERBOSE,
)


def with_lines(error: CaseError, text: str, file: str) -> CaseError:
    """Return the error with the lines of its problems in the case's text, in their order."""
    lines = key_lines(text)
    problems = [
        replace(problem, line=problem.line or line_of(lines, problem.at or problem.key))
        for problem in error.problems
    ]
    return CaseError(sorted(problems, key=lambda problem: problem.line), file)


def in_sweep(error: CaseError, text: str, file: str) -> CaseError:
    """The error of a sweep with the lines of what is wrong in the case, or at some of its points.

    What is wrong on the command line, as a parameter's name, stands in no line.
    """
    lines = key_lines(text)

    def placed(problem: Problem) -> Problem:
        key = problem.at or (problem.key if problem.key[:1] in lines and problem.key else ())
        return replace(problem, line=line_of(lines, key)) if key else problem

    return CaseError([placed(problem) for problem in error.problems], file)


def line_of(lines: Mapping[Key, int], key: Key) -> int:
    """Return the line of a key, or of the innermost table around it that the file has."""
    return next(lines[key[:n]] for n in range(len(key), -1, -1) if key[:n] in lines)


def key_lines(text: str) -> dict[Key, int]:
    """Return the line (from 1) of every key, header and array element of a valid TOML text."""
    scan, pos, line = _Scan(), 0, 1
    while pos < len(text):
        header = _HEADER.match(text, pos) if scan.at_statement else None
        if header:
            scan.header(header[2], header[1] == "[[", line)
        token = header or _TOKEN.match(text, pos)
        if token is None:
            break  # not TOML: what was found so far
        if not header:
            scan.token(str(token.lastgroup), token[0], line)
        line += text.count("\n", pos, token.end())
        pos = token.end()
    return scan.lines


@dataclass(slots=True)
class _Inline:
    """An inline table or array that is open; `index` counts an array's elements."""

    path: Key
    index: int | None

    @property
    def element(self) -> Key:
        return self.path if self.index is None else (*self.path, self.index)


@dataclass(slots=True)
class _Scan:
    """The place that the scan has reached: the table, the key, the open brackets."""

    lines: dict[Key, int] = field(default_factory=lambda: {(): 1})
    table: Key = ()
    last: dict[Key, int] = field(default_factory=dict)  # of each [[array]], its last index
    key: Key | None = None  # a key that waits for its value
    inline: list[_Inline] = field(default_factory=list)

    @property
    def at_statement(self) -> bool:
        return self.key is None and not self.inline

    def header(self, written: str, is_array: bool, line: int) -> None:
        self.table = ()
        parts = _parts(written)
        for n, part in enumerate(parts, start=1):
            self._enter(part, line)
            if is_array and n == len(parts):
                self.last[self.table] = self.last.get(self.table, -1) + 1
            if self.table in self.last:
                self._enter(self.last[self.table], line)

    def _enter(self, part: str | int, line: int) -> None:
        self.table = (*self.table, part)
        self.lines.setdefault(self.table, line)

    def token(self, kind: str, written: str, line: int) -> None:
        if kind == "key":
            self._key(_parts(written[:-1]), line)
        elif kind in ("value", "open"):
            path = self.key if self.key is not None else self._element()
            self.lines.setdefault(path, line)
            self.key = None
            if kind == "open":
                self.inline.append(_Inline(path, 0 if written == "[" else None))
        elif kind == "close" and self.inline:
            self.inline.pop()
        elif kind == "comma" and self.inline and self.inline[-1].index is not None:
            self.inline[-1].index += 1

    def _element(self) -> Key:
        return self.inline[-1].element if self.inline else self.table

    def _key(self, parts: Key, line: int) -> None:
        base = self._element()
        for n in range(1, len(parts) + 1):
            self.lines.setdefault(base + parts[:n], line)
        self.key = base + parts


def _parts(written: str) -> Key:
    """Return the parts of a dotted key, unquoted: tomllib knows how."""
    parts: list[str | int] = []
    here = tomllib.loads(f"{written} = 0")
    while isinstance(here, dict):
        [(part, here)] = here.items()
        parts.append(part)
    return tuple(parts)
