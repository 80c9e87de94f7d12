"""The pages of the documentation as their reader takes them: block after block, in a directory.

A fenced block is told by its language:

- `toml` that begins with a comment of a file's name, `# tyre.toml`, is that file, and a case; other
  `toml` is added to the page's case `tyre.toml`: its tables are merged, entries of lists appended;
- `python` is run, all blocks of a page with the same names;
- `sh` is run line by line: `tyrefrf ...`, or `pip install` of an extra that there is;
- `text` that begins with a comment of a file's name is that file; right behind `sh` it is what is
  printed: its lines are found there, numbers to two per cent, where "..." stands for any; other
  text is only shown, and no command.

A comment before a block, `<!-- not executed: why -->`, lets it be shown only, and `<!-- executed by
tests/...: how -->` leaves it to another test; `<!-- exits 2 -->` before `sh` has it end with that
status, `<!-- refused -->` before `toml` says that the case is wrong. Every page begins with the
case of the quickstart.
"""

from __future__ import annotations

import io
import math
import re
import shlex
import sys
import tomllib
from collections.abc import Iterator
from contextlib import nullcontext, redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from tyrefrf.case import load_case
from tyrefrf.cli.main import main
from tyrefrf.errors import CaseError

DOCS = Path(__file__).parents[1] / "docs"
QUICKSTART = DOCS / "quickstart.md"
README = DOCS.parent / "README.md"
LANGUAGES = ("toml", "python", "sh", "text")
FENCE = re.compile(
    r"(?:<!-- (?P<remark>[^\n]+?) -->\n\n?)?"
    r"^```(?P<language>[^\n]*)\n(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
FILE_NAME = re.compile(r"# (?P<name>[\w./-]+\.(?:toml|csv|inp|txt))(?:\n|$)")
COMMAND = re.compile(r"^(?:\$ )?(?:tyrefrf|pip|python|dask) ", re.MULTILINE)
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]\d+)?")
ROUNDING = 1e-9
DIRECTIVE = re.compile(r"\{[\w-]+\}")
NOT_HERE = re.compile(r"not executed: .+|executed by (?P<test>tests/[\w/]+\.py): .+")
"""A remark that leaves a block to nobody, or to a test of its own."""


@dataclass(frozen=True)
class Block:
    """A fenced block, the remark before it, and the line of the page where it begins.

    is_printed: whether it stands right behind a block of shell.
    """

    language: str
    text: str
    remark: str
    line: int
    is_printed: bool

    @property
    def file(self) -> str:
        """The name of the file that the block is, or nothing."""
        name = FILE_NAME.match(self.text)
        return name["name"] if name else ""

    @property
    def is_left_out(self) -> bool:
        """Whether the page says that nobody executes it, or that another test does."""
        return NOT_HERE.fullmatch(self.remark) is not None


def pages() -> list[Path]:
    """Every page that somebody wrote: those of the gallery are scripts, which the site runs."""
    return sorted(path for path in DOCS.rglob("*.md") if "gallery" not in path.parts)


def blocks(page: Path) -> list[Block]:
    """The fenced blocks of a page but those that are Sphinx's own."""
    text = page.read_text(encoding="utf-8")
    found: list[Block] = []
    end_of_shell = 0
    for m in FENCE.finditer(text):
        between = text[end_of_shell : m.start()]
        line = text.count("\n", 0, m.start("language")) + 1
        printed = bool(end_of_shell) and not between.strip()
        found.append(Block(m["language"], m["text"], m["remark"] or "", line, printed))
        end_of_shell = m.end() if m["language"] == "sh" else 0
    return [block for block in found if not DIRECTIVE.match(block.language)]


def first_case() -> Block:
    """The case with which the quickstart begins, and every other page."""
    return next(block for block in blocks(QUICKSTART) if block.file == "tyre.toml")


@dataclass
class Follower:
    """Somebody who does what a page says, in a directory of his own.

    names: of the page's Python. said: what the last commands printed.
    """

    directory: Path
    names: dict[str, Any] = field(default_factory=dict)
    said: str = ""

    def follow(self, block: Block, where: str) -> None:
        """Do what a block says; where: for messages."""
        if block.is_left_out:
            return
        if block.file:
            self._write(block)
        elif block.language == "toml":
            self._add(block)
        elif block.language == "python":
            exec(compile("\n" * block.line + block.text, where, "exec"), self.names)
        elif block.language == "sh":
            expected = int(block.remark.removeprefix("exits ")) if block.remark else 0
            self.said = "".join(self._run(line, expected, where) for line in commands(block.text))
        else:
            self._compare(block, where)

    def _write(self, block: Block) -> None:
        path = self.directory / block.file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(block.text, encoding="utf-8")
        if path.suffix == ".toml":
            with pytest.raises(CaseError) if block.remark == "refused" else nullcontext():
                load_case(path)

    def _add(self, block: Block) -> None:
        path = self.directory / "tyre.toml"
        whole = merged(tomllib.loads(path.read_text()), tomllib.loads(block.text))
        path.write_text(tomli_w.dumps(whole), encoding="utf-8")
        load_case(path)

    def _run(self, line: str, expected: int, where: str) -> str:
        arguments = shlex.split(line)
        if arguments[:2] == ["pip", "install"]:
            assert set(arguments[2:]) <= installable(), f"{where}: {line}"
            return ""
        assert arguments[0] == "tyrefrf", f"{where}: {line}: who runs this?"
        target = None
        if ">" in arguments:
            *arguments, _, target = arguments
        status, said, told = called(arguments[1:])
        assert status == expected, f"{where}: {line}: exit status {status}\n{told}{said}"
        if target:
            (self.directory / target).write_text(said)
        return told + said

    def _compare(self, block: Block, where: str) -> None:
        if not block.is_printed:
            assert not COMMAND.search(block.text), f"{where}: a command that nobody runs"
            return
        printed = self.said.splitlines()
        for line in block.text.splitlines():
            known = line.strip() in ("", "...") or any(is_alike(line, one) for one in printed)
            assert known, f"{where}: {line!r} is not printed; there is\n{self.said}"


def commands(text: str) -> Iterator[str]:
    """The commands of a block of shell, lines that a backslash continues joined."""
    for line in text.replace("\\\n", " ").splitlines():
        command = re.sub(r"(^|\s+)# .*$", "", line).strip()
        if command:
            yield command


def called(arguments: list[str]) -> tuple[int, str, str]:
    """`tyrefrf` in this process: its status, stdout and stderr."""
    out, told, before = io.StringIO(), io.StringIO(), sys.argv
    sys.argv = ["tyrefrf", *arguments]
    try:
        with redirect_stdout(out), redirect_stderr(told):
            main()
        status = 0
    except SystemExit as ended:
        status = int(ended.code or 0)
    finally:
        sys.argv = before
    return status, out.getvalue(), told.getvalue()


def merged(whole: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
    """A case with more tables: merged, entries of lists of tables appended."""
    result = dict(whole)
    for key, value in more.items():
        old = result.get(key)
        if isinstance(value, dict) and isinstance(old, dict):
            result[key] = merged(old, value)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            result[key] = [*(old or []), *value]
        else:
            result[key] = value
    return result


def is_alike(shown: str, printed: str) -> bool:
    """Whether two lines say the same: words, and numbers to 2 %; what is rounding may differ."""
    (words, numbers), (same, others) = _parts(shown), _parts(printed)
    return words == same and all(
        math.isclose(a, b, rel_tol=0.02) or max(abs(a), abs(b)) < ROUNDING
        for a, b in zip(numbers, others, strict=True)
    )


def _parts(line: str) -> tuple[str, list[float]]:
    """A line's words, whatever the width of its columns, and its numbers."""
    text = " ".join(re.sub(r"-{3,}", "---", line).split())
    return NUMBER.sub("0", text), [float(number) for number in NUMBER.findall(text)]


def installable() -> set[str]:
    """What `pip install` may be told to install: the program, with each of its extras."""
    project = tomllib.loads((DOCS.parent / "pyproject.toml").read_text(encoding="utf-8"))
    extras = project["project"]["optional-dependencies"]
    return {".", *(f"tyrefrf[{extra}]" for extra in extras)}
