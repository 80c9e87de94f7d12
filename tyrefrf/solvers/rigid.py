"""Rigid motions of a ring that neither the rim holds nor any stiffness resists.

In a rigid motion the cells of a ring move alike, but for the turn of their axes: z being three
translations and three rotations in the axes of the first cell, cell j moves by `own` T_j z.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.fem.frames import axes
from tyrefrf.fem.rigid import NAMES, rigid_motions
from tyrefrf.fem.soundness import STRAINLESS
from tyrefrf.solvers.orders import Orders

HELD = 1e-12
"""Mean square of a motion over the rim, relative to that of the motion that moves the rim most, up
to which the rim does not hold it: rounding."""
ONE_OF_THEM = 1e-6
"""How close to 1 the share of a named motion is that lies among those that cost nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class RigidMotions:
    """The k rigid motions z (6, k) of a ring that cost nothing at 0 Hz; none where it is held.

    own: (n_own, 6) the first cell's own dofs under each of the six. turns: (N, 6, 6) the T_j.
    inertia, damping: (n_own, 6) M and C of the ring times a rigid motion, likewise.
    """

    z: FloatArray
    own: FloatArray
    turns: FloatArray
    inertia: FloatArray
    damping: FloatArray

    @classmethod
    def of(cls, cell: CellMatrices, n_cells: int) -> RigidMotions:
        """Those of a ring of cells; springs to the ground within K hold it as a rim does."""
        motions = rigid_motions(cell.points, cell.of_no_node)
        own = motions[: cell.n_own]
        turns = np.kron(np.eye(2), axes(2.0 * np.pi * np.arange(n_cells) / n_cells))
        z = _off_the_rim(own[cell.fixed[: cell.n_own]], turns, float(cell.points[:, 0].max()))
        return cls(
            z=z[:, _costless(cell, n_cells, own, z)] if z.size else z,
            own=own,
            turns=turns,
            inertia=_of_ring(cell, cell.M, motions, turns[-1 % n_cells]),
            damping=_of_ring(cell, cell.C, motions, turns[-1 % n_cells]),
        )

    @property
    def count(self) -> int:
        """How many there are."""
        return int(self.z.shape[1])

    def moved(self, rows: ComplexArray | FloatArray, a: ComplexArray | FloatArray) -> ComplexArray:
        """Of the whole ring (N, n_own, m): rows T_j z a, for rows (n_own, 6) and a (k, m)."""
        return np.asarray(rows @ (self.turns @ (self.z @ a)), complex)

    def against(
        self, rows: ComplexArray | FloatArray, x: ComplexArray | FloatArray
    ) -> ComplexArray:
        """The sum over the cells of (rows T_j z)^T x_j (k, m); x (N, n_own, m)."""
        return self.z.T @ np.einsum("jba,jbm->am", self.turns, rows.T @ x)

    @property
    def words(self) -> str:
        """Which they are: "2 rigid motions (translation along y, rotation about y)"."""
        share = np.linalg.norm(np.linalg.qr(self.z)[0], axis=1)
        named = [
            name for name, of in zip(NAMES, share, strict=True) if abs(1.0 - of) <= ONE_OF_THEM
        ]
        rest = self.count - len(named)
        named += [f"{rest} that mix{'es' if rest == 1 else ''} them"] if rest else []
        return f"{self.count} rigid motion{'s' if self.count > 1 else ''} ({', '.join(named)})"


def _off_the_rim(on_rim: FloatArray, turns: FloatArray, radius: float) -> FloatArray:
    """(6, k) motions that move nothing on the rim, on_rim (m, 6) under each of the six.

    radius: [m] by which rotations compare with translations.
    """
    size = np.repeat([1.0, 1.0 / radius], 3)
    squares = size[:, None] * np.einsum("jab,ac,jcd->bd", turns, on_rim.T @ on_rim, turns) * size
    if not squares.any():
        return np.eye(6)
    value, vector = np.linalg.eigh(squares)
    return size[:, None] * vector[:, value <= HELD * value[-1]]


def _costless(cell: CellMatrices, n_cells: int, own: FloatArray, z: FloatArray) -> BoolArray:
    """(k,) whether no stiffness resists motions z (6, k)."""
    orders, free = Orders(cell), ~cell.fixed[: cell.n_own]
    folded = orders.folded(cell.static)
    force, size = np.zeros((2, z.shape[1]))
    for h, motion in enumerate(_by_order(z, n_cells)):
        A = orders.matrix(folded.at(2.0 * np.pi * h / n_cells))
        u = (own @ motion)[free]
        force = np.maximum(force, np.abs(np.asarray(A @ u)).max(axis=0))
        size = np.maximum(size, np.asarray(abs(A) @ np.abs(u)).max(axis=0))
    return force <= STRAINLESS * size


def _by_order(z: FloatArray, n_cells: int) -> list[ComplexArray | FloatArray]:
    """Motions z (6, k) as amplitudes (6, k) of the orders 0 and 1.

    What goes along the axle is of order 0. Across it v = (v_x, v_z) is, in the axes of cell j, the
    real part of (v_x - i v_z) (1, i) exp(i j alpha): of order 1, which with one or two cells is
    its own opposite, and with one is order 0.
    """
    along, across = z.copy(), np.zeros(z.shape, complex)
    along[[0, 2, 3, 5]] = 0.0
    for x in (0, 3):
        across[x] = z[x] - 1j * z[x + 2]
        across[x + 2] = 1j * across[x]
    if n_cells == 1:
        return [along + across.real]
    return [along, across.real if n_cells == 2 else across]


def _of_ring(
    cell: CellMatrices, entries: FloatArray, motions: FloatArray, back: FloatArray
) -> FloatArray:
    """(n_own, 6) the ring's matrix with these entries times each motion, in the first cell.

    motions: (n, 6) of the cell. back: (6, 6) takes a motion to the axes of the cell before.
    """
    forces = cell.sparse(entries) @ motions
    own = forces[: cell.n_own].copy()
    own[: cell.n_face] += forces[cell.n_own :] @ back
    return own
