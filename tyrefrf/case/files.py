"""The files that a case names, beside its own: where they are, and what is in them."""

from __future__ import annotations

import errno
import hashlib
import os
import re
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from tyrefrf.case.matrices import Matrices
from tyrefrf.case.model import Case
from tyrefrf.errors import CaseError, Key, Problem

INCLUDE = re.compile(rb"(?im)^\*include\s*,\s*input\s*=\s*\"?([^\s,\"]+)")
"""How an .inp names a file that it takes in."""

MAX_FILE_BYTES = 2_000_000_000
_AT_ONCE = 1 << 20


@dataclass(frozen=True, slots=True)
class NamedFile:
    """A file that a case names. key: where; path: as the case's directory completes it."""

    key: Key
    path: Path

    def content(self) -> bytes:
        """What is in the file. Raises CaseError, naming the key, where it cannot be read."""
        try:
            return read_bytes(self.path)
        except OSError as error:
            raise CaseError([Problem(self.key, unreadable(self.path, error))]) from None

    def digest(self) -> str:
        """SHA-256 of what is in the file. Raises CaseError as `content`."""
        found = hashlib.sha256()
        try:
            with opened(self.path) as file:
                while some := file.read(_AT_ONCE):
                    found.update(some)
        except OSError as error:
            raise CaseError([Problem(self.key, unreadable(self.path, error))]) from None
        return found.hexdigest()


def files_of(case: Case) -> tuple[NamedFile, ...]:
    """Every file that the case names, table by table, each before what it includes.

    Without that of [mesh] where a mesh in memory takes its place.
    Raises CaseError, naming the key, where one that may include others cannot be read.
    """
    named: list[NamedFile] = []
    if case.mesh is not None and case.held_mesh is None:
        named += _with_included(NamedFile(("mesh", "file"), case.directory / case.mesh.file))
    if case.matrices is not None:
        named += [
            NamedFile(("matrices", *key), case.directory / file)
            for key, file in _of_matrices(case.matrices).items()
        ]
    for i, measured in enumerate(case.measured):
        named.append(NamedFile(("measured", i, "file"), case.directory / measured.file))
    return tuple(named)


def file_digests(case: Case) -> list[tuple[str, str]]:
    """Place of the name, and SHA-256 of the content, of every file that the case names.

    A mesh in memory counts as the file that it is taken in place of, by a digest of its own.
    Raises CaseError with all that cannot be read.
    """
    held = case.held_mesh
    digests = [] if held is None else [("mesh.file", held.digest())]
    problems: list[Problem] = []
    for file in files_of(case):
        try:
            digests.append((Problem(file.key, "").place, file.digest()))
        except CaseError as error:
            problems += error.problems
    if problems:
        raise CaseError(problems)
    return digests


def read_bytes(path: Path, most: int = MAX_FILE_BYTES) -> bytes:
    """The content of a file. Raises OSError as `opened`."""
    with opened(path, most) as file:
        return file.read()


@contextmanager
def opened(path: Path, most: int = MAX_FILE_BYTES) -> Iterator[IO[bytes]]:
    """Open a file of at most so many bytes to be read.

    Raises OSError, also for what is no file name at all, for directories, and for devices and
    pipes, which may have no end, and for what is too large to be what a case names.
    """
    try:
        found = path.stat()
    except ValueError as error:  # a NUL in the path
        raise OSError(str(error)) from None
    if stat.S_ISDIR(found.st_mode):
        raise OSError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not stat.S_ISREG(found.st_mode):
        raise OSError("is a device or a pipe, and no file")
    if found.st_size > most:
        raise OSError(f"is larger than {most // 10**6} MB")
    with path.open("rb") as file:
        yield file


def unreadable(path: Path, error: OSError) -> str:
    """Why a file has no content, in words."""
    return f"{path} cannot be read: {error.strerror or error}"


def _with_included(file: NamedFile) -> list[NamedFile]:
    """A file, and those that an .inp takes in by *INCLUDE, at any depth."""
    found = {same_file(file.path): file}
    waiting = [file] if file.path.suffix.lower() == ".inp" else []
    for each in waiting:  # grows on the way
        for name in INCLUDE.findall(each.content()):
            path = each.path.parent / name.decode(errors="replace")
            if same_file(path) not in found:
                found[same_file(path)] = NamedFile(file.key, path)
                waiting.append(found[same_file(path)])
    return list(found.values())


def same_file(path: Path) -> str:
    """What two paths to one file have in common, however they wind there."""
    try:
        return os.path.realpath(path)
    except ValueError:  # a NUL in the path
        return str(path)


def _of_matrices(matrices: Matrices) -> dict[Key, str]:
    """Files by their keys within [matrices]."""
    found: dict[Key, str] = {("K", part, "file"): K.file for part, K in matrices.K.items()}
    others = ("M", "C", "K_G", "dofs", "nodes")
    found |= {(key,): file for key in others if (file := getattr(matrices, key))}
    if not matrices.has_named_sets:
        found |= {(key,): file for key, file in matrices.sets.items()}
    return found
