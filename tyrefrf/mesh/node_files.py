"""Nodes and sets of nodes in text files, for a cell that comes as matrices.

A file of nodes has a line for each: its number and three coordinates, apart by commas, semicolons
or blanks. A heading `number, x, y, z` or `number, r, y, theta` (theta in degrees) says which they
are; without one they are x, y, z. Lines that begin with # are skipped, as are empty ones.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.case import read_bytes
from tyrefrf.errors import MeshError
from tyrefrf.mesh.abaqus import read_inp
from tyrefrf.mesh.outside import OutsideMesh

SYSTEMS: tuple[tuple[str, ...], ...] = (("x", "y", "z"), ("r", "y", "theta"))
MAX_NUMBER = 10**12  # of a node: above it, not one

_APART = re.compile(r"[\s,;]+")


def read_nodes(path: Path, length: float, axis: str) -> OutsideMesh:
    """The nodes of a text file, or of an .inp file with its sets, in metres, the axle along y.

    length: [m] of the file's unit. axis: the file's x, y or z that the axle lies along; r, y,
    theta are the program's own (theta from x towards z).
    Raises MeshError, with the line, for what is no node, and for a number that comes twice.
    """
    if path.suffix.lower() == ".inp":
        if not path.is_file():
            raise MeshError(f"{path}: cannot be read: no such file")
        mesh = read_inp(path)
        return replace(mesh, points=length * mesh.points[:, axle_along_y(axis)])
    system = SYSTEMS[0]
    numbers: list[int] = []
    rows: list[list[float]] = []
    for line, words in lines_of(path):
        if not rows and not is_number(words[0]):
            system = _system(path, line, words)
            continue
        if len(words) != 4:
            raise wrong(path, line, f"{len(words)} entries; a node has 4: its number, and three")
        numbers.append(_whole(path, line, words[0]))
        rows.append([finite(path, line, word) for word in words[1:]])
    if not rows:
        raise MeshError(f"{path}: holds no nodes")
    found = np.array(numbers)
    first, count = np.unique(found, return_counts=True)
    if np.any(count > 1):
        raise MeshError(f"{path}: node {first[count > 1][0]} is there twice")
    return OutsideMesh(
        str(path), _metres(system, np.array(rows), length, axis), found, (), {}, {}, {}
    )


def read_node_set(path: Path) -> IntArray:
    """The numbers of the nodes in a text file, any number to a line. Raises MeshError."""
    numbers = [
        _whole(path, line, word)
        for first, (line, words) in enumerate(lines_of(path))
        if first or is_number(words[0])  # else a heading
        for word in words
    ]
    if not numbers:
        raise MeshError(f"{path}: holds no numbers of nodes")
    return np.unique(numbers)


def lines_of(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Lines that say something: their number from 1, and their words.

    Raises MeshError where the file cannot be read as text.
    """
    try:
        text = read_bytes(path).decode("utf-8-sig")
    except (OSError, ValueError) as error:
        reason = "it is not text"
        if isinstance(error, OSError):
            reason = error.strerror or str(error)
        raise MeshError(f"{path}: cannot be read: {reason}") from None
    for number, line in enumerate(text.splitlines(), start=1):
        words = [word for word in _APART.split(line.partition("#")[0]) if word]
        if words:
            yield number, words


def is_number(word: str) -> bool:
    """Whether a word is a number."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def finite(path: Path, line: int, word: str) -> float:
    """A word as a finite number. Raises MeshError."""
    try:
        value = float(word)
    except ValueError:
        raise wrong(path, line, f"{word[:40]!r} is not a number") from None
    if not math.isfinite(value):
        raise wrong(path, line, f"{word} is not a finite number")
    return value


def wrong(path: Path, line: int, message: str) -> MeshError:
    """What is wrong in a line of a file."""
    return MeshError(f"{path}:{line}: {message}")


def _system(path: Path, line: int, words: list[str]) -> tuple[str, ...]:
    """The coordinates that a heading names, behind the number."""
    named = tuple(word.lower() for word in words[1:])
    if named not in SYSTEMS:
        expected = " or ".join(", ".join(("number", *system)) for system in SYSTEMS)
        raise wrong(path, line, f"the heading is {', '.join(words)[:60]!r}; expected {expected}")
    return named


def _whole(path: Path, line: int, word: str) -> int:
    value = finite(path, line, word)
    if not value.is_integer() or not 0 <= value <= MAX_NUMBER:
        raise wrong(path, line, f"{word} is not the number of a node")
    return int(value)


def _metres(system: tuple[str, ...], rows: FloatArray, length: float, axis: str) -> FloatArray:
    """(n, 3) x, y, z [m] with the axle along y."""
    if system[0] == "r":
        r, y, theta = rows.T
        theta = np.deg2rad(theta)
        return length * np.stack([r * np.cos(theta), y, r * np.sin(theta)], axis=1)
    return length * rows[:, axle_along_y(axis)]


def axle_along_y(axis: str) -> list[int]:
    """Which of a file's x, y, z are the program's: in turn, so that right-handed axes stay so."""
    middle = "xyz".index(axis)
    return [(middle - 1) % 3, middle, (middle + 1) % 3]
