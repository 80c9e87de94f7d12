"""The files that a case names, beside its own: where they are, and what is in them."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path

from tyrefrf.case.matrices import Matrices
from tyrefrf.case.model import Case
from tyrefrf.errors import CaseError, Key, Problem

INCLUDE = re.compile(rb"(?im)^\*include\s*,\s*input\s*=\s*\"?([^\s,\"]+)")
"""How an .inp names a file that it takes in."""


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
        return hashlib.sha256(self.content()).hexdigest()


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


def read_bytes(path: Path) -> bytes:
    """The content of a file. Raises OSError, also for what is no file name at all."""
    try:
        return path.read_bytes()
    except ValueError as error:  # a NUL in the path
        raise OSError(str(error)) from None


def unreadable(path: Path, error: OSError) -> str:
    """Why a file has no content, in words."""
    return f"{path} cannot be read: {error.strerror or error}"


def _with_included(file: NamedFile) -> list[NamedFile]:
    """A file, and those that an .inp takes in by *INCLUDE, at any depth."""
    found = [file]
    for each in found:  # grows on the way
        if each.path.suffix.lower() == ".inp" or each is not file:
            for name in INCLUDE.findall(each.content()):
                path = each.path.parent / name.decode(errors="replace")
                if path not in (other.path for other in found):
                    found.append(NamedFile(file.key, path))
    return found


def _of_matrices(matrices: Matrices) -> dict[Key, str]:
    """Files by their keys within [matrices]."""
    found: dict[Key, str] = {("K", part, "file"): K.file for part, K in matrices.K.items()}
    others = ("M", "C", "K_G", "dofs", "nodes")
    found |= {(key,): file for key in others if (file := getattr(matrices, key))}
    if not matrices.has_named_sets:
        found |= {(key,): file for key, file in matrices.sets.items()}
    return found
