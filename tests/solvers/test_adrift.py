"""A tyre that nothing holds: no answer at 0 Hz, and the right one at any line above.

The whole tyre has one loss factor and Rayleigh's damping, so the referee is the sum over the modes
of the ring in Cartesian coordinates, its rigid motions taken from the nodes' coordinates:

    q = R (R^T M R)^-1 R^T f / (i omega alpha - omega^2)
        + sum of phi phi^T f / (omega_r^2 (1 + i eta + i omega beta) + i omega alpha - omega^2).
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from rings import PAPER, THETA, UNDAMPED, R, Ring, Y, lopsided, tyre
from scipy.linalg import eigh

from tyrefrf.case import Damping, Solver
from tyrefrf.errors import SolveError
from tyrefrf.solvers import SOLVERS, prepare, solve_field, solve_line
from tyrefrf.solvers.adrift import parted
from tyrefrf.solvers.rigid import RigidMotions

HZ = 2.0 * np.pi
LINES = [1e-4, 1e-3, 0.01, 0.1, 1.0, 10.0, 300.0]
SAME = 1e-9
EXACT = list(SOLVERS)


@cache
def free(n_cells: int = 5, eta: float = 0.1, alpha: float = 0.0, beta: float = 0.0) -> Ring:
    least = -(-3 // n_cells)
    stuff = PAPER.model_copy(update={"eta": eta})
    damping = Damping(alpha=alpha, beta=beta) if alpha or beta else UNDAMPED
    ring = tyre("hex8i", n_cells, 4, least, stuff, damping)
    return ring.with_free_rim()


def rigid_by_coordinates(ring: Ring) -> np.ndarray:
    """(n, 6) rigid motions of all nodes of the ring, in their r, y and theta."""
    own, cells = ring.mesh.points[: ring.mesh.n_own], np.arange(ring.n_cells)
    theta = (own[:, 2] + cells[:, None] * ring.mesh.sector_angle).ravel()
    r, y = (np.tile(own[:, k], ring.n_cells) for k in (0, 1))
    x = np.stack([r * np.cos(theta), y, r * np.sin(theta)], axis=1)
    still = [np.broadcast_to(axis, x.shape) for axis in np.eye(3)]
    spun = [np.cross(axis, x) for axis in np.eye(3)]
    return ring.to_cartesian.T @ np.array([motion.ravel() for motion in still + spun]).T


@cache
def modes(*key):
    """omega_r^2 and phi of all but the six rigid motions, R, and M, in r, y and theta."""
    ring = free(*key)
    T = ring.to_cartesian
    K, M = ((T.T @ A @ T).toarray().real for A in (ring.cartesian.K, ring.cartesian.M))
    squared, phi = eigh(K, M)
    return squared[6:], phi[:, 6:], rigid_by_coordinates(ring), M


def truth(omega: float, *key) -> np.ndarray:
    """Displacements of the whole ring under its loads."""
    ring, (squared, phi, body, M) = free(*key), modes(*key)
    f = loads(ring).toarray()
    eta = next(iter(ring.materials.values())).eta
    drag = 1j * omega * ring.damping.alpha - omega**2
    stiffness = squared * (1.0 + 1j * eta + 1j * omega * ring.damping.beta)
    rigid = body @ np.linalg.solve(body.T @ M @ body, body.T @ f) / drag
    return rigid + phi @ ((phi.T @ f) / (stiffness + drag)[:, None])


def loads(ring: Ring):
    """A point force, forces that balance around the ring, and two that balance by chance."""
    N = ring.n_cells
    return ring.columns(
        {ring.dof(0, 3, R): 1.0},
        {ring.dof(c, 3, R): 1.0 for c in range(N)},
        {ring.dof(0, 3, Y): 1.0, ring.dof(0, 7, Y): -1.0, ring.dof(1, 5, THETA): 1.0},
    )


def assert_right(q, expected, omega):
    """Load by load, up to what a force of 1e-15 N, rounding of the loads' sum, does to 1 kg."""
    lack = np.abs(q.reshape(expected.shape) - expected).max(axis=0)
    bound = SAME * np.abs(expected).max(axis=0) + 1e-15 / omega**2
    np.testing.assert_array_less(lack, bound)


@pytest.mark.parametrize("hertz", LINES)
@pytest.mark.parametrize(
    "losses", [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 5.0, 1e-5), (0.1, 5.0, 0.0)]
)
@pytest.mark.parametrize("solver", EXACT)
def test_every_line_above_zero_is_right(solver, losses, hertz):
    ring = free(5, *losses)
    problem = ring.problem(loads(ring))
    field = solve_field(problem, SOLVERS[solver](problem), HZ * hertz)
    assert_right(field.q, truth(HZ * hertz, 5, *losses), HZ * hertz)
    assert field.residual < 1e-8


@pytest.mark.parametrize("n_cells", [1, 2, 3, 12])
def test_every_number_of_cells(n_cells):
    ring = free(n_cells)
    problem = ring.problem(loads(ring))
    field = solve_field(problem, SOLVERS["cyclic"](problem), HZ * 0.01)
    assert_right(field.q, truth(HZ * 0.01, n_cells), HZ * 0.01)


@pytest.mark.parametrize("hertz", [1e-3, 0.1, 10.0])
def test_modes_superposed_have_the_right_rigid_motions(hertz):
    ring = free()
    problem = ring.problem(loads(ring))
    solver = prepare(problem, Solver(name="modal", modes=10_000_000))()
    field = solve_field(problem, solver, HZ * hertz)
    assert_right(field.q, truth(HZ * hertz), HZ * hertz)


@pytest.mark.parametrize("solver", EXACT)
@pytest.mark.parametrize("hertz", [1e-3, 0.01])
def test_mass_line(hertz, solver):
    """Pushed along the axle all over, the tyre moves by F / (-omega^2 m) and not otherwise."""
    ring = free(12, 0.0)
    n = 12 * ring.mesh.n_own
    everywhere = ring.columns({ring.dof(c, k, Y): 1.0 for c in range(12) for k in range(n // 12)})
    problem = ring.problem(everywhere)
    mass = 12 * ring.cell.sparse(ring.cell.M).toarray()[Y::3, Y::3].sum()
    line = solve_line(problem, SOLVERS[solver](problem), HZ * hertz)
    expected = -(n**2) / ((HZ * hertz) ** 2 * mass)
    assert line.receptance[0, 0] == pytest.approx(expected, rel=1e-7)  # (omega/omega_1)^2
    assert line.remark.startswith("nothing holds the tyre: rigid motions by momentum")


@pytest.mark.parametrize("eta", [0.0, 0.1])
@pytest.mark.parametrize("solver", [*EXACT, "modal"])
def test_at_0_hz_no_solver_answers_whatever_the_load(solver, eta):
    """Forces that balance have an elastic answer, but where the tyre comes to stand is open."""
    ring = free(5, eta)
    problem = ring.problem(loads(ring)[:, [1]])
    built = prepare(problem, Solver(name=solver))()
    with pytest.raises(SolveError) as refused:
        solve_line(problem, built, 0.0)
    assert str(refused.value) == (
        "0 Hz: nothing holds the tyre: 6 rigid motions (translation along x, translation along y, "
        "translation along z, rotation about x, rotation about y, rotation about z) cost nothing; "
        "fix the rim, or leave this line out"
    )


def held_at(ring: Ring, *nodes: int) -> Ring:
    """Held at some nodes of each section alone."""
    rim = np.concatenate([np.array(nodes) + start for start in (0, ring.mesh.n_own)])
    return replace(ring, mesh=replace(ring.mesh, rim=rim))


def test_one_node_of_a_whole_tyre_leaves_three_rotations():
    """The tyre in one cell: its section is there once, and so is the node."""
    assert RigidMotions.of(held_at(free(1), 2).cell, 1).count == 3


def test_two_nodes_leave_the_rotation_about_the_line_through_them():
    ring = free(2)
    middle = int(np.flatnonzero(np.abs(ring.mesh.points[: ring.mesh.n_face, 1]) < 1e-12)[0])
    motions = RigidMotions.of(held_at(ring, middle).cell, 2)
    assert motions.words == "1 rigid motion (rotation about x)"
    off_centre = RigidMotions.of(held_at(ring, 2).cell, 2)
    assert off_centre.words == "1 rigid motion (1 that mixes them)"


@pytest.mark.parametrize("n_cells", [3, 5, 12])
def test_a_circle_of_nodes_is_no_hinge(n_cells):
    assert RigidMotions.of(held_at(free(n_cells), 2).cell, n_cells).count == 0


@pytest.mark.parametrize("solver", EXACT)
def test_a_tyre_on_a_line_turns_about_it(solver):
    """At 0.01 Hz, with moment M about the line: angle M / (-omega^2 I)."""
    ring = free(2, 0.0)
    middle = int(np.flatnonzero(np.abs(ring.mesh.points[: ring.mesh.n_face, 1]) < 1e-12)[0])
    ring = held_at(ring, middle)
    node = int(np.argmax(np.abs(ring.mesh.points[: ring.mesh.n_own, 2] - np.pi / 2.0) < 0.6))
    load = ring.columns({ring.dof(0, node, Y): 1.0})
    problem = ring.problem(load)
    body = rigid_by_coordinates(ring)[:, 3]
    T = ring.to_cartesian
    inertia = body @ (T.T @ ring.cartesian.M @ T @ body)
    omega = HZ * 0.01
    line = solve_line(problem, SOLVERS[solver](problem), omega)
    arm = body[ring.dof(0, node, Y)]
    assert abs(arm) > 0.1
    assert line.receptance[0, 0] == pytest.approx(-(arm**2) / (omega**2 * inertia), rel=1e-4)


def test_springs_to_the_ground_hold_a_tyre_as_a_rim_does():
    ring = free()
    cell = ring.cell
    soft = {name: K + 1e3 * (cell.rows == cell.indices) for name, K in cell.K.items()}
    assert RigidMotions.of(replace(cell, K=soft), 5).count == 0


def test_a_resonance_of_a_free_tyre_is_still_an_error_that_names_it():
    ring = free(5, 0.0)
    squared, *_ = modes(5, 0.0)
    problem = ring.problem(loads(ring))
    omega = float(np.sqrt(squared[0]))
    with pytest.raises(SolveError, match=r"an undamped resonance of circumferential order \d"):
        solve_line(problem, SOLVERS["cyclic"](problem), omega)


def test_a_lopsided_tyre_drifts_right_too():
    ring = replace(lopsided(tyre("hex8i", 5, 4, 2)), damping=UNDAMPED).with_free_rim()
    mass = 5 * ring.cell.sparse(ring.cell.M).toarray()[Y::3, Y::3].sum()
    push = ring.columns({ring.dof(c, k, Y): 1.0 for c in range(5) for k in range(ring.mesh.n_own)})
    problem = ring.problem(push)
    line = solve_line(problem, SOLVERS["recursive"](problem), HZ * 0.01)
    n = 5 * ring.mesh.n_own
    squared = (HZ * 0.01) ** 2
    # not pushed in its centre, it turns as well: the power of all forces is F times their mean
    body = rigid_by_coordinates(ring)
    T = ring.to_cartesian
    inertia = body.T @ (T.T @ ring.cartesian.M @ T @ body)
    f = body.T @ push.toarray()
    expected = -(f.T @ np.linalg.solve(inertia, f))[0, 0] / squared
    assert line.receptance[0, 0] == pytest.approx(expected, rel=1e-8)
    assert abs(expected) >= n**2 / (squared * mass) * (1.0 - 1e-9)


def test_reactions_of_a_tyre_held_at_two_nodes_are_those_of_the_assembled_ring():
    """What is held of a tyre that may still turn; at 20 Hz the referee has its digits, too."""
    ring = held_at(free(2), 2)
    forces = ring.point_loads((0, 7, THETA), (1, 5, R))
    field = parted(ring.problem(forces), HZ * 20.0)
    q, reaction = ring.cartesian.solve(HZ * 20.0, forces)
    held = ~ring.cartesian.free.reshape(q.shape[:2])
    assert np.abs(field.q - q).max() < 1e-8 * np.abs(q).max()
    np.testing.assert_allclose(
        field.remainder[held], reaction[held], atol=1e-8 * np.abs(reaction).max()
    )
    assert np.abs(reaction).max() > 0.1
