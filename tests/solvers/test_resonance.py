"""Lines on an undamped resonance, and beside it: the right answer, or an error that names it.

The referee solves the ring's own matrices in 80-bit numbers. Beside a resonance, at the relative
distance d, rounding of the matrices alone moves an answer by some 1e-11 / d here: closer than 1e-10
nothing is left of it, and a line must fail; from 1e-6 on it must not.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from extended import HAS_MORE_DIGITS, REAL, refined
from rings import PAPER, THETA, R, Ring, Y, clamped_frequencies, lopsided, lossless, skewed, tyre

from tyrefrf.case import Solver
from tyrefrf.errors import SolveError
from tyrefrf.results.proof import AMPLIFICATION
from tyrefrf.solvers import SOLVERS, prepare, solve_field, solve_line
from tyrefrf.solvers.modes import ring_modes

N = 7
EXACT = list(SOLVERS)
ANY = [*EXACT, "modal"]
DISTANCES = [0.0, 1e-15, 1e-13, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6]
extended = pytest.mark.skipif(not HAS_MORE_DIGITS, reason="longdouble is no more than double here")

RINGS = {
    "mirrored": lambda: tyre("hex8i", N, 4),
    "lopsided": lambda: lopsided(tyre("hex8i", N, 4, 2)),
    "skewed": lambda: skewed(tyre("hex8i", N, 4)),
}


@cache
def ring_of(shape: str) -> Ring:
    return lossless(RINGS[shape]())


def loads_of(ring: Ring, kind: str):
    """One that excites every mode, or equal ones all around, that excite order 0 alone."""
    if kind == "anywhere":
        return ring.point_loads((0, 3, R), (3, 5, THETA), (1, 4, Y))
    return ring.columns({ring.dof(c, 3, R): 1.0 for c in range(N)})


@cache
def natural(shape: str) -> list[tuple[float, int]]:
    """Frequencies omega and orders of the lowest modes, of all orders."""
    ring = ring_of(shape)
    found = [(w, m.order) for m in ring_modes(ring.cell, N, count=40) for w in m.omega]
    return sorted(found)


@cache
def dense(shape: str):
    """K and M of the whole ring on the dofs that move, as the solvers have them."""
    ring = ring_of(shape)
    cell, n = ring.cell, N * ring.cell.n_own
    free = np.tile(~cell.fixed[: cell.n_own], N)
    whole = []
    for entries in (sum(cell.K.values()), cell.M):
        A, own = np.zeros((n, n), REAL), cell.sparse(entries).toarray()
        for c in range(N):
            dofs = (c * cell.n_own + np.arange(cell.n_dofs)) % n
            A[np.ix_(dofs, dofs)] += own
        whole.append(A[np.ix_(free, free)])
    return *whole, free


def truth(shape: str, omega: float, kind: str):
    K, M, free = dense(shape)
    f = loads_of(ring_of(shape), kind).toarray()
    q = np.zeros(f.shape, np.clongdouble)
    q[free] = refined(K - REAL(omega) ** 2 * M, f[free])
    return q


def built(problem, name):
    choice = Solver(name="modal", modes=10_000_000) if name == "modal" else Solver(name=name)
    return prepare(problem, choice)()


def answer_or_error(problem, solver, omega):
    """A field and "", or None and what was said."""
    try:
        return solve_field(problem, built(problem, solver), omega), ""
    except SolveError as error:
        return None, str(error)


@extended
@pytest.mark.parametrize("distance", DISTANCES)
@pytest.mark.parametrize("mode", [0, 8])
@pytest.mark.parametrize("kind", ["anywhere", "all around"])
@pytest.mark.parametrize("shape", RINGS)
@pytest.mark.parametrize("solver", EXACT)
def test_a_line_beside_a_resonance_is_right_or_an_error_that_names_it(
    solver, shape, kind, mode, distance
):
    ring = ring_of(shape)
    omega, order = natural(shape)[mode]
    omega *= 1.0 + distance
    problem = ring.problem(loads_of(ring, kind))
    field, error = answer_or_error(problem, solver, omega)
    if field is None:
        assert distance < 1e-7
        assert f"undamped resonance of circumferential order {order} lies on" in error
        assert error.startswith(f"{omega / (2.0 * np.pi):.6g} Hz: no ")
        return
    assert distance > 1e-11
    expected = truth(shape, omega, kind).reshape(field.q.shape)
    lack = np.abs((field.q - expected).astype(complex)).max(axis=(0, 1))
    size = np.abs(expected.astype(complex)).max(axis=(0, 1))
    assert (lack / size).max() < AMPLIFICATION * field.residual


@pytest.mark.parametrize("mode", [0, 3, 8, 21])
def test_superposed_modes_have_no_answer_on_one_of_them(mode):
    ring = ring_of("mirrored")
    omega, order = natural("mirrored")[mode]
    problem = ring.problem(loads_of(ring, "anywhere"))
    with pytest.raises(SolveError, match=f"a mode of order {order} at .* resonates undamped"):
        solve_line(problem, built(problem, "modal"), omega)


def with_loss(eta: float) -> Ring:
    return tyre("hex8i", N, 4, stuff=PAPER.model_copy(update={"eta": eta}))


def lopsided_with_loss(eta: float) -> Ring:
    ring = ring_of("lopsided")
    stuff = {name: m.model_copy(update={"eta": eta}) for name, m in ring.materials.items()}
    return replace(ring, materials=stuff)


@pytest.mark.parametrize("eta", [1e-16, 1e-14, 1e-12, 1e-10])
@pytest.mark.parametrize("mode", range(12))
@pytest.mark.parametrize("solver", EXACT)
def test_a_loss_too_small_to_count_hides_no_resonance(solver, mode, eta):
    """Loads that excite order 0 alone: their residual tells nothing of the others' resonances."""
    ring = lopsided_with_loss(eta)
    omega, order = natural("lopsided")[mode]
    problem = ring.problem(loads_of(ring, "all around"))
    expected = SOLVERS["direct"](ring_of("lopsided").problem(loads_of(ring, "all around")))
    field, error = answer_or_error(problem, solver, omega)
    if field is None:
        assert f"order {order} " in error
        return
    beside = expected.field(omega * (1.0 + 1e-7)).q  # the same, but for its own order's
    if order != 0:
        assert np.abs(field.q - beside).max() < 1e-3 * np.abs(beside).max()


@pytest.mark.parametrize("mode", range(12))
@pytest.mark.parametrize("solver", EXACT)
def test_one_damper_hides_no_resonance(solver, mode):
    """Viscous damping at one node's r in each cell: modes that are still there lose nothing."""
    ring = ring_of("mirrored")
    cell = ring.cell
    dof = 3 * 5
    C = np.where((cell.rows == dof) & (cell.indices == dof), 1e-9, 0.0)
    problem = replace(ring.problem(loads_of(ring, "all around")), cell=replace(cell, C=C))
    omega, order = natural("mirrored")[mode]
    with pytest.raises(SolveError, match=f"undamped resonance of circumferential order {order} "):
        solve_field(problem, built(problem, solver), omega)


@pytest.mark.parametrize("eta", [1e-3, 0.1])
@pytest.mark.parametrize("mode", [0, 3, 8, 21])
@pytest.mark.parametrize("solver", ANY)
def test_with_damping_there_is_always_an_answer(solver, mode, eta):
    """On a natural frequency, held against the ring assembled in Cartesian coordinates."""
    ring = with_loss(eta)
    omega, _ = natural("mirrored")[mode]
    loads = loads_of(ring, "anywhere")
    problem = ring.problem(loads)
    field = solve_field(problem, built(problem, solver), omega)
    expected, _ = ring.cartesian.solve(omega, loads)
    lack = np.abs(field.q - expected).max(axis=(0, 1))
    assert (lack / np.abs(expected).max(axis=(0, 1))).max() < 1e-11 / eta


@extended
@pytest.mark.parametrize("distance", [0.0, 1e-15, 1e-12, 1e-9, 1e-6])
@pytest.mark.parametrize("n_chain", [1, 2, 4])
def test_a_chain_that_resonates_between_held_ends_is_answered(n_chain, distance):
    """The ring has a good answer there; the chain cannot be joined, so `cyclic` solves the line."""
    shape = "lopsided" if n_chain == 1 else "mirrored"
    ring = ring_of(shape)
    omega = clamped_frequencies(ring, n_chain)[1] * (1.0 + distance)
    problem = ring.problem(loads_of(ring, "anywhere"))
    field = solve_field(problem, built(problem, "recursive"), omega)
    expected = truth(shape, omega, "anywhere").reshape(field.q.shape)
    lack = np.abs((field.q - expected).astype(complex)).max() / np.abs(expected).max()
    assert lack < AMPLIFICATION * field.residual < 1e-6
