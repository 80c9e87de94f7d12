"""A sensor's mass, added to computed responses, against a ring that has it in its matrices.

The referee's ring is assembled in Cartesian coordinates, with the mass on the diagonal of M at one
node: such a ring is not periodic, and knows nothing of how sensors are treated here.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rings import THETA, CartesianRing, R, Y, lossless, omegas, ring_frequencies, tyre
from scipy.sparse import csc_array, dia_array, hstack

from tyrefrf.solvers import SOLVERS, Sensors, answer, solve_line

ERROR = 1e-9  # two solvers, relative to the load's largest response
ROUND_OFF = 1e-12  # the same numbers on two ways through one solver
LINES = omegas(30.0, 160.0, 900.0)
RING = tyre(n_cells=7, elements_along=8)
CROWN, SIDE, LOADED = (0, 9), (3, 5), (5, 11)  # section and node; none on the rim
LOADS = RING.point_loads((*LOADED, R), (*CROWN, R))
PLACES = ((*CROWN, R), (*SIDE, Y), (*LOADED, R), (*LOADED, THETA))
PROBES = RING.point_loads(*PLACES)
MASSES = (0.05, 0.3)  # of a ring of some 6 kg


def sensed(ring, masses, probe, places, together=False, loads=LOADS):
    """The ring with a sensor at each of the places (section, node)."""
    columns = hstack([ring.point_loads(*((*at, k) for k in (R, Y, THETA))) for at in places])
    problem = ring.problem(
        csc_array(hstack([loads, columns])), csc_array(hstack([PROBES, columns]))
    )
    return replace(problem, sensors=Sensors(np.array(masses), np.array(probe), together))


def truth(ring, omega, masses, places):
    """(p, l) of a ring with the masses in its matrix."""
    referee = CartesianRing(ring)
    added = np.zeros(ring.n_dofs)
    for mass, (section, node) in zip(masses, places, strict=True):
        added[[ring.dof(section, node, k) for k in (R, Y, THETA)]] += mass
    referee.M = csc_array(referee.M + dia_array((added[None], [0]), shape=referee.M.shape))
    q, _ = referee.solve(omega, LOADS)
    return PROBES.T @ q.reshape(ring.n_dofs, -1)


def by(name, problem, omega):
    return solve_line(problem, SOLVERS[name](problem), omega).receptance


@pytest.mark.parametrize("omega", LINES)
@pytest.mark.parametrize("name", SOLVERS)
def test_sensors_together_answer_as_the_ring_that_has_their_masses(name, omega):
    H = by(name, sensed(RING, MASSES, (0, 1), (CROWN, SIDE), together=True), omega)
    expected = truth(RING, omega, MASSES, (CROWN, SIDE))
    assert np.max(np.abs(H - expected) / np.abs(expected).max(axis=0)) < ERROR


@pytest.mark.parametrize("omega", LINES)
def test_a_roving_sensor_is_seen_by_its_own_probe_and_by_no_other(omega):
    H = by("recursive", sensed(RING, MASSES, (0, 1), (CROWN, SIDE)), omega)
    without = truth(RING, omega, (), ())
    expected = without.copy()
    expected[0] = truth(RING, omega, MASSES[:1], (CROWN,))[0]
    expected[1] = truth(RING, omega, MASSES[1:], (SIDE,))[1]
    assert np.max(np.abs(H - expected) / np.abs(expected).max(axis=0)) < ERROR
    assert np.abs(expected - without)[:2].max() > 1e-3 * np.abs(without).max()


@pytest.mark.parametrize("omega", LINES)
def test_reciprocity_and_passivity_stay(omega):
    problem = sensed(RING, MASSES, (0, 1), (CROWN, SIDE), together=True)
    H = by("cyclic", problem, omega)[[2, 0]]  # at the loads' own points
    assert abs(H[0, 1] - H[1, 0]) < ROUND_OFF * np.abs(H).max()
    assert np.linalg.eigvalsh(1j * omega * H + (1j * omega * H).conj().T)[0] > 0.0


def test_no_mass_changes_nothing_and_little_mass_as_much_as_it_is():
    omega = LINES[1]
    without = truth(RING, omega, (), ())[0]
    changes = [
        by("cyclic", sensed(RING, (mass,), (0,), (CROWN,)), omega)[0] - without
        for mass in (1e-6, 2e-6)
    ]
    assert np.abs(changes).max() < 1e-4 * np.abs(without).max()
    np.testing.assert_allclose(changes[1], 2.0 * changes[0], rtol=1e-4)  # to first order in m


def test_an_endless_mass_holds_its_place():
    H = by("cyclic", sensed(RING, (1e9,), (0,), (CROWN,)), LINES[1])
    assert np.abs(H[0]).max() < 1e-9 * np.abs(H[2]).max()


def test_at_0_hz_a_mass_says_nothing():
    problem = sensed(RING, MASSES, (0, 1), (CROWN, SIDE), together=True)
    expected = truth(RING, 0.0, (), ())
    np.testing.assert_allclose(by("cyclic", problem, 0.0), expected, rtol=ERROR, atol=1e-15)


def test_a_mass_that_resonates_undamped_on_the_line_has_no_answer():
    ring = lossless(RING)
    omega = 0.7 * ring_frequencies(ring)[0]  # below the first resonance: C is a spring's
    columns = ring.point_loads(*((*CROWN, k) for k in (R, Y, THETA)))
    problem = ring.problem(columns)
    C = solve_line(problem, SOLVERS["direct"](problem), omega).receptance.real
    mass = 1.0 / (omega**2 * np.linalg.eigvalsh(C)[-1])
    problem = sensed(ring, (mass,), (0,), (CROWN,))
    line = answer(problem, SOLVERS["direct"](problem), omega)
    assert np.isnan(line.receptance).all()
    assert line.receptance.shape == (4, 2)
    assert "with a sensor's mass the tyre resonates undamped" in line.remark
    assert line.remark.startswith(f"{omega / (2 * np.pi):.6g} Hz: ")
