"""Names of files from the names of what they hold."""

from __future__ import annotations

import re
from collections.abc import Iterable

LONGEST = 80  # characters of a load's name in a file name


def file_name(name: str) -> str:
    """A load's name without what a file system or a shell could misread."""
    return re.sub(r"[^\w.-]+", "_", name)[:LONGEST]


def file_names(names: Iterable[str]) -> list[str]:
    """The same for several at once: no two name the same file."""
    taken: set[str] = set()
    return [unique(file_name(name), taken) for name in names]


def unique(stem: str, taken: set[str]) -> str:
    """The stem, numbered where it is taken, also by one that differs in case only."""
    candidate, number = stem, 1
    while candidate.casefold() in taken:
        number += 1
        candidate = f"{stem}-{number}"
    taken.add(candidate.casefold())
    return candidate
