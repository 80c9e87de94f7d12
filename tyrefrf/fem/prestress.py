"""Bricks under stress: geometric stiffness, and finite strains about the shape at rest.

Total Lagrangian: F = I + G with G = du/dX, Green-Lagrange strain E = (F^T F - I)/2 =
(G + G^T + G^T G)/2, second Piola-Kirchhoff stress S = C : E (St. Venant-Kirchhoff), all integrals
over the shape at rest.
Source: Bonet & Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, chapters 4-9.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tyrefrf.arrays import FloatArray
from tyrefrf.fem.elasticity import VOIGT
from tyrefrf.fem.elements import energy

TENSOR = VOIGT.transpose(1, 2, 0)
"""Stress tensor S_ij = TENSOR[i, j, v] S_v: each shear stress stands twice, as in the tensor."""


def geometric_stiffness(H: FloatArray, S: FloatArray, dV: FloatArray) -> FloatArray:
    """K_G (e, 3a, 3a) [N/m]: the sum over g of (du_i/dX_j) S_jm (du_i/dX_m) dV.

    H: (e, g, 3, 3, 3a) displacement gradient; S: (e, g, 6) stress [Pa]; dV: (e, g) [m3].
    """
    weighted = np.einsum("jmv,egv,egimn->egijn", TENSOR, S, H, optimize=True)
    flat = (len(H), -1, H.shape[-1])
    return np.matmul(
        H.reshape(flat).transpose(0, 2, 1), (weighted * dV[..., None, None, None]).reshape(flat)
    )


@dataclass(frozen=True, slots=True, eq=False)
class Deformed:
    """Bricks of one elasticity C at a deformed state: stress, and what the tangent needs.

    B: (e, g, 6, 3a) dE = B du [1/m]; S: (e, g, 6) [Pa]; H, dV as in `geometric_stiffness`.
    J: (e, g) det F, volume over that at rest; not positive where a brick is inside out, which
        the strains alone do not tell: E, and so the energy, is the same for F and -F.
    """

    B: FloatArray
    S: FloatArray
    H: FloatArray
    dV: FloatArray
    J: FloatArray

    @classmethod
    def at(cls, H: FloatArray, dV: FloatArray, C: FloatArray, u: FloatArray) -> Deformed:
        """The state under displacements u (e, 3a) [m]; C: (6, 6) or (e, g, 6, 6) [Pa]."""
        G = np.einsum("egijn,en->egij", H, u, optimize=True)
        E = np.einsum("vij,egij->egv", VOIGT, G)  # F^T F - I would round to 1e-16, however small
        E += np.einsum("vkl,egik,egil->egv", VOIGT, G, G, optimize=True) / 2.0
        F = np.eye(3) + G
        B = np.einsum("vkl,egik,egiln->egvn", VOIGT, F, H, optimize=True)
        return cls(B, np.einsum("...vw,...w->...v", C, E), H, dV, np.linalg.det(F))

    def forces(self) -> FloatArray:
        """Inner forces (e, 3a) [N]."""
        return np.einsum("egvn,egv,eg->en", self.B, self.S, self.dV, optimize=True)

    def material_stiffness(self, C: FloatArray) -> FloatArray:
        """Sum over g of B^T C B dV (e, 3a, 3a) [N/m]: the initial-displacement stiffness."""
        return energy(self.B, C, self.B, self.dV)

    def geometric_stiffness(self) -> FloatArray:
        """K_G (e, 3a, 3a) [N/m] of the stress S."""
        return geometric_stiffness(self.H, self.S, self.dV)
