"""Meshes in Abaqus' and CalculiX's .inp format.

A parser of our own for the cards that make a mesh: *NODE, *ELEMENT, *NSET, *ELSET, *SURFACE and
*INCLUDE, with one part and one instance of it. The library, meshlane 5.5, does not serve here: it
skips axisymmetric elements (CAX4, CAX4R...), the usual ones for a tyre's section, keeps neither
numbers nor faces of a *SURFACE nor the set of *NODE, NSET=, drops numbers beside names in a set,
and ends the program at a range without a step.
Cards that make nodes or elements by rules (*NGEN, *ELGEN...) are refused; all others (materials,
steps) are passed over.
Source: Abaqus Keywords Reference Guide; CalculiX CrunchiX User's Manual, version 2.20.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from tyrefrf.arrays import IntArray
from tyrefrf.case import read_bytes, same_file
from tyrefrf.case.faults import shown
from tyrefrf.errors import MeshError
from tyrefrf.mesh.outside import Elements, OutsideMesh

KINDS = (
    (r"(C?G?AX|CPE|CPS|CPEG|S|M3D|SFM3D|R3D|DC2D|AC2D|DCAX|ACAX)4", "quad", 4),
    (r"(C?G?AX|CPE|CPS|CPEG|S|M3D|SFM3D|DC2D|AC2D|DCAX|ACAX)8", "quad8", 8),
    (r"(C?G?AX|CPE|CPS|CPEG|S|M3D|SFM3D|R3D|DC2D|AC2D|DCAX|ACAX|STRI)3", "triangle", 3),
    (r"(C?G?AX|CPE|CPS|CPEG|S|M3D|SFM3D|DC2D|AC2D|DCAX|ACAX)6", "triangle6", 6),
    (r"(CPE|CPS|CAX|S|M3D)9", "quad9", 9),
    (r"STRI65", "triangle6", 6),
    (r"T[23]D2", "line", 2),
    (r"T[23]D3", "line3", 3),
    (r"(C|DC|AC)3D8", "hexahedron", 8),
    (r"(C|DC|AC)3D20", "hexahedron20", 20),
    (r"(C|DC|AC)3D27", "hexahedron27", 27),
    (r"(C|DC|AC)3D4", "tetra", 4),
    (r"(C|DC|AC)3D10", "tetra10", 10),
    (r"(C|DC|AC)3D6", "wedge", 6),
    (r"(C|DC|AC)3D15", "wedge15", 15),
)
"""Element types by how their name begins, meshio's name of the kind, and the number of nodes.

Trusses are lines, as Gmsh writes its physical curves.
"""

GENERATORS = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SUBMODEL")
"""Cards that make or move nodes and elements by rules."""

MOST_FILES, DEEPEST = 1000, 50
"""Files that are taken in by *INCLUDE, each as often as it is, and how deep."""

MOST_MEMBERS = 10_000_000
"""Members of a set. Sets of sets, and ranges, may name far more than there are nodes."""

LARGEST_NUMBER = 10**12  # of a node or an element

ANY_FACE = 0
"""Stands for the number of a face where a surface takes all outer faces of its elements."""


def read_inp(path: Path) -> OutsideMesh:
    """The mesh of an .inp file, in the file's own unit and axes.

    Raises MeshError, naming the file and its line.
    """
    deck = _Deck()
    for card in _cards(path, (), iter(range(MOST_FILES))):
        deck.take(card)
    return deck.mesh(path)


@dataclass(frozen=True, slots=True)
class _Card:
    """A keyword with its parameters, and the numbered lines of data under it."""

    file: str
    line: int
    keyword: str
    parameters: Mapping[str, str]
    data: list[tuple[int, list[str]]]

    def fault(self, message: str, line: int = 0) -> MeshError:
        """An error at a line of the file; at the keyword's own by default."""
        return MeshError(f"{self.file}:{line or self.line}: {message}")

    def whole(self, text: str, line: int) -> int:
        try:
            number = int(text)
        except ValueError:
            raise self.fault(f"{shown(text)} is not a whole number", line) from None
        if abs(number) > LARGEST_NUMBER:
            raise self.fault(f"{shown(text)} is no number of a node or an element", line)
        return number

    def real(self, text: str, line: int) -> float:
        try:
            number = float(text.upper().replace("D", "E")) if text else 0.0
        except ValueError:
            raise self.fault(f"{shown(text)} is not a number", line) from None
        if not np.isfinite(number):
            raise self.fault(f"{shown(text)} is not a finite number", line)
        return number


def _cards(path: Path, above: tuple[str, ...], left: Iterator[int]) -> Iterator[_Card]:
    """The cards of a file and of those that it includes, in their order.

    above: the files that this one is in; left: a number for every file that may still be read.
    """
    if same_file(path) in above:
        raise MeshError(f"{path}: includes itself")
    if len(above) > DEEPEST or next(left, None) is None:
        limit = f"deeper than {DEEPEST}, or more than {MOST_FILES} files"
        raise MeshError(f"{path}: files that include each other {limit}")
    try:
        text = read_bytes(path).decode("utf-8-sig", errors="replace")
    except OSError as error:
        raise MeshError(f"{path}: cannot be read: {error.strerror or error}") from None
    card: _Card | None = None
    begun = ""
    for number, line in enumerate(text.splitlines(), start=1):
        line = line.strip()
        if not line or line.startswith("**"):
            continue
        if begun or line.startswith("*"):
            begun += line
            if begun.endswith(","):  # the keyword goes on
                continue
            if card is not None:
                yield card
            card = _Card(str(path), number, *_keyword(begun), data=[])
            begun = ""
            if card.keyword == "INCLUDE":
                yield from _included(card, path, (*above, same_file(path)), left)
        elif card is not None:
            card.data.append((number, [part.strip() for part in line.split(",")]))
        else:
            raise MeshError(f"{path}:{number}: data before the first keyword: not an .inp file")
    if card is None:
        raise MeshError(f"{path}: holds no keyword: not an .inp file")
    yield card


def _keyword(line: str) -> tuple[str, dict[str, str]]:
    """`*ELEMENT, TYPE=CAX4` as ("ELEMENT", {"TYPE": "CAX4"})."""
    first, *rest = line[1:].split(",")
    parameters = {}
    for part in rest:
        name, _, value = part.partition("=")
        parameters[name.strip().upper().replace(" ", "")] = value.strip().strip('"')
    return " ".join(first.upper().split()), parameters


def _included(
    card: _Card, path: Path, above: tuple[str, ...], left: Iterator[int]
) -> Iterator[_Card]:
    name = card.parameters.get("INPUT", "")
    if not name:
        raise card.fault("*INCLUDE without INPUT=")
    try:
        yield from _cards(path.parent / name, above, left)
    except MeshError as error:
        raise card.fault(f"*INCLUDE: {error}") from None


@dataclass(slots=True)
class _Deck:
    """What the cards have said so far. Names are compared as Abaqus does, by capital letters."""

    node_of: dict[int, int] = field(default_factory=dict)
    points: list[tuple[float, float, float]] = field(default_factory=list)
    elements: dict[str, tuple[list[int], list[list[int]]]] = field(default_factory=dict)
    lines: dict[int, tuple[str, int]] = field(default_factory=dict)  # where elements are
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    element_sets: dict[str, list[int]] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    generated: set[str] = field(default_factory=set)  # sets with gaps that nobody minds
    spelling: dict[str, str] = field(default_factory=dict)
    parts: int = 0
    instances: int = 0

    def take(self, card: _Card) -> None:
        """Read a card, or pass over it."""
        match card.keyword:
            case "NODE":
                self._nodes(card)
            case "ELEMENT":
                self._elements(card)
            case "NSET":
                self._set(card, self.node_sets, "NSET")
            case "ELSET":
                self._set(card, self.element_sets, "ELSET")
            case "SURFACE":
                self._surface(card)
            case "PART":
                self.parts += 1
            case "INSTANCE":
                self._instance(card)
            case keyword if keyword in GENERATORS:
                message = f"*{keyword} makes or moves nodes or elements and is not read"
                raise card.fault(f"{message}; write the mesh with all of them listed")
        if max(self.parts, self.instances) > 1:
            raise card.fault(
                "a second part or instance; write one flat mesh (Abaqus/CAE: Model, Edit "
                "Attributes, 'Do not use parts and assemblies in input files')"
            )

    def _key(self, name: str) -> str:
        """A set's name as it was first written."""
        return self.spelling.setdefault(name.upper(), name)

    def _instance(self, card: _Card) -> None:
        self.instances += 1
        if any(part not in ("", "0", "0.", "0.0") for _, row in card.data for part in row):
            message = "an instance that is moved or turned is not read; write one flat mesh"
            raise card.fault(message, card.data[0][0])

    def _nodes(self, card: _Card) -> None:
        if card.parameters.get("SYSTEM", "R").upper() != "R":
            raise card.fault("nodes in cylindrical or spherical coordinates are not read")
        found = []
        for line, row in card.data:
            number = card.whole(row[0], line)
            x, y, z = (card.real(part, line) for part in (*row[1:4], "", "", "")[:3])
            if number not in self.node_of:
                self.node_of[number] = len(self.points)
                self.points.append((x, y, z))
            elif self.points[self.node_of[number]] != (x, y, z):
                raise card.fault(f"node {number} is there twice, at different places", line)
            found.append(number)
        if name := card.parameters.get("NSET"):
            self.node_sets.setdefault(self._key(name), []).extend(found)

    def _elements(self, card: _Card) -> None:
        kind, n_nodes = _kind(card.parameters.get("TYPE", "").upper())
        numbers, nodes = self.elements.setdefault(kind, ([], []))
        found = []
        for line, row in _joined(card, 1 + n_nodes):
            number = card.whole(row[0], line)
            if n_nodes and (len(row) != 1 + n_nodes or not all(row)):
                n = sum(1 for part in row[1:] if part)
                raise card.fault(f"element {number} has {n} nodes; {kind} has {n_nodes}", line)
            if number in self.lines:
                file, first = self.lines[number]
                raise card.fault(f"element {number} is there already, at {file}:{first}", line)
            self.lines[number] = (card.file, line)
            numbers.append(number)
            nodes.append([card.whole(part, line) for part in row[1:]] if n_nodes else [])
            found.append(number)
        if name := card.parameters.get("ELSET"):
            self.element_sets.setdefault(self._key(name), []).extend(found)

    def _set(self, card: _Card, sets: dict[str, list[int]], parameter: str) -> None:
        """*NSET or *ELSET: numbers, names of sets before it, or ranges with GENERATE."""
        name = card.parameters.get(parameter)
        if not name:
            raise card.fault(f"*{card.keyword} without {parameter}=")
        members = sets.setdefault(self._key(name), [])
        if other := card.parameters.get("ELSET" if parameter == "NSET" else ""):
            members += self._nodes_of(card, other)
        for line, row in card.data:
            if "GENERATE" in card.parameters:
                members += _range(card, line, row)
                self.generated.add(self._key(name))
            else:
                for part in filter(None, row):
                    members += self._members(card, sets, part, line)
            if len(members) > MOST_MEMBERS:
                raise card.fault(f"a set of more than {MOST_MEMBERS} members", line)

    def _members(
        self, card: _Card, sets: Mapping[str, list[int]], part: str, line: int
    ) -> list[int]:
        """A number, or those of a set; either may carry the name of the one instance."""
        word = part if part.lstrip("+-").isdecimal() else part.strip('"')
        for candidate in (word, word.rpartition(".")[2]):
            if candidate.lstrip("+-").isdecimal():
                return [card.whole(candidate, line)]
            if self._key(candidate) in sets:
                return list(sets[self._key(candidate)])
        raise card.fault(f"'{part}' is neither a number nor a set above this line", line)

    def _nodes_of(self, card: _Card, name: str) -> list[int]:
        """Numbers of the nodes of an element set."""
        wanted = set(self._members(card, self.element_sets, name, card.line))
        rows = (
            row
            for numbers, nodes in self.elements.values()
            for number, row in zip(numbers, nodes, strict=True)
            if number in wanted
        )
        return sorted({node for row in rows for node in row})

    def _surface(self, card: _Card) -> None:
        """*SURFACE of faces or of nodes; one of shells' sides or edges is passed over."""
        name, kind = card.parameters.get("NAME", ""), card.parameters.get("TYPE", "ELEMENT").upper()
        if kind == "NODE":
            members = self.node_sets.setdefault(self._key(name), [])
            for line, row in card.data:
                members += self._members(card, self.node_sets, row[0], line)
        elif kind == "ELEMENT":
            faces: list[tuple[int, int]] = []
            for line, row in card.data:
                label = row[1].upper() if len(row) > 1 and row[1] else f"S{ANY_FACE}"
                if re.fullmatch(r"S[0-6]", label) is None:
                    return
                members = self._members(card, self.element_sets, row[0], line)
                faces += [(number, int(label[1])) for number in members]
            self.surfaces.setdefault(self._key(name), []).extend(faces)

    def mesh(self, path: Path) -> OutsideMesh:
        """Everything as arrays. Raises MeshError for what refers to nodes that are not there."""
        if not self.points or not self.lines:
            raise MeshError(f"{path}: holds no {'elements' if self.points else 'nodes'}")
        self._check(path, self.node_sets, self.node_of.keys(), "node")
        self._check(path, self.element_sets, self.lines.keys(), "element")
        return OutsideMesh(
            path=str(path),
            points=np.array(self.points),
            numbers=np.array(list(self.node_of)),
            elements=tuple(
                Elements(kind, self._places(numbers, nodes), np.array(numbers))
                for kind, (numbers, nodes) in self.elements.items()
                if numbers
            ),
            element_sets={
                name: _unique([number for number in found if number in self.lines])
                for name, found in self.element_sets.items()
            },
            node_sets={
                name: _unique([self.node_of[n] for n in found if n in self.node_of])
                for name, found in self.node_sets.items()
            },
            surfaces={
                name: np.array(sorted(set(faces)), dtype=np.int64).reshape(-1, 2)
                for name, faces in self.surfaces.items()
            },
        )

    def _check(
        self, path: Path, sets: Mapping[str, list[int]], there: Collection[int], what: str
    ) -> None:
        """Raise MeshError where a set lists what the file does not define."""
        for name, members in sets.items():
            lost = [] if name in self.generated else [n for n in members if n not in there]
            if lost:
                raise MeshError(
                    f"{path}: {what} set '{name}' has {what} {lost[0]}, which the file does not "
                    "define; is the file whole?"
                )

    def _places(self, numbers: list[int], nodes: list[list[int]]) -> IntArray:
        """Places (e, a) in `points` of the elements' nodes."""
        for number, row in zip(numbers, nodes, strict=True):
            for node in row:
                if node not in self.node_of:
                    file, line = self.lines[number]
                    raise MeshError(
                        f"{file}:{line}: element {number} has node {node}, which the file does "
                        "not define; is the file whole?"
                    )
        places = [[self.node_of[node] for node in row] for row in nodes]
        return np.array(places, dtype=np.int64).reshape(len(numbers), -1)


def _kind(name: str) -> tuple[str, int]:
    """Meshio's name of an element type and its nodes; of an unknown one, its own name and 0."""
    for pattern, kind, n_nodes in KINDS:
        if re.fullmatch(rf"{pattern}[A-Z]*[0-9]?", name):
            return kind, n_nodes
    return name or "elements without TYPE", 0


def _joined(card: _Card, length: int) -> Iterator[tuple[int, list[str]]]:
    """The rows of elements: a line that ends with a comma goes on, unless it is complete."""
    begun: list[str] = []
    first = 0
    for line, row in card.data:
        first = first if begun else line
        goes_on = row[-1] == ""
        begun += row[:-1] if goes_on else row
        if not goes_on or len(begun) >= length > 1:
            yield first, begun
            begun = []
    if begun:
        yield first, begun


def _range(card: _Card, line: int, row: list[str]) -> range:
    """The numbers of a line of GENERATE: first, last, and perhaps a step."""
    numbers = [card.whole(part, line) for part in row if part]
    if not 1 <= len(numbers) <= 3 or numbers[2:] == [0]:
        raise card.fault("GENERATE needs first, last and step", line)
    first, last = numbers[0], numbers[min(1, len(numbers) - 1)]
    found = range(first, last + 1, numbers[2] if len(numbers) == 3 else 1)
    if len(found) > MOST_MEMBERS:
        raise card.fault(f"GENERATE of more than {MOST_MEMBERS} numbers", line)
    return found


def _unique(numbers: list[int]) -> IntArray:
    return np.array(sorted(set(numbers)), dtype=np.int64)
