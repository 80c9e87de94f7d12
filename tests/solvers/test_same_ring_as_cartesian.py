"""Every solver x element x cell count against the whole ring assembled in Cartesian coordinates.

The rings are coarse, the cells either their own mirror images or lopsided with interior nodes;
loads and probes stand in several sections, inside cells, and on the rim.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from rings import Ring, lopsided, omegas, section_error, tyre
from scipy.sparse import hstack

from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.solvers import SOLVERS, solve_line

ROUND_OFF = 1e-9  # condition 1e6 x eps, with margin: section 2 of the design
RESIDUAL = 1e-9
LINES = omegas(0.0, 230.0, 1700.0)
N_CELLS = [1, 2, 3, 7, 45, 60, 64]


@cache
def coarse(element: str, n_cells: int, mirrored: bool) -> Ring:
    least = -(-3 // n_cells)  # elements around, for the ring to have a volume
    if mirrored:
        return tyre(element, n_cells, elements_along=4, elements_around=least)
    return lopsided(tyre(element, n_cells, elements_along=4, elements_around=max(2, 2 * least - 1)))


def loads(ring: Ring):
    """At one section; spread over sections and an interior; inside two cells (if any inside)."""
    rng = np.random.default_rng(7)
    N, own, free = ring.n_cells, ring.mesh.n_own, ring.cartesian.free.reshape(ring.n_cells, -1)
    inside = np.flatnonzero(free[0])[-6:]  # an interior's dofs, or the last ones of a section
    somewhere = rng.choice(np.flatnonzero(free.ravel()), size=5, replace=False)
    return ring.columns(
        {int(np.flatnonzero(free[0])[4]): 1.0},
        {int(row): w for row, w in zip(somewhere, rng.normal(size=5), strict=True)},
        {
            int(3 * own * (c % N) + d): float(w)
            for c in (N - 1, N // 3)
            for d, w in zip(inside, rng.normal(size=6), strict=True)
        },
    )


def probes(ring: Ring):
    """The loads' own places, and reactions at the rim."""
    rim = np.flatnonzero(~ring.cartesian.free)
    reactions = ring.columns({int(rim[1]): 1.0}, {int(rim[-1]): 0.5, int(rim[len(rim) // 2]): 2.0})
    return hstack([loads(ring), reactions], format="csc")


@cache
def truth(element: str, n_cells: int, mirrored: bool):
    ring = coarse(element, n_cells, mirrored)
    return [ring.cartesian.solve(omega, loads(ring)) for omega in LINES]


@pytest.mark.parametrize("mirrored", [True, False], ids=["mirrored", "lopsided"])
@pytest.mark.parametrize("n_cells", N_CELLS)
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("solver", SOLVERS)
def test_same_ring_as_cartesian(solver, element, n_cells, mirrored):
    ring = coarse(element, n_cells, mirrored)
    problem = ring.problem(loads(ring), probes(ring))
    expected = [q for q, _ in truth(element, n_cells, mirrored)]

    built = SOLVERS[solver](problem)
    fields = [built.field(omega) for omega in LINES]

    assert {field.remark for field in fields} == {""}  # the recursion left no line to `cyclic`
    for field, q in zip(fields, expected, strict=True):
        assert section_error(field.q, q, ring.cell.n_face) < ROUND_OFF


@pytest.mark.parametrize("mirrored", [True, False], ids=["mirrored", "lopsided"])
@pytest.mark.parametrize("n_cells", [1, 3, 45])
@pytest.mark.parametrize("solver", SOLVERS)
def test_probes_read_displacements_and_blocked_forces(solver, n_cells, mirrored):
    ring = coarse("hex8i", n_cells, mirrored)
    problem = ring.problem(loads(ring), probes(ring))
    built = SOLVERS[solver](problem)

    lines = [solve_line(problem, built, omega) for omega in LINES]

    for line, (q, reaction) in zip(lines, truth("hex8i", n_cells, mirrored), strict=True):
        expected = problem.probes.T @ (q + reaction).reshape(problem.n_ring_dofs, -1)
        largest = np.abs(expected).max(axis=1, keepdims=True)  # of one probe, any load
        np.testing.assert_array_less(np.abs(line.receptance - expected) / largest, ROUND_OFF)
        assert line.residual < RESIDUAL
        assert line.remark == ""
