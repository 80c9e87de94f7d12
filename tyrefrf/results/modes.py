"""Natural modes of the ring by circumferential order: what they are, and how many."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray, IntArray, frozen
from tyrefrf.errors import ResultsError
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results.results import Provenance, StaticState

DIRECTIONS = ("r", "y", "theta")
WORDS = ("radial", "lateral", "circumferential")
"""What motion along r, y and theta is called."""
MAINLY = 0.6
"""Share of the kinetic energy from which on one direction names a mode."""


@dataclass(frozen=True, slots=True, eq=False)
class Modes:
    """The lowest modes of a ring of N cells, in ascending frequency; its arrays are read-only.

    frequency: (m,) [Hz]. order: (m,) h <= N/2: the number of nodal diameters modulo N, folded.
    members: (m,) 2 where h and N - h make a pair of equal frequency, else 1.
    loss_factor: (m,); NaN of a rigid motion, that stores nothing.
    diameters: (m,) the one of the aliases h, N - h, N + h, ... that the shape within the cell
        is closest to; with one brick of 8 nodes to the cell it cannot be told and is h.
    motion: (m, 3) shares of the kinetic energy along r, y and theta.
    energy_share, loss_share: (m, k) of the section's materials in strain energy and in loss.
    shape: (m, n, 3) displacement of the cell's own nodes along r, y and theta, for unit modal
        mass of the ring's cell [1/sqrt(kg)]; zero on the rim. Cell j moves with
        shape * exp(2 pi i h j / N), or any real part of that.
    residual: (m,) ||K phi - omega^2 M phi|| over ||(omega^2 + shift) M phi||.
    points: (n, 3) r [m], y [m], theta [rad] of the cell's own nodes, the section's first.
    cutoff: [Hz]; counted: (N // 2 + 1,) modes of every order below it, one member of each pair,
        by inertia (Sylvester): as many as there are here.
    moduli_at: [Hz] where the storage and loss moduli were taken; NaN: each mode's own frequency.
    inflation: the static state that the tyre vibrates about; None at rest.
    Raises ResultsError where the shapes of arrays do not agree, or modes are missing.
    """

    frequency: FloatArray
    order: IntArray
    members: IntArray
    loss_factor: FloatArray
    diameters: IntArray
    motion: FloatArray
    energy_share: FloatArray
    loss_share: FloatArray
    shape: ComplexArray
    residual: FloatArray
    points: FloatArray
    cutoff: float
    counted: IntArray
    moduli_at: float
    section: SectionMesh
    provenance: Provenance
    inflation: StaticState | None = None

    def __post_init__(self) -> None:
        m, n, k = len(self.frequency), len(self.points), len(self.section.materials)
        expected = {
            "frequency": (m,),
            "order": (m,),
            "members": (m,),
            "loss_factor": (m,),
            "diameters": (m,),
            "motion": (m, 3),
            "energy_share": (m, k),
            "loss_share": (m, k),
            "shape": (m, n, 3),
            "residual": (m,),
            "points": (n, 3),
            "counted": (self.provenance.n_cells // 2 + 1,),
        }
        for name, shape in expected.items():
            array = getattr(self, name)
            if array.shape != shape:
                raise ResultsError(f"{name} has shape {array.shape}; expected {shape}")
            frozen(array)
        if not np.array_equal(np.bincount(self.order, minlength=len(self.counted)), self.counted):
            raise ResultsError(f"the modes below {self.cutoff:.6g} Hz are not as many as counted")

    @property
    def n_modes(self) -> int:
        """How many modes there are, both members of every pair counted."""
        return int(self.members.sum())

    @property
    def section_shape(self) -> ComplexArray:
        """(m, n_section, 3) the shapes on the section's own nodes."""
        return self.shape[:, : self.section.n_nodes]

    @property
    def kind(self) -> tuple[str, ...]:
        """In words where most of each mode's kinetic energy is: `radial`, `radial-lateral`."""
        return tuple(map(_kind, self.motion))

    @property
    def aliases(self) -> tuple[str, ...]:
        """The nodal diameters that each mode's order stands for on this mesh: `3, 42, 48, ...`."""
        N = self.provenance.n_cells
        return tuple(
            ", ".join(str(n) for n in sorted({h, N - h, N + h} - {0})[:3]) + ", ..."
            if h
            else f"0, {N}, {2 * N}, ..."
            for h in self.order.tolist()
        )


def _kind(shares: FloatArray) -> str:
    """The name of the direction of most kinetic energy, or of the two that hold most."""
    first, second, _ = np.argsort(-shares)
    return WORDS[first] if shares[first] >= MAINLY else f"{WORDS[first]}-{WORDS[second]}"
