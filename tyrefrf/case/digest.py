"""Files that a case names: where they are, and what is in them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefrf.errors import CaseError, Key, Problem

if TYPE_CHECKING:
    from tyrefrf.case.model import Case


def named_files(case: Case) -> Iterator[tuple[Key, str]]:
    """Every file that the case names, as it is written there, with the place of its name."""
    for i, measured in enumerate(case.measured):
        yield ("measured", i, "file"), measured.file


def file_digests(case: Case) -> dict[str, str]:
    """SHA-256 of the content of every file that the case names, by the name as it is written.

    Raises CaseError with all that cannot be read.
    """
    digests, problems = {}, []
    for key, name in named_files(case):
        try:
            digests[name] = hashlib.sha256(read_bytes(case.directory / name)).hexdigest()
        except OSError as error:
            problems.append(Problem(key, unreadable(case.directory / name, error)))
    if problems:
        raise CaseError(problems)
    return digests


def read_bytes(path: Path) -> bytes:
    """The content of a file. Raises OSError, also for what is no file name at all."""
    try:
        return path.read_bytes()
    except ValueError as error:  # a NUL in the path
        raise OSError(str(error)) from None


def unreadable(path: Path, error: OSError) -> str:
    """Why a file has no content, in words."""
    return f"{path} cannot be read: {error.strerror or error}"
