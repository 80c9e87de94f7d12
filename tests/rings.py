"""Small tyres for tests, and their referee: the whole ring assembled in Cartesian coordinates.

The referee takes the element matrices of every brick of the ring at its true angle and nothing
else from tyrefrf: no cell, no cylindrical dofs, none of the solvers' index maps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from tyrefrf.case import Damping, Geometry, Isotropic
from tyrefrf.fem.assembly import CellMatrices, assemble_cell
from tyrefrf.fem.elasticity import isotropic
from tyrefrf.fem.elements import ELEMENTS, Element
from tyrefrf.mesh.cell import CellMesh, revolve
from tyrefrf.mesh.profile import tyre_section
from tyrefrf.solvers import Recursive, RingProblem

R, Y, THETA = 0, 1, 2


PAPER = Isotropic(E=80e6, nu=0.42, rho=1200.0, eta=0.1)
"""The paper's homogeneous tyre."""
UNDAMPED = Damping()


@dataclass(frozen=True)
class Ring:
    """A tyre: one cell's mesh and materials, repeated n_cells times."""

    mesh: CellMesh
    materials: Mapping[str, Isotropic]
    element: Element
    n_cells: int
    damping: Damping

    @cached_property
    def cell(self) -> CellMatrices:
        """The cell's matrices as tyrefrf assembles them."""
        return assemble_cell(self.mesh, self.materials, self.element, self.damping)

    @cached_property
    def cartesian(self) -> CartesianRing:
        """The referee."""
        return CartesianRing(self)

    @cached_property
    def to_cartesian(self) -> csc_array:
        """Turns a ring vector from (r, y, theta) to (x, y, z), node by node."""
        own = self.mesh.points[: self.mesh.n_own, 2]
        cells = np.arange(self.n_cells)[:, None]
        return _axes((own + cells * self.mesh.sector_angle).ravel())

    @property
    def n_dofs(self) -> int:
        """Dofs of the whole ring, fixed ones included."""
        return 3 * self.n_cells * self.mesh.n_own

    def problem(self, loads: csc_array, probes: csc_array | None = None) -> RingProblem:
        """The question for the solvers; without probes, every load is also a probe."""
        return RingProblem(self.cell, self.n_cells, loads, loads if probes is None else probes)

    def dof(self, section: int, node: int, direction: int) -> int:
        """Row of a node of a cell in a load or probe column."""
        return 3 * (section % self.n_cells * self.mesh.n_own + node) + direction

    def columns(self, *columns: Mapping[int, float]) -> csc_array:
        """Sparse load or probe columns from {row: weight}."""
        rows = [row for column in columns for row in column]
        weights = [weight for column in columns for weight in column.values()]
        numbers = np.repeat(np.arange(len(columns)), [len(column) for column in columns])
        return coo_array((weights, (rows, numbers)), shape=(self.n_dofs, len(columns))).tocsc()

    def point_loads(self, *places: tuple[int, int, int]) -> csc_array:
        """A unit force for each (section, node, direction)."""
        return self.columns(*({self.dof(*place): 1.0} for place in places))

    def with_free_rim(self) -> Ring:
        """The same tyre, held by nothing."""
        return replace(self, mesh=replace(self.mesh, rim=np.empty(0, np.int64)))


def tyre(
    element: str = "hex8i",
    n_cells: int = 45,
    elements_along: int = 28,
    elements_around: int = 1,
    stuff: Isotropic = PAPER,
    damping: Damping = UNDAMPED,
) -> Ring:
    """A homogeneous tyre; by default the paper's, of exactly its size."""
    geometry = Geometry(elements_along=elements_along, material="rubber")
    section = tyre_section(geometry, quadratic=element.startswith("hex20"))
    mesh = revolve(section, 2.0 * np.pi / n_cells, elements_around)
    return Ring(mesh, {"rubber": stuff}, ELEMENTS[element], n_cells, damping)


def with_steel_belt(ring: Ring, eta: float = 0.1) -> Ring:
    """The same tyre of soft rubber, with loss-free steel in every brick under the tread."""
    mesh = ring.mesh
    belt = mesh.points[mesh.bricks, 0].mean(axis=1) > 0.255
    return replace(
        ring,
        mesh=replace(mesh, material=belt.astype(np.int64), materials=("rubber", "belt")),
        materials={
            "rubber": Isotropic(E=28e6, nu=0.45, rho=1100.0, eta=eta),
            "belt": Isotropic(E=2e11, nu=0.3, rho=7800.0),
        },
    )


def lossless(ring: Ring) -> Ring:
    """The same tyre with nothing that dissipates."""
    stuff = {name: m.model_copy(update={"eta": 0.0}) for name, m in ring.materials.items()}
    return replace(ring, materials=stuff, damping=UNDAMPED)


def lopsided(ring: Ring, seed: int = 1) -> Ring:
    """The same tyre with a cell that is nowhere its own mirror image, by its interior.

    Interior nodes are moved at random and every brick takes one of two materials at random.
    """
    rng = np.random.default_rng(seed)
    points = ring.mesh.points.copy()
    inside = slice(ring.mesh.n_face, ring.mesh.n_own)
    points[inside] += rng.uniform(-1.0, 1.0, points[inside].shape) * [5e-4, 5e-4, 4e-3]
    return _mottled(replace(ring, mesh=replace(ring.mesh, points=points)), rng)


def skewed(ring: Ring, seed: int = 1) -> Ring:
    """The same tyre with a cell that is not its own mirror image, with or without an interior.

    The sections are no planes: their nodes are moved along the ring at random, alike in all
    sections, and every brick takes one of two materials at random.
    """
    rng = np.random.default_rng(seed)
    mesh, points = ring.mesh, ring.mesh.points.copy()
    turns = rng.uniform(-0.01, 0.01, mesh.n_face)  # less than any brick is thick
    for section in (slice(0, mesh.n_face), slice(mesh.n_own, None)):
        points[section, 2] += turns
    return _mottled(replace(ring, mesh=replace(mesh, points=points)), rng)


def _mottled(ring: Ring, rng: np.random.Generator) -> Ring:
    """The same tyre of two materials, brick by brick at random, and viscous damping."""
    choice = rng.permutation(np.arange(len(ring.mesh.bricks)) % 2)
    return replace(
        ring,
        mesh=replace(ring.mesh, material=choice, materials=("rubber", "tread")),
        materials={
            "rubber": Isotropic(E=28e6, nu=0.45, rho=1100.0, eta=0.15),
            "tread": Isotropic(E=400e6, nu=0.3, rho=1500.0, eta=0.03),
        },
        damping=Damping(alpha=3.0, beta=1e-6),
    )


class CartesianRing:
    """The whole ring in x, y, z: K (complex), M and C of all bricks at their true angles."""

    def __init__(self, ring: Ring) -> None:
        mesh, N = ring.mesh, ring.n_cells
        cells = np.arange(N)
        nodes = (mesh.bricks + cells[:, None, None] * mesh.n_own) % (N * mesh.n_own)
        nodes = nodes.reshape(-1, mesh.bricks.shape[1])
        theta = mesh.points[mesh.bricks, 2] + cells[:, None, None] * mesh.sector_angle
        r, y = (np.tile(mesh.points[mesh.bricks, k], (N, 1)) for k in (0, 1))
        theta = theta.reshape(r.shape)
        X = np.stack([r * np.cos(theta), y, r * np.sin(theta)], axis=2)

        dofs = (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), -1)
        material_of = np.tile(mesh.material, N)
        n = ring.n_dofs
        self.K, self.C, self.M = (csc_array((n, n), dtype=t) for t in (complex, float, float))
        for index, name in enumerate(mesh.materials):
            here, stuff = material_of == index, ring.materials[name]
            K = _sum(ring.element.stiffness(X[here], isotropic(stuff.E, stuff.nu)), dofs[here], n)
            M = _sum(ring.element.mass(X[here], stuff.rho), dofs[here], n)
            self.K = self.K + (1.0 + 1j * stuff.eta) * K
            self.M = self.M + M
            self.C = self.C + ring.damping.alpha * M + ring.damping.beta * K

        self.to_cartesian = ring.to_cartesian
        held = np.zeros((N, mesh.n_own, 3), dtype=bool)
        held[:, mesh.rim[mesh.rim < mesh.n_own]] = True
        self.free: BoolArray = ~held.ravel()
        self.shape = (N, 3 * mesh.n_own)

    def dynamic_stiffness(self, omega: float) -> csc_array:
        """K + i omega C - omega^2 M."""
        return csc_array(self.K + 1j * omega * self.C - omega**2 * self.M)

    def solve(self, omega: float, loads: csc_array) -> tuple[ComplexArray, ComplexArray]:
        """Displacements and reactions (n_cells, n_own, n_loads) in (r, y, theta) of every node.

        Reactions are what the tyre exerts on the rim, zero where nothing is fixed.
        """
        D, free = self.dynamic_stiffness(omega), self.free
        f = self.to_cartesian @ loads.toarray()
        q = np.zeros(f.shape, complex)
        lu = splu(  # COLAMD, or more pivoting, fills up to 20 times more
            csc_array(D[free][:, free]), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01
        )
        q[free] = lu.solve(f[free].astype(complex))
        reaction = np.where(free[:, None], 0.0, -(D @ q))
        local = self.to_cartesian.T
        return (local @ q).reshape(*self.shape, -1), (local @ reaction).reshape(*self.shape, -1)


def _sum(matrices: FloatArray, dofs: IntArray, n: int) -> csc_array:
    """Element matrices (e, m, m) summed into (n, n)."""
    rows = np.broadcast_to(dofs[:, :, None], matrices.shape)
    columns = np.broadcast_to(dofs[:, None, :], matrices.shape)
    return coo_array((matrices.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n)).tocsc()


def _axes(theta: FloatArray) -> csc_array:
    """Block-diagonal matrix whose columns are e_r, e_y and e_theta of every node."""
    n = len(theta)
    axes = np.zeros((n, 3, 3))
    axes[:, :, 0] = np.stack([np.cos(theta), 0.0 * theta, np.sin(theta)], axis=1)
    axes[:, :, 1] = [0.0, 1.0, 0.0]
    axes[:, :, 2] = np.stack([-np.sin(theta), 0.0 * theta, np.cos(theta)], axis=1)
    return _sum(axes, np.arange(3 * n).reshape(n, 3), 3 * n)


def by_recursion(problem: RingProblem, omega: float) -> ComplexArray:
    """The recursion's own q: a line that it left to `cyclic` would prove nothing of it."""
    field = Recursive(problem).field(omega)
    assert field.remark == ""
    return field.q


def section_error(q: ComplexArray, expected: ComplexArray, n_face: int) -> float:
    """Largest error of any section, or of any cell's interior, under any load.

    q, expected: (n_cells, n_own, n_loads). The norm of a section's difference relative to the
    norm of that section's own displacement.
    """
    parts = [slice(0, n_face)] + ([slice(n_face, None)] if q.shape[1] > n_face else [])
    return float(max(np.max(_relative(q[:, part], expected[:, part])) for part in parts))


def _relative(q: ComplexArray, expected: ComplexArray) -> FloatArray:
    return np.linalg.norm(q - expected, axis=1) / np.linalg.norm(expected, axis=1)


def open_chain(cell: CellMatrices, data: ComplexArray, n_cells: int) -> ComplexArray:
    """Dense matrix of n_cells cells in a row, all dofs kept, from entries (nnz,) of one cell."""
    n_own, one = cell.n_own, cell.sparse(data).toarray()
    n = n_cells * n_own + cell.n_face
    D = np.zeros((n, n), one.dtype)
    for c in range(n_cells):
        here = slice(c * n_own, c * n_own + cell.n_dofs)
        D[here, here] += one
    return D


def clamped_frequencies(ring: Ring, n_cells: int) -> FloatArray:
    """Undamped natural omegas [rad/s] of n_cells cells in a row, both end sections held.

    n_cells = 1 gives the interior's, where the cell has one.
    """
    from scipy.linalg import eigh

    cell = ring.cell
    held = np.concatenate([np.tile(cell.fixed[: cell.n_own], n_cells), cell.fixed[: cell.n_face]])
    held[: cell.n_face] = held[-cell.n_face :] = True
    K, M = (
        open_chain(cell, data, n_cells)[np.ix_(~held, ~held)]
        for data in (sum(cell.K.values()), cell.M)
    )
    return np.sqrt(eigh(K, M, eigvals_only=True))


def ring_frequencies(ring: Ring) -> FloatArray:
    """Undamped natural omegas [rad/s] of a (small) ring, from the referee's matrices."""
    from scipy.linalg import eigh

    referee = ring.cartesian
    free = referee.free
    K, M = (A[free][:, free].toarray().real for A in (referee.K, referee.M))
    return np.sqrt(np.maximum(eigh(K, M, eigvals_only=True), 0.0))


def omegas(*hertz: float) -> Sequence[float]:
    """Angular frequencies [rad/s]."""
    return [2.0 * np.pi * f for f in hertz]
