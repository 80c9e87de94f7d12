"""The docstrings of the program as numpydoc's sections, so that it renders their lists as lists.

In the program a docstring says line by line what its arguments or attributes are,

    frequency: (f,) [Hz]. loads, probes: l and p places.
    receptance: (l, p, f) displacement per force [m/N], NaN where a line failed.
    Raises ResultsError where the shapes do not agree.

Such lines become the sections Parameters and Raises before numpydoc sees them; prose stays prose,
and the docstring of a module stays as it is.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphinx.application import Sphinx

NAMES = r"(?!Sources?: )[A-Za-z_]\w*(?:, [A-Za-z_]\w*)*: "
NAMED = re.compile(rf"(?P<names>{NAMES})(?P<words>.+)")
RAISES = re.compile(r"Raises (?P<words>\w+Error.*)")


def in_sections(
    app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]
) -> None:
    """Rewrite the lines of a docstring where they stand."""
    if what == "module":
        lines[:] = _as_written("\n".join(lines))
        return
    prose: list[str] = []
    named: list[str] = []
    raised: list[str] = []
    for part in _parts("\n".join(lines)):
        if error := RAISES.fullmatch(part):
            raised += _raised(error["words"])
        elif item := NAMED.fullmatch(part):
            named += [item["names"].rstrip(": "), "    " + _plain(item["words"])]
        else:
            prose += [_plain(part), ""]
    lines[:] = [*prose, *_section("Parameters", named), *_section("Raises", raised)]


def without_constructor(
    app: Sphinx, what: str, name: str, thing: object, options: object, signature: str, returns: str
) -> tuple[str, str] | None:
    """Leave out how results are made, which nobody but the program does."""
    return ("", "") if what == "class" else None


def _parts(text: str) -> Iterator[str]:
    """Paragraphs, and within one that names something, each name with all that is said of it.

    After a named thing, prose begins with a line that begins with a capital letter.
    """
    for paragraph in text.split("\n\n"):
        lists = NAMED.match(paragraph) or "\nRaises " in paragraph
        for block in re.split(r"(?<=\.)\n(?=[A-Z])", paragraph) if lists else [paragraph]:
            yield from filter(None, re.split(rf"(?<=\.) (?={NAMES})", " ".join(block.split())))


def _as_written(text: str) -> list[str]:
    """A module's docstring: paragraphs and lists stay, what is indented is code or a drawing."""
    lines: list[str] = []
    for paragraph in text.split("\n\n"):
        if all(line.startswith("    ") for line in paragraph.splitlines()):
            lines += ["::", "", *paragraph.splitlines(), ""]
        else:
            lines += [*map(_plain, paragraph.splitlines()), ""]
    return lines


def _raised(words: str) -> list[str]:
    """One error with its reason, or several with the sentence that tells them apart."""
    errors = re.findall(r"\w+Error", words)
    reason = words if len(errors) > 1 else words.removeprefix(errors[0]).strip()
    return [", ".join(errors), "    " + _plain(reason)]


def _section(title: str, entries: list[str]) -> list[str]:
    return [title, "-" * len(title), *entries, ""] if entries else []


def _plain(text: str) -> str:
    """Text without signs that mean something to reStructuredText, `code` as code."""
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(
        f"`{part}`" if part.startswith("`") else re.sub(r"([*|\\]|(?<=\w)_(?!\w))", r"\\\1", part)
        for part in parts
    )


def setup(app: Sphinx) -> dict[str, Any]:
    """Make it known to Sphinx, before numpydoc."""
    app.connect("autodoc-process-docstring", in_sections, priority=100)
    app.connect("autodoc-process-signature", without_constructor)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
