"""Nodes, directions and trace lines of a universal file: where modal software shows the responses.

Coordinates are Cartesian, global: the axle along Y, angle 0 along +X. One place is one node, so
that a load and its driving point are one; an average over a disc has a node of its own.

Directions of the results are local, (r, y, theta) at the place's own angle, those of dataset 58
are X, Y, Z. Readers differ: some turn X, Y, Z by the node's displacement coordinate system, some
ignore it (ARTeMIS: "not used", svibs.com, UFF data set number 15). Therefore:

- where r and theta are global axes, at 0, 90, 180 and 270 degrees, they are written as such, with
  their signs and no system of their own: every reader shows them right;
- at other angles the node has a Cartesian displacement system (dataset 18) with X = r, Y = y,
  Z = theta, and the direction is 1, 2 or 3. y is right everywhere; r and theta are wrong by the
  node's angle in readers that ignore the system.

Source: Universal file formats, datasets 15, 18, 58, 82, SDRL of the University of Cincinnati.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.mesh.place import HUB, Place
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results.results import Results

FIRST_SYSTEM = 11
"""Number of the first displacement system: low ones are predefined in some programs."""

NEAR = 1e-9
"""How near to a quarter turn [rad] an angle has to be to count as one."""

MICRO = 1e-6
"""Places nearer than this [m], or [rad], are one."""

ENOUGH = 12
"""Places on a trace line that make its shape plain; with fewer, corners are added."""

N_AROUND = 36
"""Corners of a ring."""

MOST_LINES = 40
"""The most rings, and the most outlines: those with the most places."""

LONGEST = 125
"""Most nodes of one trace line, as MODAL-PLUS bears them (notes to dataset 82)."""

Key = tuple[int, ...]
Group = TypeVar("Group")


@dataclass(frozen=True, slots=True, eq=False)
class Geometry:
    """Numbered nodes, their systems, and the lines between them.

    numbers: (n,). points: (n, 3) [m]. systems: (n,) 0 where directions are global, else an index
        into `angles` plus FIRST_SYSTEM. angles: (k,) of the systems [rad].
    lines: trace lines, each a name and node numbers.
    nodes: number by place. hub: number of the wheel's centre, 0 without.
    """

    numbers: IntArray
    points: FloatArray
    systems: IntArray
    angles: FloatArray
    lines: tuple[tuple[str, IntArray], ...]
    nodes: dict[Key, int]
    hub: int

    def node(self, place: Place) -> int:
        """The number of a place's node."""
        return self.nodes[key_of(place)]


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """A trace line in the making: its corners along it, some of them places.

    points: (k, 3) in order. numbers: (k,) node numbers, 0 for a mere corner.
    """

    name: str
    points: FloatArray
    numbers: IntArray
    closed: bool


def geometry_of(results: Results) -> Geometry:
    """The geometry of a run: its loads, probes, and hub, with lines through them."""
    places = {key_of(place): place for place in (*results.loads, *results.probes)}
    nodes = {key: number for number, key in enumerate(places, start=1)}
    hub = len(nodes) + 1 if results.hub else 0
    points = [position(place.r, place.y, place.angle) for place in places.values()]
    angles = sorted({place.angle for place in places.values() if not _is_quarter(place.angle)})
    systems = [_system(place.angle, angles) for place in places.values()]
    if hub:
        points, systems = [*points, np.zeros(3)], [*systems, 0]
    numbers = list(range(1, len(points) + 1))
    next_number = 1 + 1000 * (1 + len(points) // 1000)
    lines = []
    for trace in (*_outlines(results.section, places, nodes), *_rings(places, nodes)):
        found, corners = trace.numbers.copy(), trace.numbers == 0
        found[corners] = np.arange(next_number, next_number + corners.sum())
        next_number += int(corners.sum())
        numbers += found[corners].tolist()
        points += list(trace.points[corners])
        lines += _pieces(trace.name, np.append(found, found[0]) if trace.closed else found)
    return Geometry(
        numbers=np.array(numbers),
        points=np.array(points),
        systems=np.array(systems + [0] * (len(points) - len(systems))),
        angles=np.array(angles),
        lines=tuple(lines),
        nodes=nodes,
        hub=hub,
    )


def key_of(place: Place) -> Key:
    """What tells nodes apart: where a place is, and over what disc it averages."""
    turn = round(2.0 * np.pi / MICRO)
    sizes = (place.r, place.y, place.diameter)
    return (round(place.angle / MICRO) % turn, *(round(size / MICRO) for size in sizes))


def position(r: float, y: float, angle: float) -> FloatArray:
    """(3,) global coordinates [m]."""
    return np.array([r * np.cos(angle), y, r * np.sin(angle)])


def axes_at(angle: float) -> dict[str, FloatArray]:
    """The local directions at an angle, in global components."""
    c, s = np.cos(angle), np.sin(angle)
    return {
        "r": np.array([c, 0.0, s]),
        "y": np.array([0.0, 1.0, 0.0]),
        "theta": np.array([-s, 0.0, c]),
    }


def direction_code(place: Place) -> int:
    """The direction of dataset 58: 1, 2, 3 for X, Y, Z, negative against them."""
    if not _is_quarter(place.angle):
        return {"r": 1, "y": 2, "theta": 3}[place.direction]
    axis = axes_at(place.angle)[place.direction]
    along = int(np.argmax(np.abs(axis)))
    return int(np.sign(axis[along])) * (along + 1)


def hub_code(component: str) -> int:
    """The direction of the blocked hub's component: 1 to 3 forces, 4 to 6 moments."""
    return HUB.index(component) + 1


def _is_quarter(angle: float) -> bool:
    quarters = angle / (np.pi / 2.0)
    return bool(abs(quarters - round(quarters)) * np.pi / 2.0 < NEAR)


def _system(angle: float, angles: list[float]) -> int:
    return 0 if _is_quarter(angle) else FIRST_SYSTEM + angles.index(angle)


def _outlines(
    section: SectionMesh, places: dict[Key, Place], nodes: dict[Key, int]
) -> Iterator[Trace]:
    """The tyre's outline at the angle of every place on a surface, through the places."""
    groups: dict[tuple[str, int], dict[Key, Place]] = {}
    for key, place in places.items():
        if place.surface:
            groups.setdefault((place.surface, key[0]), {})[key] = place
    for (surface, _), members in _most(groups):
        angle = next(iter(members.values())).angle
        length, outline = _outline(section, surface)
        if not len(outline):
            continue
        along = np.array([_along(outline, length, place) for place in members.values()])
        if len(members) >= ENOUGH:
            length, outline = length[:0], outline[:0]
        corners = np.array([position(r, y, angle) for r, y in outline]).reshape(-1, 3)
        name = f"{surface} surface at {np.rad2deg(angle):.6g} deg"
        yield _trace(name, members, nodes, along, length, corners, closed=False)


def _rings(places: dict[Key, Place], nodes: dict[Key, int]) -> Iterator[Trace]:
    """The circle around the axle through every place."""
    groups: dict[tuple[int, int], dict[Key, Place]] = {}
    for key, place in places.items():
        groups.setdefault((key[1], key[2]), {})[key] = place
    for _, members in _most(groups):
        one = next(iter(members.values()))
        turn = np.arange(N_AROUND) * 2.0 * np.pi / N_AROUND
        if len(members) >= ENOUGH:
            turn = turn[:0]
        corners = np.array([position(one.r, one.y, angle) for angle in turn]).reshape(-1, 3)
        along = np.array([place.angle for place in members.values()])
        name = f"ring at r = {one.r:.4f} m, y = {one.y:.4f} m"
        yield _trace(name, members, nodes, along, turn, corners, closed=True)


def _most(groups: dict[Group, dict[Key, Place]]) -> list[tuple[Group, dict[Key, Place]]]:
    """The groups with the most places, in their order."""
    largest = sorted(groups, key=lambda group: -len(groups[group]))[:MOST_LINES]
    return [(group, members) for group, members in groups.items() if group in largest]


def _outline(section: SectionMesh, surface: str) -> tuple[FloatArray, FloatArray]:
    """Length (k,) from the rim with y < 0, by chords, and (r, y) (k, 2) of a surface's nodes."""
    edges = getattr(section, surface)
    if not len(edges):
        return np.empty(0), np.empty((0, 2))
    inner = edges[:, [2, 1]] if edges.shape[1] == 3 else edges[:, 1:2]
    points = section.points[np.concatenate([edges[:1, 0], inner.ravel()])]
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    return length, points


def _along(outline: FloatArray, length: FloatArray, place: Place) -> float:
    """Where on the outline the point nearest to a place is, as a length by chords."""
    chord = np.diff(outline, axis=0)
    away = np.array([place.r, place.y]) - outline[:-1]
    share = np.clip(np.sum(away * chord, axis=1) / np.sum(chord**2, axis=1), 0.0, 1.0)
    k = int(np.argmin(np.linalg.norm(away - share[:, None] * chord, axis=1)))
    return float(length[k] + share[k] * (length[k + 1] - length[k]))


def _trace(
    name: str,
    members: dict[Key, Place],
    nodes: dict[Key, int],
    along: FloatArray,
    corner_along: FloatArray,
    corners: FloatArray,
    *,
    closed: bool,
) -> Trace:
    """Places and corners in their order on the line; no corner where a place is."""
    points = np.array([position(place.r, place.y, place.angle) for place in members.values()])
    apart = np.linalg.norm(corners[:, None] - points, axis=2).min(axis=1, initial=np.inf) > MICRO
    order = np.argsort(np.concatenate([along, corner_along[apart]]), kind="stable")
    return Trace(
        name=name,
        points=np.concatenate([points, corners[apart]])[order],
        numbers=np.concatenate(
            [[nodes[key] for key in members], np.zeros(int(apart.sum()), int)]
        ).astype(int)[order],
        closed=closed,
    )


def _pieces(name: str, numbers: IntArray) -> list[tuple[str, IntArray]]:
    """A line in pieces that are short enough, each beginning where the last has ended."""
    cuts = [*range(0, max(len(numbers) - 1, 1), LONGEST - 1), len(numbers) - 1]
    return [(name, numbers[a : b + 1]) for a, b in pairwise(cuts) if b > a]
