"""Properties of every damped ring, over drawn materials, angles and frequencies."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rings import THETA, R, Y, by_recursion, lopsided, section_error, tyre

from tyrefrf.case import Isotropic
from tyrefrf.solvers import Recursive, solve_line

ROUND_OFF = 1e-9

stuffs = st.builds(
    lambda logE, nu, rho, eta: Isotropic(E=10.0**logE, nu=nu, rho=rho, eta=eta),
    st.floats(6.0, 11.0),
    st.floats(0.0, 0.49),
    st.floats(800.0, 8000.0),
    st.floats(0.01, 0.5),
)


@st.composite
def rings(draw):
    """Tiny tyres of 1 to 12 cells, mirrored or lopsided."""
    n_cells = draw(st.integers(1, 12))
    around = max(2, -(-6 // n_cells))
    stuff = draw(stuffs)
    ring = tyre(n_cells=n_cells, elements_along=4, elements_around=around, stuff=stuff)
    return lopsided(ring, draw(st.integers(0, 99))) if draw(st.booleans()) else ring


frequencies = st.one_of(st.just(0.0), st.floats(1.0, 3000.0)).map(lambda f: 2.0 * np.pi * f)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(rings(), frequencies, st.integers(0, 11))
def test_reciprocal_passive_and_independent_of_the_cut(ring, omega, turn):
    inside = ring.mesh.n_face
    places = [
        (0, 3, R),
        (0, inside + 4, THETA),
        (ring.n_cells // 2, 5, Y),
        (ring.n_cells - 1, 6, R),
    ]
    turned = [(section + turn, node, direction) for section, node, direction in places]
    here, there = (ring.problem(ring.point_loads(*p)) for p in (places, turned))

    line = solve_line(here, Recursive(here), omega)
    q, q_turned = (by_recursion(problem, omega) for problem in (here, there))

    H = line.receptance
    drive = np.sqrt(np.abs(np.outer(np.diag(H), np.diag(H))))
    assert line.residual < ROUND_OFF
    assert np.all(np.abs(H - H.T) <= 1e-10 * drive)
    assert np.all((1j * omega * np.diag(H)).real >= -1e-10 * omega * np.abs(np.diag(H)))
    assert section_error(q_turned, np.roll(q, turn, axis=0), ring.cell.n_face) < ROUND_OFF


@settings(max_examples=15, deadline=None, derandomize=True)
@given(stuffs, frequencies.filter(bool), st.floats(0.1, 10.0))
def test_scaling_stiffness_and_mass_together_scales_the_answer(stuff, omega, factor):
    """K and M times a factor: H divided by it."""
    scaled = stuff.model_copy(update={"E": factor * stuff.E, "rho": factor * stuff.rho})
    first, second = (tyre(n_cells=6, elements_along=4, stuff=s) for s in (stuff, scaled))
    load = first.point_loads((1, 4, R))

    H, H_scaled = (by_recursion(ring.problem(load), omega) for ring in (first, second))

    assert factor * np.linalg.norm(H_scaled) == pytest.approx(np.linalg.norm(H), rel=1e-8)
