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

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.fem.assembly import CellMatrices
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
    stated = None if at is None else _materials(cell, orders, at)
    found = []
    for one in modes:
        mu, phi, omega = 2.0 * np.pi * one.order / n_cells, one.shapes, one.omega
        energy = np.empty((2, len(cell.K), len(omega)))
        if stated is not None:
            energy[:] = [[_form(orders, K, mu, phi) for K in part] for part in stated]
        else:
            for j, w in enumerate(omega):
                own, shape = _materials(cell, orders, w), phi[:, [j]]
                energy[:, :, j] = [[_form(orders, K, mu, shape)[0] for K in part] for part in own]
        viscous = omega * _form(orders, C, mu, phi)
        found.append(_shared(omega, energy, viscous))
    return tuple(found)


def _materials(
    cell: CellMatrices, orders: Orders, omega: float
) -> tuple[list[Folded], list[Folded]]:
    """K' and K'' of every material at omega [rad/s], folded."""
    K = [cell.relaxation[name].stiffness(K, omega) for name, K in cell.K.items()]
    return [orders.folded(X.real) for X in K], [orders.folded(X.imag) for X in K]


def _form(orders: Orders, X: Folded, mu: float, phi: ComplexArray) -> FloatArray:
    """phi^H X phi of every column (m,), for a Hermitian X."""
    return np.einsum("nm,nm->m", phi.conj(), orders.matrix(X.at(mu)) @ phi).real


def _shared(omega: FloatArray, energy: FloatArray, viscous: FloatArray) -> ModalLoss:
    """From phi^H K'_m phi and phi^H K''_m phi (2, k, m), and omega phi^H C phi (m,)."""
    loss = energy[1].sum(axis=0) + viscous
    with np.errstate(invalid="ignore", divide="ignore"):
        stored = np.where(omega > 0.0, omega**2, np.nan)
        lost = np.where((omega > 0.0) & (loss > 0.0), loss, np.nan)
        return ModalLoss(
            loss_factor=loss / stored,
            energy_share=(energy[0] / stored).T,
            loss_share=(energy[1] / lost).T,
        )
