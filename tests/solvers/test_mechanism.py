"""A tyre that is held, and part of which is not: a block of tread that hangs by one edge.

Turning about that edge costs nothing, in every cell by itself, so at every order. At 0 Hz there is
no answer, wherever the load; above it there is, the one of the ring in Cartesian coordinates.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from extended import HAS_MORE_DIGITS, ExtendedRing
from rings import PAPER, THETA, R, Ring, Y, omegas, tyre

from tyrefrf.errors import SolveError
from tyrefrf.mesh.shapes import HEX8
from tyrefrf.results.proof import AMPLIFICATION
from tyrefrf.solvers import SOLVERS, solve_field, solve_line
from tyrefrf.solvers.modes import Pencils, ring_modes
from tyrefrf.solvers.reasons import loose

N = 6
extended = pytest.mark.skipif(not HAS_MORE_DIGITS, reason="longdouble is no more than double here")
BLOCK = np.array([8e-3, 0.0, 0.02])  # r [m], and theta [rad] beyond the edge


@cache
def hinged(eta: float) -> Ring:
    """A coarse tyre, two bricks around in a cell, with a brick more on an edge of the tread."""
    ring = tyre("hex8i", N, 6, 2, PAPER.model_copy(update={"eta": eta}))
    mesh = ring.mesh
    outer = mesh.planes[1][np.unique(mesh.section.outer)]
    edge = outer[np.argsort(np.abs(mesh.points[outer, 1]))[:2]]
    edge = edge[np.argsort(mesh.points[edge, 1])]
    new = np.flatnonzero(~((HEX8[:, 0] < 0.0) & (HEX8[:, 2] < 0.0)))
    points, brick = np.empty((len(new), 3)), np.empty(8, np.int64)
    for k, corner in enumerate(HEX8):
        at = edge[int(corner[1] > 0.0)]
        if k in new:
            place = int(np.flatnonzero(new == k)[0])
            points[place] = mesh.points[at] + BLOCK * (corner > 0.0)
            brick[k] = mesh.n_own + place
        else:
            brick[k] = at

    def moved(nodes):
        return np.where(nodes >= mesh.n_own, nodes + len(new), nodes)

    return replace(
        ring,
        mesh=replace(
            mesh,
            points=np.insert(mesh.points, mesh.n_own, points, axis=0),
            bricks=np.vstack([moved(mesh.bricks), brick]),
            material=np.append(mesh.material, 0),
            planes=moved(mesh.planes),
            rim=moved(mesh.rim),
        ),
    )


def loads(ring: Ring):
    """On the tyre, off the block."""
    return ring.point_loads((0, 3, R), (2, 5, THETA), (1, 4, Y))


def test_one_motion_of_every_order_costs_nothing():
    pencils = Pencils(hinged(0.1).cell, N)
    still = np.sqrt(1e-12 * pencils.of(0).scale)
    assert [pencil.count_below(still) for pencil in pencils] == [1, 1, 1, 1]
    assert hinged(0.1).problem(loads(hinged(0.1))).rigid.count == 0


@pytest.mark.parametrize("eta", [0.0, 0.1])
@pytest.mark.parametrize("solver", SOLVERS)
def test_at_0_hz_the_mechanism_is_named(solver, eta):
    """Damping does not hold it, and the loads do not see it: their own residual is rounding."""
    ring = hinged(eta)
    problem = ring.problem(loads(ring))
    with pytest.raises(SolveError) as refused:
        solve_line(problem, SOLVERS[solver](problem), 0.0)
    assert str(refused.value).startswith("0 Hz: no ")
    assert (
        "the tyre is a mechanism: motions of order 0 (1), 1 (1), 2 (1), 3 (1) cost nothing; "
        "add a loss factor, fix the rim, or move the line" in str(refused.value)
    )


def answer_or_error(problem, solver, omega):
    """A field and "", or None and what was said."""
    try:
        return solve_field(problem, SOLVERS[solver](problem), omega), ""
    except SolveError as error:
        return None, str(error)


@extended
@pytest.mark.parametrize("hertz", [1e-3, 0.03, 0.3, 3.0, 40.0, 400.0])
@pytest.mark.parametrize("solver", SOLVERS)
def test_above_0_hz_it_is_right_as_far_as_its_residual_says(solver, hertz):
    """The lower the line, the fewer digits: the loads' own residual stays at 1e-13 all the way."""
    ring = hinged(0.1)
    problem = ring.problem(loads(ring)[:, [0]])
    (omega,) = omegas(hertz)
    dof = int(loads(ring)[:, [0]].indices[0])
    field, _ = answer_or_error(problem, solver, omega)
    if field is None:
        assert hertz < 0.1
        return
    expected = ExtendedRing(ring).rounded().sections(omega, dof, range(N)).astype(complex)
    lack = np.linalg.norm(field.q[..., 0] - expected) / np.linalg.norm(expected)
    assert lack < AMPLIFICATION * field.residual
    assert hertz > 1e-3


def supported(eta: float, hertz: float) -> Ring:
    """The block on springs of the rubber's loss, so that it turns at about that frequency."""
    ring, cell = hinged(eta), hinged(eta).cell
    block = np.arange(3 * (ring.mesh.n_own - 6), 3 * ring.mesh.n_own)
    on = (cell.rows == cell.indices) & np.isin(cell.rows, block)
    springs = np.where(on, (2.0 * np.pi * hertz) ** 2 * cell.M[on].mean(), 0.0)
    held = replace(ring)
    held.__dict__["cell"] = replace(cell, K={"rubber": cell.K["rubber"] + springs})
    return held


@extended
@pytest.mark.parametrize("eta", [1e-3, 1e-2, 0.1])
@pytest.mark.parametrize("hertz", [0.5, 1.0, 2.0, 8.0, 30.0])
@pytest.mark.parametrize("solver", ["recursive", "cyclic"])
def test_a_soft_resonance_is_right_to_five_digits_or_says_so(solver, hertz, eta):
    """Damped, on its own frequency, and all but unexcited: the residual is rounding."""
    ring = supported(eta, hertz)
    (found,) = (m.omega[0] for m in ring_modes(ring.cell, N, count=1) if len(m.omega))
    problem = ring.problem(loads(ring)[:, [0]])
    field, error = answer_or_error(problem, solver, found)
    if field is None:
        assert hertz * eta < 0.06
        assert " resonance" in error
        return
    dof = int(loads(ring)[:, [0]].indices[0])
    expected = ExtendedRing(ring).rounded().sections(found, dof, range(N)).astype(complex)
    lack = np.linalg.norm(field.q[..., 0] - expected) / np.linalg.norm(expected)
    assert lack < max(AMPLIFICATION * field.residual, 1e-5)


def test_check_is_told_of_it_and_of_a_free_tyre():
    ring = hinged(0.1)
    (warning,) = loose(ring.problem(loads(ring)))
    assert warning == (
        "the tyre is a mechanism: motions of order 0 (1), 1 (1), 2 (1), 3 (1) cost nothing; a "
        "line at 0 Hz has no answer"
    )
    free = tyre("hex8i", N, 4).with_free_rim()
    (warning,) = loose(free.problem(free.point_loads((0, 3, R))))
    assert warning.startswith("nothing holds the tyre: 6 rigid motions (translation along x, ")
    held = tyre("hex8i", N, 4)
    assert loose(held.problem(held.point_loads((0, 3, R)))) == ()


@pytest.mark.parametrize("element", ["hex8i", "hex8", "hex20", "hex20r"])
@pytest.mark.parametrize("n_cells", [1, 3, 6])
def test_no_brick_brings_a_mechanism_of_its_own_into_a_ring(element, n_cells):
    """A single reduced hex20 has spurious modes without energy; in a ring none is left."""
    ring = tyre(element, n_cells, 4, -(-3 // n_cells)).with_free_rim()
    pencils = Pencils(ring.cell, n_cells)
    still = np.sqrt(1e-12 * pencils.of(0).scale)
    rigid = {0: 6} if n_cells == 1 else {0: 2, 1: 2}
    counts = {pencil.order: pencil.count_below(still) for pencil in pencils}
    assert {h: count for h, count in counts.items() if count} == rigid
