"""What brought matrices say of themselves: mass, rigid motions, positive energies, density."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from tyrefrf.errors import MeshError
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.fem.rigid import rigid_motions
from tyrefrf.mesh.node_cell import NodeCell

STRAINLESS = 1e-6
"""|K u| over |K| |u| of a rigid motion up to which it is one: coordinates and entries of seven
digits leave about that."""

DENSITIES = (1.0, 1e5)
"""Mass over the volume that the tyre spans [kg/m3] that is a tyre's, with margin: rubber fills a
tenth to a third of that volume. A wrong unit is off by at least 1e3."""

POSITIVE = 1e-9  # of M's diagonal: what rounding may leave beyond |M_ij| <= sqrt(M_ii M_jj)


@dataclass(frozen=True, slots=True)
class Soundness:
    """What was found of one cell's matrices.

    mass: of the whole tyre [kg], along x, y and z. density: that over the volume that the tyre
    spans [kg/m3]. translation, rotation: largest |K u| over |K| |u| of the rigid motions, the rim
    free.
    """

    mass: tuple[float, float, float]
    density: float
    translation: float
    rotation: float

    def warnings(self) -> tuple[str, ...]:
        """What an engineer should know, though it may be meant so."""
        found = []
        if self.translation > STRAINLESS:
            found.append(
                f"rigid translations strain the cell (K u is {self.translation:.1e} of |K| |u|): "
                "K has springs to the ground, or rows that were held are gone from it"
            )
        elif self.rotation > STRAINLESS:
            found.append(
                f"rigid rotations strain the cell (K u is {self.rotation:.1e} of |K| |u|), though "
                "translations do not: K holds the stress of a loaded state, or the rows or "
                "directions belong to other nodes than `dofs` and `nodes` say"
            )
        if max(self.mass) - min(self.mass) > STRAINLESS * max(self.mass):
            found.append(
                "the mass is not the same along x, y and z: "
                + ", ".join(f"{mass:.6g}" for mass in self.mass)
                + " kg; rows that were held are gone from M"
            )
        return tuple(found)


def examined(cell: CellMatrices, nodes: NodeCell) -> Soundness:
    """What the matrices of a cell say of themselves.

    Raises MeshError for a mass that is none, and for one that is no tyre's in these units.
    """
    M = cell.sparse(cell.M)
    _check_mass(M)
    u = rigid_motions(nodes.points, nodes.numbers < 0)
    n_cells = round(2.0 * np.pi / nodes.sector_angle)
    mass = n_cells * np.einsum("nk,nk->k", u[:, :3], M @ u[:, :3])
    r, y, _ = nodes.points.T
    volume = np.pi * (r.max() ** 2 - r.min() ** 2) * np.ptp(y)
    density = float(mass[1] / volume) if volume > 0.0 else np.inf
    if not mass.min() > 0.0:
        raise MeshError(
            f"M gives a mass of {mass.min():.3g} kg to a rigid translation; are K and M exchanged?"
        )
    if not DENSITIES[0] <= density <= DENSITIES[1]:
        raise MeshError(
            f"the tyre's mass of {mass[1]:.3g} kg over the volume that it spans, from r = "
            f"{r.min():.3g} to {r.max():.3g} m and {np.ptp(y):.3g} m wide, is {density:.2g} kg/m3; "
            "is `units` that of the matrices and of the coordinates?"
        )
    K = cell.sparse(sum(cell.K.values(), start=np.zeros(len(cell.M))))
    lack = np.abs(K @ u).max(axis=0) / (abs(K) @ np.abs(u)).max(axis=0)
    return Soundness(
        mass=(float(mass[0]), float(mass[1]), float(mass[2])),
        density=density,
        translation=float(lack[:3].max()),
        rotation=float(lack[3:].max()),
    )


def _check_mass(M: csr_array) -> None:
    """Raise MeshError where M cannot be positive: |M_ij| <= sqrt(M_ii M_jj) must hold."""
    own = M.diagonal()
    coo = M.tocoo()
    bound = np.sqrt(np.maximum(own[coo.row], 0.0) * np.maximum(own[coo.col], 0.0))
    if own.min() < 0.0 or np.any(np.abs(coo.data) > bound + POSITIVE * own.max()):
        raise MeshError("M is no mass: some motion would have negative kinetic energy")
