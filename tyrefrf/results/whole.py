"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from hashlib import blake2b
from pathlib import Path
from uuid import uuid4

from tyrefrf.errors import ResultsError

ABANDONED = 600.0
"""Seconds after which a temporary file is nobody's: no file here takes as long to be written."""


@contextmanager
def whole_file(path: Path, *, make_directory: bool = False) -> Iterator[Path]:
    """Give a temporary name beside `path`; what is written there takes its place at the end.

    A killed process leaves at most the temporary file, which later ones remove; an exception
    removes it. Raises ResultsError, naming `path`, where it cannot be written.
    """
    temporary = path.with_name(f"{_begin_of(path)}{uuid4().hex}.tmp")
    try:
        if make_directory:
            path.parent.mkdir(parents=True, exist_ok=True)
        remove_leftovers(path, ABANDONED)
        yield temporary
        with temporary.open("rb+") as file:
            os.fsync(file.fileno())
        temporary.replace(path)
        _synchronise_directory(path.parent)
    except OSError as error:
        raise unwritable(path, error) from error
    finally:
        with suppress(OSError):  # the directory may be gone, or was none
            temporary.unlink(missing_ok=True)


def _synchronise_directory(directory: Path) -> None:
    """Have the new name outlive a power cut, where the system can say so of directories."""
    with suppress(OSError):
        number = os.open(directory, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)


def unwritable(path: Path, error: OSError) -> ResultsError:
    """Why there is no such file, in words."""
    return ResultsError(f"{path}: cannot be written: {error.strerror or error}")


def remove_leftovers(path: Path, older_than: float = 0.0) -> None:
    """Remove the temporary files [s] that killed processes have left of `path`."""
    for leftover in path.parent.glob(f"{_begin_of(path)}*.tmp"):
        with suppress(OSError):  # someone else was faster
            if time.time() - leftover.stat().st_mtime >= older_than:
                leftover.unlink()


def _begin_of(path: Path) -> str:
    """How the temporary files of `path` are called: of any name, within what file systems allow."""
    return f".{blake2b(path.name.encode(), digest_size=8).hexdigest()}-"
