"""Lines on which a matrix of the method is singular: a part of the tyre resonates undamped.

A chain with both ends held resonates at the eigenfrequencies of its assembled matrices; there its
face cannot be eliminated although the ring has a perfectly good answer. On a resonance of the
ring itself, and for a free tyre at 0 Hz, there is none.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rings import (
    THETA,
    R,
    Y,
    clamped_frequencies,
    lossless,
    omegas,
    ring_frequencies,
    section_error,
    tyre,
    with_steel_belt,
)

from tyrefrf.errors import SingularError, SolveError
from tyrefrf.solvers import SOLVERS, Direct, Recursive, factor, solve_line

UNDAMPED = 1e-7  # a ring's own resonance is never far: measured 1e-12 to 1e-9
RING_CELLS = [3, 7, 45]


def loads(ring):
    return ring.point_loads((0, 3, R), (ring.n_cells // 2, 5, THETA))


def as_the_paper_writes_it(problem):
    """One chain all around the ring, whatever symmetries there are."""
    return Recursive(problem, symmetries=False, most_chains=1)


@pytest.mark.parametrize("mode", [0, 1, 5])
@pytest.mark.parametrize("n_ring", RING_CELLS)
@pytest.mark.parametrize(
    ("n_chain", "elements_around"),
    [(1, 2), (2, 1), (4, 1)],
    ids=["inside of a cell", "two cells", "four cells"],
)
@pytest.mark.parametrize("solver", SOLVERS)
def test_resonance_of_a_held_chain_is_answered(solver, n_chain, elements_around, n_ring, mode):
    ring = lossless(tyre(n_cells=n_ring, elements_along=4, elements_around=elements_around))
    omega = clamped_frequencies(ring, n_chain)[mode]
    expected, _ = ring.cartesian.solve(omega, loads(ring))

    field = SOLVERS[solver](ring.problem(loads(ring))).field(omega)

    assert section_error(field.q, expected, ring.cell.n_face) < UNDAMPED


@pytest.mark.parametrize(
    ("n_chain", "elements_around", "n_ring"),
    [(1, 2, 7), (1, 2, 45), (2, 1, 7), (2, 1, 45), (4, 1, 45), (4, 1, 60)],
)
def test_the_recursion_says_who_solved_the_line(n_chain, elements_around, n_ring):
    ring = lossless(tyre(n_cells=n_ring, elements_along=4, elements_around=elements_around))
    problem = ring.problem(loads(ring))
    omega = clamped_frequencies(ring, n_chain)[0]
    solver = as_the_paper_writes_it(problem)

    line = solve_line(problem, solver, omega)
    beside = solve_line(problem, solver, 0.8 * omega)

    assert line.remark == "a chain of cells resonates undamped here: solved by `cyclic`"
    assert line.residual < UNDAMPED
    assert beside.remark == ""


@pytest.mark.parametrize("offset", [1e-12, 1e-10, 1e-8, 1e-6, 1e-4])
def test_near_a_resonance_of_two_cells_of_the_papers_tyre(offset):
    """The condition estimate does not notice from 1e-10 on; the residual does."""
    paper = lossless(tyre())
    problem = paper.problem(paper.point_loads((0, 29, R)))
    omega = clamped_frequencies(paper, 2)[3] * (1.0 + offset)
    expected = Direct(problem).field(omega).q

    field = as_the_paper_writes_it(problem).field(omega)

    assert section_error(field.q, expected, paper.cell.n_face) < UNDAMPED
    assert field.residual < UNDAMPED
    assert field.remark.startswith("a chain of cells ")
    assert field.remark.endswith("solved by `cyclic`")


@pytest.mark.parametrize("offset", [0.0, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4])
def test_near_that_resonance_the_symmetric_recursion_is_right_too(offset):
    paper = lossless(tyre())
    problem = paper.problem(paper.point_loads((0, 29, R)))
    omega = clamped_frequencies(paper, 2)[3] * (1.0 + offset)

    q = Recursive(problem).field(omega).q

    assert section_error(q, Direct(problem).field(omega).q, paper.cell.n_face) < UNDAMPED


@pytest.mark.parametrize("mode", [0, 1, 7, 30])
@pytest.mark.parametrize("solver", SOLVERS)
def test_resonance_of_the_undamped_ring_is_an_error_that_names_it(solver, mode):
    ring = lossless(tyre(n_cells=7, elements_along=4))
    problem = ring.problem(ring.point_loads((0, 3, R), (3, 5, THETA), (1, 4, Y)))
    omega = ring_frequencies(ring)[mode]

    with pytest.raises(SolveError, match=rf"^{omega / 2 / np.pi:.6g} Hz: .*add a loss factor"):
        solve_line(problem, SOLVERS[solver](problem), omega)


@pytest.mark.parametrize("mode", range(16))
@pytest.mark.parametrize("solver", SOLVERS)
def test_resonance_of_a_mode_that_no_load_excites_is_refused(solver, mode):
    """Equal radial forces all around excite order 0 alone: their own residual tells nothing."""
    ring = lossless(tyre(n_cells=7, elements_along=4))
    problem = ring.problem(ring.columns({ring.dof(c, 3, R): 1.0 for c in range(7)}))
    omega = ring_frequencies(ring)[mode]

    with pytest.raises(SolveError, match="add a loss factor"):
        solve_line(problem, SOLVERS[solver](problem), omega)


@pytest.mark.parametrize("element", ["hex8i", "hex20"])
@pytest.mark.parametrize("eta", [0.0, 0.1])
@pytest.mark.parametrize("solver", SOLVERS)
def test_free_tyre_at_0_hz_is_an_error_that_names_it(solver, eta, element):
    damped = tyre(element, n_cells=12, elements_along=4)
    ring = (damped if eta else lossless(damped)).with_free_rim()
    problem = ring.problem(ring.point_loads((0, 3, R), (5, 5, THETA)))

    with pytest.raises(SolveError, match=r"^0 Hz: .*fix the rim"):
        solve_line(problem, SOLVERS[solver](problem), 0.0)


def test_free_tyre_moves_as_a_rigid_body_at_low_frequency():
    """At 0.5 Hz, -omega^2 m q = F for an axial force, all around the tyre."""
    ring = tyre(n_cells=12, elements_along=4).with_free_rim()
    everywhere = ring.columns(
        {ring.dof(c, n, Y): 1.0 for c in range(12) for n in range(ring.mesh.n_own)}
    )
    problem = ring.problem(everywhere)
    omega = omegas(0.5)[0]
    mass = 12 * ring.cell.sparse(ring.cell.M).toarray()[Y::3, Y::3].sum()
    n = 12 * ring.mesh.n_own

    H = solve_line(problem, Recursive(problem), omega).receptance[0, 0]

    assert pytest.approx(-(n**2) / (omega**2 * mass), rel=1e-3) == H


def test_load_on_nothing_but_the_rim_is_an_error():
    ring = tyre(n_cells=8, elements_along=4)
    with pytest.raises(SolveError, match="rim"):
        ring.problem(ring.point_loads((0, 4, R), (2, 0, Y)))


@pytest.mark.parametrize(
    ("ring", "least", "worst"),
    [(tyre(), 3e-6, 36.380516), (with_steel_belt(tyre()), 1.5e-9, 14.233718)],
    ids=["homogeneous", "steel belt"],
)
def test_damped_tyres_stay_far_from_the_singular_limit(ring, least, worst, monkeypatch):
    """The numbers in RCOND_MIN's docstring; `worst` is where 150 random lines came closest."""
    monkeypatch.setattr(factor, "RCOND_MIN", least)
    problem = ring.problem(ring.point_loads((0, 29, R), (7, 20, THETA)))
    solver = Recursive(problem)

    lines = [
        solve_line(problem, solver, omega) for omega in omegas(0.0, worst, *range(150, 3001, 150))
    ]

    assert {line.remark for line in lines} == {""}
    assert max(line.residual for line in lines) < 1e-8


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_tyre_without_any_stiffness_is_refused_at_0_hz(solver):
    """Pivots that are exactly zero, not only to rounding."""
    ring = tyre(n_cells=7, elements_along=4)
    nothing = {name: 0.0 * K for name, K in ring.cell.K.items()}
    problem = replace(ring.problem(loads(ring)), cell=replace(ring.cell, K=nothing))

    with pytest.raises(SolveError, match=r"^0 Hz: .*singular"):
        solve_line(problem, SOLVERS[solver](problem), 0.0)
    with pytest.raises(SingularError, match="singular"):
        SOLVERS[solver](problem).field(0.0)


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e9])
def test_the_condition_is_that_of_the_largest_row_whatever_the_units(size):
    """100 equal springs, and one that is 1e14 times as soft: as one with that alone."""
    springs = np.diag(np.append(np.ones(100), 1e-14)).astype(complex)
    with pytest.raises(SingularError, match=r"reciprocal condition 1\.0e-14"):
        factor.factorise(size * springs)
    springs[-1, -1] = 1e-11
    x = factor.factorise(size * springs).solve(springs)
    np.testing.assert_allclose(size * x, np.eye(101), atol=1e-15)


def test_a_pivot_of_exactly_zero_leaves_no_condition():
    with pytest.raises(SingularError, match=r"reciprocal condition 0\.0e"):
        factor.factorise(np.diag([1.0, 0.0, 2.0]).astype(complex))
