"""At 0 Hz a held tyre stands still under its load: the static answer, by every solver.

All of the tyre is of one material with a constant Poisson's ratio, so its static receptance is that
of Young's modulus 1 over E(0); the referee is the ring in Cartesian coordinates, real and
factorised by itself. E(0) is read off the law by hand: with hysteresis E (1 + i eta), which the
convention keeps at 0 Hz; E_0 of Zener's law, E_inf of Prony's; the first row of a table.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from rings import PAPER, THETA, R, Ring, Y, tyre
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu
from small import case_with

from tyrefrf.case import Damping, Isotropic, Solver
from tyrefrf.errors import CaseError
from tyrefrf.results.derived import in_bands, level, reference_of
from tyrefrf.results.proof import MEASURES, breaches
from tyrefrf.solvers import prepare, solve_field, solve_line
from tyrefrf.study.run import run_case

N = 12
SAME = 1e-10

STUFF = {"nu": 0.42, "rho": 1200.0}
TABLE = {"kind": "table", "frequencies": [1.0, 1e3], "E": [40e6, 90e6], "eta": [0.2, 0.3]}
LAWS = {
    "undamped": (PAPER.model_copy(update={"eta": 0.0}), 80e6),
    "hysteretic": (PAPER, 80e6 * (1.0 + 0.1j)),
    "Zener": (
        Isotropic(
            **STUFF,
            modulus={"kind": "zener", "E_0": 40e6, "E_inf": 4e8, "tau": 1e-3, "alpha": 0.5},
        ),
        40e6,
    ),
    "Prony": (
        Isotropic(
            **STUFF, modulus={"kind": "prony", "E_0": 80e6, "g": [0.3, 0.2], "tau": [1e-3, 1e-2]}
        ),
        40e6,
    ),
    "table": (Isotropic(**STUFF, modulus=TABLE | {"extrapolate": True}), 40e6 * (1.0 + 0.2j)),
}
SOLVERS = ["recursive", "cyclic", "direct", "modal"]


def ring_of(law: str, damping: Damping = Damping()) -> Ring:  # noqa: B008  frozen
    return tyre("hex8i", N, 6, stuff=LAWS[law][0], damping=damping)


def loads(ring: Ring):
    return ring.point_loads((0, 5, R), (4, 7, THETA), (3, 4, Y))


@cache
def static() -> np.ndarray:
    """Displacements (n_dofs, n_loads) of the ring for E = 1 Pa."""
    ring = tyre("hex8i", N, 6, stuff=Isotropic(E=1.0, **STUFF))
    referee = ring.cartesian
    K, free = csc_array(referee.K.real), referee.free
    f = ring.to_cartesian @ loads(ring).toarray()
    q = np.zeros(f.shape)
    q[free] = splu(csc_array(K[free][:, free])).solve(f[free])
    return ring.to_cartesian.T @ q


def built(problem, name):
    more = {"static_correction": True, "modes": 30} if name == "modal" else {}
    return prepare(problem, Solver(name=name, **more))()


@pytest.mark.parametrize("damping", [Damping(), Damping(alpha=5.0, beta=1e-5)], ids=["", "viscous"])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("solver", SOLVERS)
def test_static_answer(solver, law, damping):
    """Viscous damping does nothing to what stands still."""
    ring = ring_of(law, damping)
    problem = ring.problem(loads(ring))
    field = solve_field(problem, built(problem, solver), 0.0)
    expected = static() / LAWS[law][1]
    assert np.abs(field.q.reshape(expected.shape) - expected).max() < SAME * np.abs(expected).max()
    assert field.remark == ""


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("solver", SOLVERS)
def test_the_line_at_0_hz_is_where_those_above_it_lead(solver, law):
    """H(omega) - H(0) goes to zero, but for a fractional derivative as its root."""
    ring = ring_of(law)
    problem = ring.problem(loads(ring))
    one = built(problem, solver)
    still, slow = (solve_line(problem, one, 2.0 * np.pi * f).receptance for f in (0.0, 1e-7))
    assert np.abs(slow - still).max() < 1e-3 * np.abs(still).max()


def test_an_undamped_static_answer_is_real():
    ring = ring_of("undamped")
    problem = ring.problem(loads(ring))
    for solver in SOLVERS:
        H = solve_line(problem, built(problem, solver), 0.0).receptance
        assert np.abs(H.imag).max() < 1e-14 * np.abs(H).max()
        assert np.diag(H).real.min() > 0.0


def test_a_table_that_begins_above_0_hz_is_refused_unless_its_end_rows_hold():
    law = '{ kind = "table", frequencies = [1.0, 1e3], E = [4e7, 9e7], eta = [0.2, 0.3]'
    stuff = 'E = "80 MPa"\nnu = 0.42\nrho = 1200.0\neta = 0.1'

    def case(more):
        return case_with((stuff, f"nu = 0.42\nrho = 1200.0\nmodulus = {law}{more} }}"))

    with pytest.raises(CaseError, match="frequency line 0 Hz is below the table"):
        case("")
    assert run_case(case(", extrapolate = true"), jobs=1).solved.all()


@pytest.mark.parametrize("eta", ["0.0", "0.1"])
@pytest.mark.parametrize("lines", ["[0.0]", "[0.0, 40.0]"])
def test_results_at_0_hz_hold_numbers_and_breach_nothing(lines, eta):
    lines = ("[0.0, 40.0, 150.0, 420.0]", lines)
    results = run_case(case_with(lines, ("eta = 0.1", f"eta = {eta}")), jobs=1)
    assert np.isfinite(results.receptance).all()
    assert np.isfinite(results.blocked_force).all()
    assert (results.mobility[..., 0] == 0.0).all()
    assert (results.accelerance[..., 0] == 0.0).all()
    assert results.solved.all()
    assert breaches(results) == ()
    at_zero = [measure.of(results)[..., 0] for measure in MEASURES.values()]
    assert np.isnan(at_zero[1]).all()  # no power, no share of it
    assert at_zero[0] < 1e-11


def test_nothing_that_moves_has_no_level_and_no_band():
    results = run_case(case_with(("[0.0, 40.0, 150.0, 420.0]", "[0.0]")), jobs=1)
    still = np.abs(results.mobility[0, 0]) ** 2
    assert np.isnan(level(still, reference_of("mobility", "iso1683"))).all()
    bands, mean_square = in_bands(results, "radial", "sidewall")
    assert len(bands.centre) == len(mean_square) == 0
