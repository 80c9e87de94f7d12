"""Input power is dissipated power.

A real unit force f puts in P = Re(f* v)/2 = -omega Im(f^T q)/2. Hysteretic loss takes omega/2 sum
over materials of eta_m q^H K_m q, viscous damping omega^2/2 q^H C q, both real.
"""

from __future__ import annotations

import numpy as np
import pytest
from rings import THETA, R, Y, lopsided, omegas, tyre

from tyrefrf.solvers import SOLVERS

ROUND_OFF = 1e-9


def dissipated(ring, q, omega):
    """Power [W] lost in the whole ring under every load."""
    cell = ring.cell
    q = np.concatenate([q, np.roll(q[:, : cell.n_face], -1, axis=0)], axis=1)
    A = 0.5 * omega**2 * cell.C
    for name, K in cell.K.items():
        A = A + 0.5 * omega * cell.relaxation[name].stiffness(K, omega).imag
    Aq = np.array([cell.sparse(A) @ of_cell for of_cell in q])
    return np.einsum("cal,cal->l", q.conj(), Aq)


@pytest.mark.parametrize("omega", omegas(3.0, 150.0, 2400.0))
@pytest.mark.parametrize("n_cells", [1, 2, 7])
@pytest.mark.parametrize("solver", SOLVERS)
def test_input_power_equals_dissipated_power(solver, n_cells, omega):
    ring = lopsided(tyre(n_cells=n_cells, elements_along=4, elements_around=max(2, 6 // n_cells)))
    loads = ring.point_loads((0, 4, R), (n_cells // 2, ring.mesh.n_face + 3, THETA), (0, 5, Y))

    field = SOLVERS[solver](ring.problem(loads)).field(omega)

    q = field.q
    f = loads.toarray().reshape(q.shape)
    P = -0.5 * omega * np.einsum("cal,cal->l", f, q).imag
    assert field.remark == ""
    assert np.all(P > 0.0)
    np.testing.assert_allclose(dissipated(ring, q, omega), P, rtol=ROUND_OFF)
