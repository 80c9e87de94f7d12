"""The whole ring, factorised by every library that is installed.

The truth is a dense solution of the ring in Cartesian coordinates, whose pivots may come from
anywhere. Undamped rings have lines on which diagonal pivots fail (a chain of cells resonates with
its ends held) and lines without an answer (the ring itself resonates).
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
    lopsided,
    lossless,
    omegas,
    ring_frequencies,
    section_error,
    tyre,
)

from tyrefrf.errors import SolveError
from tyrefrf.solvers import Direct, mkl, solve_line
from tyrefrf.solvers.direct import LIBRARIES, check_library
from tyrefrf.solvers.pardiso import REMARK

ROUND_OFF = 1e-9  # condition 1e6 x eps, with margin
UNDAMPED = 1e-7  # a resonance of the ring is never far: measured 1e-12 to 7e-9
ONE_FACTORISATION = 1e-10  # residual; the coarse hex20r, nearly a mechanism, has 2e-11

needs_mkl = pytest.mark.skipif(
    not mkl.installed(), reason="MKL is not installed, PARDISO is NOT TESTED: pip install mkl"
)
every_library = pytest.mark.parametrize(
    "library", [pytest.param(n, marks=needs_mkl if n == "pardiso" else ()) for n in LIBRARIES]
)


def point_loads(ring):
    return ring.point_loads((0, 3, R), (ring.n_cells // 2, 5, THETA), (1, 4, Y))


def dense(ring, omega, loads):
    """Displacements (n_cells, n_own, n_loads) by LAPACK, in (r, y, theta)."""
    referee = ring.cartesian
    D = referee.dynamic_stiffness(omega).toarray()
    f = ring.to_cartesian @ loads.toarray()
    q = np.zeros(f.shape, complex)
    free = referee.free
    q[free] = np.linalg.solve(D[np.ix_(free, free)], f[free])
    return (ring.to_cartesian.T @ q).reshape(*referee.shape, -1)


@pytest.mark.parametrize("hertz", [0.0, 230.0, 1700.0])
@pytest.mark.parametrize("shape", [lambda ring: ring, lopsided], ids=["mirrored", "lopsided"])
@pytest.mark.parametrize(
    ("element", "n_cells"), [("hex8i", n) for n in (1, 2, 3, 7)] + [("hex20r", 2)]
)
@every_library
def test_same_ring_as_a_dense_solution(library, element, n_cells, shape, hertz):
    ring = shape(tyre(element, n_cells, elements_along=4, elements_around=max(2, -(-4 // n_cells))))
    loads, omega = point_loads(ring), omegas(hertz)[0]

    field = Direct(ring.problem(loads), library).field(omega)

    assert section_error(field.q, dense(ring, omega, loads), ring.cell.n_face) < ROUND_OFF
    assert field.residual < ONE_FACTORISATION
    assert field.remark == ""


@needs_mkl
def test_pardiso_answers_every_line_as_if_it_were_the_first():
    """Its analysis is kept from line to line, and a line with matched pivots leaves no trace."""
    ring = lossless(tyre(n_cells=7, elements_along=4))
    problem = ring.problem(point_loads(ring))
    held = clamped_frequencies(ring, 2)[0]
    lines = [0.6 * held, held, 0.6 * held, held]
    used = Direct(problem, "pardiso")

    fields = [used.field(omega) for omega in lines]
    fresh = [Direct(problem, "pardiso").field(omega) for omega in lines]

    assert [field.remark for field in fields] == ["", REMARK, "", REMARK]
    for field, expected in zip(fields, fresh, strict=True):
        np.testing.assert_array_equal(field.q, expected.q)


@pytest.mark.parametrize("mode", [0, 1, 5])
@pytest.mark.parametrize("n_ring", [7, 45])
@pytest.mark.parametrize(("n_chain", "elements_around"), [(1, 2), (2, 1), (4, 1)])
@every_library
def test_resonance_of_a_held_chain_is_answered(library, n_chain, elements_around, n_ring, mode):
    ring = lossless(tyre(n_cells=n_ring, elements_along=4, elements_around=elements_around))
    problem = ring.problem(point_loads(ring))
    omega = clamped_frequencies(ring, n_chain)[mode]
    expected, _ = ring.cartesian.solve(omega, point_loads(ring))

    field = Direct(problem, library).field(omega)

    assert section_error(field.q, expected, ring.cell.n_face) < UNDAMPED
    assert field.residual < UNDAMPED


@pytest.mark.parametrize("mode", range(0, 30, 3))
@every_library
def test_between_undamped_resonances_the_answer_is_right(library, mode):
    ring = lossless(tyre(n_cells=7, elements_along=4))
    resonances = np.unique(np.round(ring_frequencies(ring), 3))
    omega = resonances[mode : mode + 2].mean()
    loads = point_loads(ring)

    field = Direct(ring.problem(loads), library).field(omega)

    assert section_error(field.q, dense(ring, omega, loads), ring.cell.n_face) < UNDAMPED
    assert field.residual < UNDAMPED


@pytest.mark.parametrize("mode", range(0, 30, 3))
@every_library
def test_resonance_of_a_mode_that_no_load_excites_is_refused(library, mode):
    """Equal radial forces around the tyre excite order 0 alone: their own residual tells nothing.

    Modes 3, 14 and the like, of order 0, they do excite; all must be refused.
    """
    ring = lossless(tyre(n_cells=7, elements_along=4))
    around = ring.columns({ring.dof(c, 3, R): 1.0 for c in range(7)})
    problem = ring.problem(around)
    omega = ring_frequencies(ring)[mode]

    with pytest.raises(SolveError, match="add a loss factor"):
        solve_line(problem, Direct(problem, library), omega)


@every_library
def test_the_load_that_excites_every_mode_is_kept_to_itself(library):
    ring = tyre(n_cells=7, elements_along=4)
    problem = ring.problem(point_loads(ring))

    field = Direct(problem, library).field(omegas(230.0)[0])

    assert field.q.shape == field.remainder.shape == (7, ring.cell.n_own, problem.n_loads)


def test_a_missing_library_is_named_with_the_command_that_installs_it(monkeypatch):
    monkeypatch.setattr(mkl, "installed", lambda: False)
    ring = tyre(n_cells=7, elements_along=4)
    problem = ring.problem(point_loads(ring))

    with pytest.raises(SolveError, match=r"MKL is not installed.*pip install 'tyrefrf\[mkl\]'"):
        Direct(problem, "pardiso")
    assert check_library("auto") == "superlu"
    assert check_library("superlu") == "superlu"


def test_the_fastest_library_installed_is_taken(monkeypatch):
    monkeypatch.setattr(mkl, "installed", lambda: True)
    assert check_library("auto") == "pardiso"


def test_mkl_that_cannot_be_found_is_not_installed(monkeypatch):
    def nothing(name):
        raise mkl.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(mkl.metadata, "files", nothing)
    monkeypatch.setattr(mkl, "find_library", lambda name: None)
    mkl.library.cache_clear()

    assert not mkl.installed()

    mkl.library.cache_clear()


def test_loads_may_be_many_columns():
    """Every column is solved, whatever the number: 12 at once are 12 one by one."""
    ring = tyre(n_cells=7, elements_along=4)
    places = [(c, n, d) for c in (0, 3) for n in (3, 5) for d in (R, Y, THETA)]
    together = ring.problem(ring.point_loads(*places))
    omega = omegas(500.0)[0]

    q = Direct(together).field(omega).q

    for column, place in enumerate(places):
        alone = replace(together, loads=ring.point_loads(place))
        expected = Direct(alone).field(omega).q
        assert section_error(q[..., [column]], expected, ring.cell.n_face) < ROUND_OFF
