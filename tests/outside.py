"""Cells as another program would write them: numbers shuffled, bricks turned, nodes of no brick."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from tyrefrf.arrays import BoolArray, FloatArray, IntArray
from tyrefrf.mesh.bricks import Bricks
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.mesh.cut import Side
from tyrefrf.mesh.outside import Elements, OutsideMesh
from tyrefrf.mesh.periodic import CellSets, periodic_cell
from tyrefrf.mesh.shapes import HEX20

FIRST_NODE, FIRST_ELEMENT = 1001, 501
"""Numbers of a file begin anywhere."""


def right_handed_turns() -> IntArray:
    """(24, 20) orders of a brick's nodes that keep its handedness, from 24 rotation matrices."""
    turns = []
    for k in range(48):
        axes = np.zeros((3, 3))
        order = [(0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)][k // 8]
        axes[range(3), order] = [(-1.0) ** (k >> bit & 1) for bit in range(3)]
        if np.linalg.det(axes) > 0.0:
            match = np.all((HEX20 @ axes)[:, None] == HEX20, axis=2)
            turns.append(np.argmax(match, axis=1))
    return np.array(turns)


def outside(
    mesh: CellMesh, seed: int = 0, angle: float = 0.0, kept: BoolArray | None = None
) -> OutsideMesh:
    """A cell as an outside mesh, turned about the axle by an angle [rad] and shuffled.

    Sets: RIM, LEFT, RIGHT, INNER (nodes); one set of elements by material. One node has no brick,
    and more of them where not all bricks (e,) are kept.
    """
    rng = np.random.default_rng(seed)
    kept = np.ones(len(mesh.bricks), dtype=bool) if kept is None else kept
    n, n_nodes = mesh.n_nodes, mesh.bricks.shape[1]
    place = rng.permutation(n + 1)  # of every node, and of one that no brick has
    x, y, z = mesh.cartesian.T
    c, s = np.cos(angle), np.sin(angle)
    points = np.full((n + 1, 3), 0.3)
    points[place[:n]] = np.stack([c * x - s * z, y, s * x + c * z], axis=1)

    turns = right_handed_turns()
    order = turns[rng.integers(24, size=kept.sum()), :n_nodes]
    assert np.all(np.sort(order) == np.arange(n_nodes))
    bricks = place[np.take_along_axis(mesh.bricks[kept], order, axis=1)]
    shuffled = rng.permutation(len(bricks))
    numbers = FIRST_ELEMENT + rng.permutation(len(bricks))
    elements = numbers[np.argsort(shuffled)]  # of every brick of the cell that is kept
    own = {
        "RIM": mesh.rim,
        "LEFT": np.arange(mesh.n_face),
        "RIGHT": np.arange(mesh.n_own, n),
        "INNER": np.unique(mesh.inside),
    }
    return OutsideMesh(
        path="sector.inp",
        points=points,
        numbers=FIRST_NODE + rng.permutation(n + 1),
        elements=(
            Elements("hexahedron" if n_nodes == 8 else "hexahedron20", bricks[shuffled], numbers),
        ),
        element_sets={
            name: elements[mesh.material[kept] == index]
            for index, name in enumerate(mesh.materials)
        },
        node_sets={name: rng.permutation(place[nodes]) for name, nodes in own.items()},
        surfaces={},
    )


def number_of(written: OutsideMesh, mesh: CellMesh, node: int, angle: float = 0.0) -> int:
    """The number of a cell's node where it is written, turned by an angle [rad]."""
    place = _cartesian(mesh.points[[node]] + np.array([0.0, 0.0, angle]))
    return int(written.numbers[np.argmin(np.linalg.norm(written.points - place, axis=1))])


def inp(mesh: OutsideMesh, unit: float, axis: str) -> str:
    """The mesh as an Abaqus deck with lengths in `unit` [m] and the axle along x, y or z."""
    columns = {"x": [1, 2, 0], "y": [0, 1, 2], "z": [2, 0, 1]}[axis]  # right-handed, all three
    (block,) = mesh.elements
    name = {8: "C3D8I", 20: "C3D20R"}[block.nodes.shape[1]]
    lines = ["*NODE"]
    for number, x in zip(mesh.numbers, mesh.points[:, columns] / unit, strict=True):
        lines.append(f"{number}, {', '.join(f'{value:.16e}' for value in x)}")
    lines.append(f"*ELEMENT, TYPE={name}")
    for number, nodes in zip(block.numbers, mesh.numbers[block.nodes], strict=True):
        row = [number, *nodes]
        lines.append(", ".join(map(str, row[:12])) + ("," if len(row) > 12 else ""))
        lines += [", ".join(map(str, row[12:]))] if len(row) > 12 else []
    sets = [("*ELSET, ELSET", set_name, e) for set_name, e in mesh.element_sets.items()]
    sets += [("*NSET, NSET", n, mesh.numbers[nodes]) for n, nodes in mesh.node_sets.items()]
    for card, set_name, members in sets:
        lines += [f"{card}={set_name}", *(str(member) for member in members)]
    return "\n".join(lines) + "\n"


def bricks_of(mesh: OutsideMesh) -> Bricks:
    """All its elements; every element set is made of the material of its name."""
    (block,) = mesh.elements
    names = tuple(mesh.element_sets)
    material = np.full(len(block.numbers), -1)
    for index, name in enumerate(names):
        material[np.isin(block.numbers, mesh.element_sets[name])] = index
    assert np.all(material >= 0)
    return Bricks(block.nodes, block.numbers, material, names)


def sets_of(mesh: OutsideMesh, **named: str) -> CellSets:
    """The rim, and what else is named: inner, left and right, by their sets' names."""
    sides = {key: Side(mesh.node_sets[name], name) for key, name in named.items()}
    return CellSets(rim=Side(mesh.node_sets["RIM"], "RIM"), **sides)


def read_back(mesh: OutsideMesh, sector_angle: float, **named: str) -> CellMesh:
    """The cell of an outside mesh, by the sets that are named."""
    return periodic_cell(mesh, bricks_of(mesh), sets_of(mesh, **named), sector_angle)


def ring_nodes(mesh: CellMesh) -> FloatArray:
    """r, y, theta (n_cells * n_own, 3) of all nodes of the ring, cell by cell."""
    cells = np.arange(round(2.0 * np.pi / mesh.sector_angle))
    points = np.tile(mesh.points[: mesh.n_own], (len(cells), 1))
    points[:, 2] += np.repeat(cells, mesh.n_own) * mesh.sector_angle
    return points


def same_nodes(mesh: CellMesh, points: FloatArray, angle: float = 0.0) -> IntArray:
    """Ring nodes (m,) of a cell, cell n_own + node, at places (m, 3) r, y, theta + angle."""
    distance, nodes = KDTree(_cartesian(ring_nodes(mesh))).query(
        _cartesian(points + np.array([0.0, 0.0, angle]))
    )
    assert np.max(distance) < 1e-9
    return np.asarray(nodes)


def _cartesian(points: FloatArray) -> FloatArray:
    r, y, theta = points.T
    return np.stack([r * np.cos(theta), y, r * np.sin(theta)], axis=1)
