"""Lines of Markdown: tables, and text that is no markup."""

from __future__ import annotations

from collections.abc import Sequence

Lines = list[str]


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> Lines:
    """A table."""
    lines = [head, ["---"] * len(head), *rows]
    return ["| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines]


def plain(text: str) -> str:
    """Text whose signs are no markup, but for `code`."""
    return text.replace("*", "\\*").replace("<", "\\<").replace("$", "\\$")
