"""Small bodies for the proofs: bricks in a cube and rings of rectangular section."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.linalg import splu

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from tyrefrf.case import Damping, Isotropic
from tyrefrf.fem.assembly import CellMatrices, assemble_cell
from tyrefrf.fem.elements import ELEMENTS, Element
from tyrefrf.mesh.cell import CellMesh, revolve
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.mesh.shapes import HEX8, HEX20, QUAD4, QUAD8


def midside_corners(corners: FloatArray, nodes: FloatArray) -> IntArray:
    """The two corners (m, 2) that every mid-side of a natural node table lies between."""
    mids = nodes[len(corners) :]
    return np.array(
        [np.flatnonzero(np.all((corners == m) | (m == 0.0), axis=1)) for m in mids], dtype=np.int64
    )


QUAD_EDGES = midside_corners(QUAD4, QUAD8)
HEX_EDGES = midside_corners(HEX8, HEX20)


def with_midsides(
    points: FloatArray, cells: IntArray, edges: IntArray
) -> tuple[FloatArray, IntArray]:
    """Points and cells with a node half-way along every straight edge."""
    pairs = np.sort(cells[:, edges], axis=2)
    ends, number = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
    mids = len(points) + number.reshape(pairs.shape[:2])
    return np.vstack([points, points[ends].mean(axis=1)]), np.hstack([cells, mids])


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Bricks (e, a) among points (n, 3) x, y, z."""

    points: FloatArray
    bricks: IntArray

    @property
    def X(self) -> FloatArray:
        """Coordinates of the nodes of every brick (e, a, 3)."""
        return self.points[self.bricks]

    def mapped(self, to: Callable[[FloatArray], FloatArray]) -> Block:
        """The same bricks at other places."""
        return Block(to(self.points), self.bricks)

    def of(self, element: Element) -> Block:
        """These eight-node bricks with the nodes that the element needs, edges straight."""
        if element.n_nodes == 8:
            return self
        return Block(*with_midsides(self.points, self.bricks, HEX_EDGES))

    def assembled(self, A: FloatArray) -> csr_array:
        """The sum of brick matrices A (e, 3a, 3a), in Cartesian dofs."""
        dofs = (3 * self.bricks[:, :, None] + np.arange(3)).reshape(len(self.bricks), -1)
        rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
        n = 3 * len(self.points)
        return coo_array((A.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n)).tocsr()


def box(n_x: int, n_y: int, n_z: int) -> Block:
    """The unit cube in n_x * n_y * n_z eight-node bricks."""
    counts = np.array([n_x, n_y, n_z])
    grid = np.stack(np.meshgrid(*map(np.arange, counts + 1), indexing="ij"), axis=-1)
    low = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3)
    corners = low[:, None] + (HEX8.astype(int) + 1) // 2
    return Block(
        grid.reshape(-1, 3) / counts,
        np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), tuple(counts + 1)),
    )


def on_surface(points: FloatArray) -> BoolArray:
    """Which points (n, 3) lie on the surface of the unit cube."""
    return np.any(np.isclose(points, 0.0) | np.isclose(points, 1.0), axis=1)


def solve(K: csr_array, f: FloatArray, known: BoolArray, u: FloatArray) -> FloatArray:
    """Displacements of K u = f, with u given where known."""
    K, free = K.tocsc(), ~known
    u = np.where(known, u, 0.0)
    u[free] = splu(K[free][:, free].tocsc()).solve((f - K @ u)[free])
    return u


def rectangle(r: FloatArray, y: FloatArray, element: Element) -> SectionMesh:
    """A rectangular section of straight quadrilaterals between lines of constant r and y."""
    n_r, n_y = len(r), len(y)
    points = np.stack(np.meshgrid(r, y, indexing="ij"), axis=-1).reshape(-1, 2)
    k, j = (a.ravel() for a in np.mgrid[: n_r - 1, : n_y - 1])
    first = k * n_y + j
    return section(points, np.stack([first, first + n_y, first + n_y + 1, first + 1], 1), element)


def section(points: FloatArray, quads: IntArray, element: Element) -> SectionMesh:
    """A section of straight-sided quadrilaterals, free at its rim, for the element."""
    if element.n_nodes == 20:
        points, quads = with_midsides(points, quads, QUAD_EDGES)
    none = np.zeros((0, 2), dtype=np.int64)
    return SectionMesh(
        points=points,
        quads=quads,
        material=np.zeros(len(quads), dtype=np.int64),
        materials=("rubber",),
        rim=none[:, 0],
        outer=none,
        inner=none,
    )


def crooked_section(element: Element) -> SectionMesh:
    """Three by two quadrilaterals without a right angle, about 0.1 m wide at a radius of 0.3 m."""
    regular = rectangle(np.linspace(0.25, 0.31, 4), np.linspace(-0.05, 0.04, 3), ELEMENTS["hex8"])
    r, y = regular.points.T
    bent = np.stack(
        [r + 0.2 * y + 0.004 * np.sin(70.0 * (r + 2.0 * y)), y + 0.006 * np.cos(60.0 * (r - y))], 1
    )
    return section(bent, regular.quads, element)


def cell_of(mesh: CellMesh, element: Element, E: float, nu: float, rho: float) -> CellMatrices:
    """The cell's matrices, lossless and undamped."""
    rubber = Isotropic(E=E, nu=nu, rho=rho)
    return assemble_cell(mesh, {"rubber": rubber}, element, Damping())


def dense(cell: CellMatrices) -> tuple[FloatArray, FloatArray]:
    """Loss-free K and M (n, n) of a cell of one material."""
    (K,) = cell.K.values()
    return cell.sparse(K).toarray(), cell.sparse(cell.M).toarray()


def order_matrix(A: FloatArray, n_face: int, mu: float) -> ComplexArray:
    """A cell's matrix with its right section turned onto the left one: q_R = q_L exp(i mu)."""
    n_own = len(A) - n_face
    periodic = np.eye(len(A), n_own, dtype=complex)
    periodic[n_own:, :n_face] = np.exp(1j * mu) * np.eye(n_face)
    return periodic.conj().T @ A @ periodic


__all__ = [
    "Block",
    "box",
    "cell_of",
    "crooked_section",
    "dense",
    "on_surface",
    "order_matrix",
    "rectangle",
    "revolve",
    "section",
    "solve",
]
