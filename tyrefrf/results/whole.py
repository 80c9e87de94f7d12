"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from glob import escape
from pathlib import Path
from uuid import uuid4

ABANDONED = 600.0
"""Seconds after which a temporary file is nobody's: no file here takes as long to be written."""


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a temporary name beside `path`; what is written there takes its place at the end.

    A killed process leaves at most the temporary file, which later ones remove; an exception
    removes it.
    """
    remove_leftovers(path, ABANDONED)
    temporary = path.with_name(f".{path.name}.{uuid4().hex}.tmp")
    try:
        yield temporary
        with temporary.open("rb+") as file:
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def remove_leftovers(path: Path, older_than: float = 0.0) -> None:
    """Remove the temporary files [s] that killed processes have left of `path`."""
    for leftover in path.parent.glob(f".{escape(path.name)}.*.tmp"):
        with suppress(OSError):  # someone else was faster
            if time.time() - leftover.stat().st_mtime >= older_than:
                leftover.unlink()
