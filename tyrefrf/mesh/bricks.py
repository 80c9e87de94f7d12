"""The bricks of a mesh from another program, checked one by one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from tyrefrf.arrays import IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.outside import OutsideMesh
from tyrefrf.mesh.shapes import HEX8, HEX20, shape

COINCIDENT = 1e-6  # of the outer radius: nodes closer than this were meant to be one
SHOWN = 5  # nodes or elements named in a message


@dataclass(frozen=True, slots=True, eq=False)
class Bricks:
    """Bricks of one kind.

    nodes: (e, 8) or (e, 20) places in the points of the mesh, in Abaqus order. numbers: (e,) as
    the file numbers them. material: (e,) index into `materials`.
    """

    nodes: IntArray
    numbers: IntArray
    material: IntArray
    materials: tuple[str, ...]

    @property
    def used(self) -> IntArray:
        """Places of the nodes that a brick has, ascending; the file may have others."""
        return np.unique(self.nodes)


def check_bricks(mesh: OutsideMesh, bricks: Bricks) -> None:
    """Raise MeshError, naming elements or nodes, for bricks that cannot be computed with.

    Those are collapsed, inverted or flat ones, ones that lack a node, and ones whose common nodes
    are not one but two at the same place.
    """
    _whole(mesh, bricks.nodes, bricks.numbers)
    _upright(mesh, bricks.nodes, bricks.numbers)
    _merged(mesh, bricks.used)


def listed(numbers: IntArray) -> str:
    """The first few numbers, and how many more there are."""
    shown = ", ".join(map(str, numbers[:SHOWN]))
    return shown + (f" and {len(numbers) - SHOWN} more" if len(numbers) > SHOWN else "")


def _whole(mesh: OutsideMesh, nodes: IntArray, numbers: IntArray) -> None:
    """Check that no node of a brick is missing, and none there twice."""
    missing = np.flatnonzero(np.any(nodes < 0, axis=1))
    if len(missing):
        raise MeshError(f"{mesh.path}: nodes are missing in elements {listed(numbers[missing])}")
    ordered = np.sort(nodes, axis=1)
    twice = ordered[:, :-1] == ordered[:, 1:]
    collapsed = np.flatnonzero(np.any(twice, axis=1))
    if len(collapsed):
        e = collapsed[0]
        node = mesh.numbers[ordered[e, :-1][twice[e]][0]]
        raise MeshError(
            f"{mesh.path}: collapsed bricks, with a node twice: elements "
            f"{listed(numbers[collapsed])} (node {node} in {numbers[e]}); mesh them with whole "
            "hexahedra"
        )


def _upright(mesh: OutsideMesh, nodes: IntArray, numbers: IntArray) -> None:
    """Check that every brick has volume: det J > 0 at 3 x 3 x 3 Gauss points."""
    x, _ = np.polynomial.legendre.leggauss(3)
    xi = np.stack(np.meshgrid(x, x, x), axis=-1).reshape(-1, 3)
    _, dN = shape(HEX8 if nodes.shape[1] == 8 else HEX20, xi)
    det = np.linalg.det(np.einsum("gak,eai->egki", dN, mesh.points[nodes], optimize=True))
    bad = np.flatnonzero(np.any(det <= 0.0, axis=1))
    if not len(bad):
        return
    mirrored = len(bad) == len(nodes) and np.all(det < 0.0)
    why = "; all are: is the file's frame left-handed, or its node order?" if mirrored else ""
    where = mesh.points[nodes[bad[0]]].mean(axis=0)
    raise MeshError(
        f"{mesh.path}: inverted or flat bricks: elements {listed(numbers[bad])}{why} (the first "
        f"about r = {np.hypot(where[0], where[2]):.4g} m, y = {where[1]:.4g} m)"
    )


def _merged(mesh: OutsideMesh, used: IntArray) -> None:
    """Check that no two nodes of bricks stand at the same place."""
    X = mesh.points[used]
    pairs = KDTree(X).query_pairs(
        COINCIDENT * np.hypot(X[:, 0], X[:, 2]).max(), output_type="ndarray"
    )
    if len(pairs):
        shown = [f"{a} and {b}" for a, b in mesh.numbers[used[np.sort(pairs, axis=0)[:SHOWN]]]]
        raise MeshError(
            f"{mesh.path}: {len(pairs)} pairs of nodes stand at the same place, where the mesh "
            f"would be cut open: {', '.join(shown)}; merge them"
        )
