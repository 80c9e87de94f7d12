"""From matrices that another program assembled to the cell's own: numbering, axes, units.

Rows may come in any order and in Cartesian or cylindrical directions. Rows of nodes without
coordinates, such as the incompatible modes of CalculiX' C3D8I, are unknowns inside the cell: they
turn with it, and nothing outside it touches them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import block_diag, coo_array, csr_array

from tyrefrf.arrays import BoolArray, FloatArray, IntArray
from tyrefrf.errors import MeshError
from tyrefrf.fem.assembly import CellMatrices, Pattern
from tyrefrf.fem.frames import axes
from tyrefrf.fem.matrix_files import MatrixFile
from tyrefrf.fem.relaxation import Scaling
from tyrefrf.fem.viscoelastic import Constant, modulus_by_law
from tyrefrf.mesh.node_cell import Matched, NodeCell, cylindrical, matched
from tyrefrf.mesh.node_files import axle_along_y
from tyrefrf.mesh.outside import OutsideMesh

if TYPE_CHECKING:
    from tyrefrf.case import Damping, Part


@dataclass(frozen=True, slots=True)
class UnitSystem:
    """What the units of consistent matrices and coordinates are in SI: [m], [kg], [s]."""

    length: float
    mass: float
    time: float

    def factor(self, letter: str) -> float:
        """Of M, C, or a stiffness."""
        return self.mass / self.time ** {"M": 0, "C": 1}.get(letter, 2)


UNIT_SYSTEMS = {
    "SI": UnitSystem(1.0, 1.0, 1.0),
    "mm-t-s": UnitSystem(1e-3, 1e3, 1.0),
    "mm-kg-ms": UnitSystem(1e-3, 1.0, 1e-3),
}
"""mm-t-s: forces in N, stresses in MPa; mm-kg-ms: forces in kN, stresses in GPa."""


@dataclass(frozen=True, slots=True, eq=False)
class Sets:
    """Numbers of the nodes on the sections and on the rim, as their file numbers them."""

    left: IntArray
    right: IntArray
    rim: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class CellFiles:
    """What the files of one cell hold.

    stiffness: by part. others: M, and C and K_G where there are any. dofs: (n, 2) node and
    direction of every row; None for three rows a node, in the order of `mesh`. mesh: the nodes.
    axis: the Cartesian one that the axle lies along in the rows' directions.
    """

    stiffness: Mapping[str, MatrixFile]
    others: Mapping[str, MatrixFile]
    dofs: IntArray | None
    mesh: OutsideMesh
    sets: Sets
    units: UnitSystem
    axis: str
    is_cylindrical: bool

    @property
    def rows(self) -> IntArray:
        """(n, 2) node and direction of every row."""
        if self.dofs is not None:
            return self.dofs
        numbers = self.mesh.numbers
        return np.stack([np.repeat(numbers, 3), np.tile(np.arange(3), len(numbers))], axis=1)

    def matrices(self) -> dict[str, csr_array]:
        """All matrices, K.<part> and the others, with a row for each that is described.

        Raises MeshError where they have others, or K none: a file that was cut off.
        """
        rows, files = self.rows, {f"K.{part}": A for part, A in self.stiffness.items()}
        files |= self.others
        for name, A in files.items():
            may_end_early = A.is_open and name != "M"  # the last row has mass, but maybe not all
            if A.size > len(rows) or (A.size < len(rows) and not may_end_early):
                raise MeshError(f"{A.path}: {name} has {A.size} rows, but {self._described}")
        found = {name: A.of_size(len(rows)) for name, A in files.items()}
        stiff = sum(abs(A.diagonal()) for name, A in found.items() if name.startswith("K."))
        empty = np.flatnonzero(stiff == 0.0)
        if len(empty):
            node, direction = rows[empty[0]]
            raise MeshError(
                f"row {empty[0] + 1} of K (node {node}, direction {direction + 1}) has nothing on "
                "its diagonal; are the files complete?"
            )
        return found

    @property
    def _described(self) -> str:
        """How many rows there should be, and why."""
        n = len(self.rows)
        if self.dofs is None:
            return f"{n // 3} nodes have {n}; or say in `dofs` what its rows are"
        return f"`dofs` says of {n} what they are"


@dataclass(frozen=True, slots=True, eq=False)
class BroughtMatrices:
    """One cell's matrices in the program's dofs and units, all in one pattern.

    K: by part [N/m]; M, C, K_G: entries (nnz,) as in `CellMatrices`. fixed: (n,) dofs on the rim,
    and those that only fill up the threes of unknowns without a node.
    points: (n / 3, 3) of the nodes, theta from the left section on.
    sections: how the left section falls on the right one. n_inner: unknowns without a node.
    left_out: nodes with coordinates that the matrices do not have. rim_whole: whether the rim's
    rows are there, so that its reaction is known.
    """

    nodes: NodeCell
    pattern: Pattern
    K: Mapping[str, FloatArray]
    M: FloatArray
    C: FloatArray
    K_G: FloatArray
    fixed: BoolArray
    points: FloatArray
    sections: Matched
    n_inner: int
    left_out: int
    rim_whole: bool

    def cell(self, parts: Mapping[str, Part], damping: Damping) -> CellMatrices:
        """The cell's matrices; parts of the stiffness by their names, with their losses."""
        K = sum(self.K.values(), start=np.zeros(self.pattern.nnz))
        return CellMatrices(
            indptr=self.pattern.indptr,
            indices=self.pattern.indices,
            K=self.K,
            relaxation={name: _relaxation(part) for name, part in parts.items()},
            M=self.M,
            C=self.C + damping.alpha * self.M + damping.beta * K,
            K_G=self.K_G,
            K_P=np.zeros(self.pattern.nnz),
            n_face=3 * self.nodes.n_face,
            fixed=self.fixed,
            points=self.points,
            of_no_node=self.nodes.numbers < 0,
        )


def bring(files: CellFiles, sector_angle: float) -> BroughtMatrices:
    """Put brought matrices into the order, the axes and the units of the program.

    Raises MeshError where sizes, nodes, sets or sections do not fit.
    """
    matrices, mesh = files.matrices(), files.mesh
    layout = _Layout.of(files.rows, mesh, files.sets, sector_angle)
    T = layout.axes(files)
    turned = {name: files.units.factor(name) * (T @ A @ T.T) for name, A in matrices.items()}
    pattern = _pattern(list(turned.values()), 3 * layout.n_nodes)
    entries = {name: _entries(pattern, A) for name, A in turned.items()}
    zero = np.zeros(pattern.nnz)
    return BroughtMatrices(
        nodes=layout.nodes(tuple(files.stiffness), mesh, sector_angle),
        pattern=pattern,
        K={part: entries[f"K.{part}"] for part in files.stiffness},
        M=entries["M"],
        C=entries.get("C", zero),
        K_G=entries.get("K_G", zero),
        fixed=layout.fixed,
        points=layout.points - [0.0, 0.0, layout.sections.theta.mean()],
        sections=layout.sections,
        n_inner=int(np.sum(layout.order[layout.row // 3] < 0)),
        left_out=len(mesh.numbers) - int(np.sum(layout.order >= 0)),
        rim_whole=layout.rim_whole,
    )


def _relaxation(part: Part) -> Scaling:
    """What becomes of a part of the stiffness at a frequency."""
    if part.modulus is not None:
        return Scaling(modulus_by_law(part.modulus))
    return Scaling(Constant(1.0, part.eta))  # of its matrix, whatever modulus that has


@dataclass(frozen=True, slots=True, eq=False)
class _Layout:
    """Where the rows and the nodes of the files are in the cell.

    order: places in the mesh of the cell's nodes, -1 of what is no node; left section first, right
    one last. row: (n,) the cell's dof of every row of the files, in the files' own directions.
    points: (n, 3) r, y, theta of the cell's nodes where the files have them. rim: of the cell's
    nodes. fixed: of the cell's dofs.
    """

    order: IntArray
    row: IntArray
    points: FloatArray
    rim: IntArray
    fixed: BoolArray
    sections: Matched
    rim_whole: bool

    @property
    def n_nodes(self) -> int:
        """Of the cell, unknowns without a node by threes among them."""
        return len(self.order)

    @classmethod
    def of(cls, dofs: IntArray, mesh: OutsideMesh, sets: Sets, sector_angle: float) -> _Layout:
        """Number the cell's nodes and dofs."""
        points = cylindrical(mesh.points)
        known = {int(number): place for place, number in enumerate(mesh.numbers)}
        left = _places(known, sets.left, "left")
        right = _places(known, sets.right, "right")
        on_rim = _places(known, sets.rim, "rim")
        sections = matched(points, mesh.numbers, left, right, sector_angle)
        _check_rim(on_rim, sections, mesh.numbers)

        node = np.array([known.get(int(number), -1) for number in dofs[:, 0]])
        rows_of = np.bincount(node[node >= 0], minlength=len(points))
        needed = np.union1d(np.flatnonzero(rows_of), np.concatenate([left, right]))
        _check_rows(dofs, node, np.setdiff1d(needed, on_rim), rows_of, mesh.numbers)
        hidden = np.flatnonzero(node < 0)
        inside = np.setdiff1d(needed, np.concatenate([left, right]))
        nameless = np.full(-(-len(hidden) // 3), -1)
        order = np.concatenate([sections.left, inside, nameless, sections.right])
        place = np.full(len(points), -1)
        place[order[order >= 0]] = np.flatnonzero(order >= 0)
        row = 3 * place[node] + dofs[:, 1]
        row[hidden] = 3 * (len(left) + len(inside)) + np.arange(len(hidden))
        rim = np.intersect1d(place[on_rim], np.flatnonzero(order >= 0))
        return cls(
            order=order,
            row=row,
            points=_points(points, sections, inside, len(nameless), sector_angle),
            rim=rim,
            fixed=_fixed(order, row, rim),
            sections=sections,
            rim_whole=bool(np.all(rows_of[order[rim]] == 3)),
        )

    def axes(self, files: CellFiles) -> csr_array:
        """T (n, rows) with q = T q_files: files' rows to r, y, theta of the cell's nodes."""
        n, row = 3 * self.n_nodes, self.row
        turn = np.tile(np.eye(3), (self.n_nodes, 1, 1))
        if not files.is_cylindrical:
            ours = np.argsort(axle_along_y(files.axis))  # of a file's x, y and z
            of_node = self.order[row // 3] >= 0
            row = np.where(of_node, 3 * (row // 3) + ours[row % 3], row)
            turn[self.order >= 0] = axes(self.points[self.order >= 0, 2])
        place = coo_array((np.ones(len(row)), (row, np.arange(len(row)))), shape=(n, len(row)))
        blocks = [csr_array(block) for block in turn]
        return csr_array(block_diag(blocks, format="csr") @ place.tocsr())

    def nodes(self, parts: tuple[str, ...], mesh: OutsideMesh, sector_angle: float) -> NodeCell:
        """The cell's nodes for placing loads and probes."""
        whole_cells = np.array([0.0, 0.0, self.sections.whole_cells * sector_angle])
        return NodeCell(
            points=self.points + whole_cells,
            numbers=np.where(self.order >= 0, mesh.numbers[self.order], -1),
            n_face=len(self.sections.left),
            rim=self.rim,
            parts=parts,
            sector_angle=sector_angle,
        )


def _places(known: Mapping[int, int], numbers: IntArray, name: str) -> IntArray:
    """Places of the nodes of a set. Raises MeshError naming one that has no coordinates."""
    unknown = [int(number) for number in numbers if int(number) not in known]
    if unknown:
        more = f" (and {len(unknown) - 1} more)" if len(unknown) > 1 else ""
        raise MeshError(f"matrices.{name}: node {unknown[0]}{more} has no coordinates")
    return np.array([known[int(number)] for number in numbers], np.int64)


def _check_rim(rim: IntArray, sections: Matched, numbers: IntArray) -> None:
    """A node of the left section is on the rim where its partner is."""
    left, right = np.isin(sections.left, rim), np.isin(sections.right, rim)
    if np.any(left != right):
        odd = int(np.flatnonzero(left != right)[0])
        pair = int(numbers[sections.left[odd]]), int(numbers[sections.right[odd]])
        on, off = pair if left[odd] else pair[::-1]
        raise MeshError(f"node {on} is on the rim, but {off}, the same one cell further, is not")


def _check_rows(
    dofs: IntArray, node: IntArray, moving: IntArray, rows_of: IntArray, numbers: IntArray
) -> None:
    """Nodes that move have three displacements each, and none has rotations.

    node: (n,) place of every row's node, -1 of none; moving: places; rows_of: (n_nodes,).
    """
    turning = np.flatnonzero((node >= 0) & (dofs[:, 1] > 2))
    if len(turning):
        number, direction = dofs[turning[0]]
        raise MeshError(
            f"row {turning[0] + 1} is direction {direction + 1} of node {number}; nodes have "
            "displacements 1, 2 and 3 only (solid elements)"
        )
    short = moving[rows_of[moving] < 3]
    if len(short):
        raise MeshError(
            f"node {numbers[short[0]]} has {rows_of[short[0]]} rows of three in the matrices; only "
            "nodes on the rim may be held already"
        )


def _fixed(order: IntArray, row: IntArray, rim: IntArray) -> BoolArray:
    """(n,) dofs on the rim, and those that only fill up the threes of unknowns without a node."""
    fixed = np.repeat(order < 0, 3)
    fixed[row] = False
    fixed.reshape(-1, 3)[rim] = True
    return fixed


def _points(
    points: FloatArray, sections: Matched, inside: IntArray, n_pseudo: int, sector_angle: float
) -> FloatArray:
    """(n, 3) r, y, theta of the cell's nodes, theta without jumps, the right section's exact."""
    left = points[sections.left].copy()
    left[:, 2] = sections.theta
    middle = left.mean(axis=0) + np.array([0.0, 0.0, sector_angle / 2.0])
    inner = points[inside].copy()
    inner[:, 2] = middle[2] + np.angle(np.exp(1j * (inner[:, 2] - middle[2])))
    right = left + np.array([0.0, 0.0, sector_angle])
    return np.concatenate([left, inner, np.tile(middle, (n_pseudo, 1)), right])


def _pattern(matrices: list[csr_array], n: int) -> Pattern:
    """Full blocks for all nodes that share an entry, and on the diagonal."""
    n_nodes = n // 3
    pairs = [np.arange(n_nodes) * (n_nodes + 1)]
    for A in matrices:
        entries = A.tocoo()
        pairs.append(np.unique(entries.row.astype(np.int64) // 3 * n_nodes + entries.col // 3))
    a, b = np.divmod(np.unique(np.concatenate(pairs)), n_nodes)
    i, j = np.divmod(np.arange(9), 3)
    return Pattern(n, np.sort(((3 * a[:, None] + i) * n + 3 * b[:, None] + j).ravel()))


def _entries(pattern: Pattern, A: csr_array) -> FloatArray:
    """A matrix as entries (nnz,) of the pattern."""
    coo = A.tocoo()
    slots = np.searchsorted(pattern.keys, coo.row.astype(np.int64) * pattern.n + coo.col)
    total = np.bincount(slots, weights=coo.data, minlength=pattern.nnz)
    return total.astype(np.float64, copy=False)
