"""How the stiffness of the cell's bricks of one material depends on frequency.

Where frequency only scales the elasticity it only scales the stiffness. Where it changes the
elasticity's form (plies of elastic cords in lossy rubber), the stiffness is a sum over the
elasticity's components of matrices that are assembled once: K(omega) = sum of C_ij(omega) K_ij.
The incompatible modes of `hex8i` are kept in these and condensed line by line.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray, IntArray
from tyrefrf.fem.constitutive import Constitutive
from tyrefrf.fem.elasticity import strain_rotation
from tyrefrf.fem.viscoelastic import Modulus

COMPONENTS = [(i, j) for i in range(4) for j in range(i, 4)] + [(4, 4), (4, 5), (5, 5)]
"""The components of an elasticity that is its own mirror image about the layer's plane."""


class Relaxation(Protocol):
    """The stiffness of one material at every frequency."""

    def stiffness(self, K: FloatArray, omega: float) -> ComplexArray:
        """Entries (nnz,) [N/m] at omega [rad/s]; K: entries (nnz,) of the reference stiffness."""
        ...


@dataclass(frozen=True, slots=True)
class Scaling:
    """The reference stiffness, scaled as the modulus is."""

    modulus: Modulus

    def stiffness(self, K: FloatArray, omega: float) -> ComplexArray:
        """K times E(omega)/E."""
        return self.modulus.scale(omega) * K


@dataclass(frozen=True, slots=True, eq=False)
class Reassembly:
    """The stiffness put together anew from components (k) of the elasticity.

    entries: (m,) entries of the cell's pattern that the bricks reach. K_uu: (k, m).
    K_um: (k, e, n, modes) and K_mm: (k, e, modes, modes) of the incompatible modes, in
    cylindrical dofs as K_uu. slot: (e, n, n) where each brick's entries stand in `entries`; empty
    without modes.
    """

    stuff: Constitutive
    entries: IntArray
    K_uu: FloatArray
    K_um: FloatArray
    K_mm: FloatArray
    slot: IntArray

    @classmethod
    def of(
        cls,
        stuff: Constitutive,
        B: FloatArray,
        dV: FloatArray,
        axes: FloatArray,
        T: FloatArray,
        slot: IntArray,
    ) -> Reassembly:
        """From the bricks' strain matrices about whatever shape they vibrate.

        B: (e, g, 6, n + modes) strains along x, y, z from Cartesian nodal dofs, then from the
        modes; dV: (e, g) [m3]. axes: (e, g, 3, 3) the layer's. T: (e, n, n) with q^P = T q^C.
        slot: (e, n, n) the entries of the cell's pattern.
        """
        n = slot.shape[1]
        B = strain_rotation(axes) @ B
        B[..., :n] = B[..., :n] @ T[:, None].transpose(0, 1, 3, 2)
        entries, local = np.unique(slot, return_inverse=True)
        local = local.reshape(slot.shape)
        K_uu = np.empty((len(COMPONENTS), len(entries)))
        K_um, K_mm = [], []
        for k, (i, j) in enumerate(COMPONENTS):
            A = np.einsum("ega,egb,eg->eab", B[:, :, i], B[:, :, j], dV, optimize=True)
            if i != j:
                A = A + A.transpose(0, 2, 1)
            K_uu[k] = np.bincount(local.ravel(), weights=A[:, :n, :n].ravel())
            K_um.append(A[:, :n, n:])
            K_mm.append(A[:, n:, n:])
        has_modes = B.shape[-1] > n
        return cls(
            stuff=stuff,
            entries=entries,
            K_uu=K_uu,
            K_um=np.array(K_um),
            K_mm=np.array(K_mm),
            slot=local.astype(np.int32) if has_modes else np.empty((0, n, n), np.int32),
        )

    def stiffness(self, K: FloatArray, omega: float) -> ComplexArray:
        """K_uu - K_um K_mm^-1 K_mu at this line, whatever the reference was."""
        C = self.stuff.elasticity(omega)
        c = np.array([C[i, j] for i, j in COMPONENTS])
        total = np.zeros(len(K), complex)
        total[self.entries] = _sum(c, self.K_uu) - self._of_modes(c)
        return total

    def _of_modes(self, c: ComplexArray) -> ComplexArray | float:
        """Entries (m,) of K_um K_mm^-1 K_mu; 0 without modes."""
        if not len(self.slot):
            return 0.0
        K_um, K_mm = _sum(c, self.K_um), _sum(c, self.K_mm)
        soft = K_um @ np.linalg.solve(K_mm, K_um.transpose(0, 2, 1))
        soft = ((soft + soft.transpose(0, 2, 1)) / 2.0).ravel()  # rounding in the symmetry
        slot = self.slot.ravel()
        return np.bincount(slot, weights=soft.real) + 1j * np.bincount(slot, weights=soft.imag)


def _sum(c: ComplexArray, parts: FloatArray) -> ComplexArray:
    """Sum over k of c_k parts_k, without a complex copy of the parts."""
    flat = parts.reshape(len(c), -1)
    return (c.real @ flat + 1j * (c.imag @ flat)).reshape(parts.shape[1:])
