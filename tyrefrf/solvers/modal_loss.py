"""Loss factors of natural modes by the strain energy method, and where the loss comes from.

eta_k = sum over materials of phi^H K''_m phi / omega_k^2 + omega_k phi^H C phi / omega_k^2, for
phi^H M phi = 1: what a cycle dissipates over 2 pi times the energy stored. First order in the
loss: the modes are those of the loss-free tyre.
Source: Johnson and Kienholz, Finite element prediction of damping in structures with constrained
viscoelastic layers, AIAA J. 20 (1982), 1284-1290.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.fem.relaxation import Relaxation, Scaling
from tyrefrf.solvers.modes import OrderModes
from tyrefrf.solvers.orders import Folded, Orders


@dataclass(frozen=True, slots=True, eq=False)
class ModalLoss:
    """Loss of m modes of a tyre of k materials.

    loss_factor: (m,). energy_share: (m, k) of the mode's stiffness that is a material's, the rest
    is the inflation's. loss_share: (m, k) of the loss, the rest is viscous. NaN where a rigid
    motion stores nothing; shares of no loss at all are NaN too.
    """

    loss_factor: FloatArray
    energy_share: FloatArray
    loss_share: FloatArray


def modal_loss(
    cell: CellMatrices, n_cells: int, modes: Sequence[OrderModes], at: float | None
) -> tuple[ModalLoss, ...]:
    """The loss of the modes of every order.

    at: omega [rad/s] at which the materials' moduli are taken; None: at each mode's own.
    """
    orders = Orders(cell)
    C = orders.folded(cell.C)
    K = [_Material(cell.relaxation[name], K, orders) for name, K in cell.K.items()]
    found = []
    for one in modes:
        mu, phi = 2.0 * np.pi * one.order / n_cells, one.shapes
        moduli_at = one.omega if at is None else np.full(len(one.omega), at)
        energy = np.stack([material.energy(mu, phi, moduli_at) for material in K], axis=1)
        found.append(_shared(one.omega, energy, one.omega * _form(orders, C, mu, phi)))
    return tuple(found)


class _Material:
    """The stiffness of one material."""

    def __init__(self, relaxation: Relaxation, K: FloatArray, orders: Orders) -> None:
        self._relaxation, self._K, self._orders = relaxation, K, orders

    @cached_property
    def _reference(self) -> Folded:
        """Its reference stiffness, which is all that is needed where frequency only scales it."""
        return self._orders.folded(self._K)

    def energy(self, mu: float, phi: ComplexArray, omega: FloatArray) -> FloatArray:
        """phi^H K' phi and phi^H K'' phi (2, m) of shapes (n, m), each at its omega (m,)."""
        relaxation, orders = self._relaxation, self._orders
        if isinstance(relaxation, Scaling):
            scale = np.array([relaxation.modulus.scale(w) for w in omega], complex)
            return np.stack([scale.real, scale.imag]) * _form(orders, self._reference, mu, phi)
        found = np.empty((2, len(omega)))
        for w in np.unique(omega):
            here = omega == w
            K = relaxation.stiffness(self._K, w)
            for part, X in zip(found, (K.real, K.imag), strict=True):
                part[here] = _form(orders, orders.folded(X), mu, phi[:, here])
        return found


def _form(orders: Orders, X: Folded, mu: float, phi: ComplexArray) -> FloatArray:
    """phi^H X phi of every column (m,), for a Hermitian X."""
    return np.einsum("nm,nm->m", phi.conj(), orders.matrix(X.at(mu)) @ phi).real


def _shared(omega: FloatArray, energy: FloatArray, viscous: FloatArray) -> ModalLoss:
    """From phi^H K'_m phi and phi^H K''_m phi (2, k, m), and omega phi^H C phi (m,)."""
    loss = energy[1].sum(axis=0) + viscous
    stored = np.where(omega > 0.0, omega**2, np.nan)
    lost = np.where((omega > 0.0) & (loss > 0.0), loss, np.nan)
    return ModalLoss(
        loss_factor=loss / stored,
        energy_share=(energy[0] / stored).T,
        loss_share=(energy[1] / lost).T,
    )
