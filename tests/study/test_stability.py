"""A state that no tyre stays in is refused before a line is solved, however the tyre is described.

A buckled tyre's equations have an answer like any others: tiny residual, power taken at every
driving point, reciprocal. What is wrong is the state that it vibrates about, which only the sign of
K + K_G + K_P tells. The referee here is LAPACK, on the ring's dense matrices order by order.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from brought import export, stressed
from fem.blocks import order_matrix
from rings import lossless, tyre
from scipy.io import mmread, mmwrite
from small import case_with

import tyrefrf
from tyrefrf.errors import CaseError
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.solvers import SOLVERS, solve_line
from tyrefrf.solvers.inertia import unstable_orders
from tyrefrf.solvers.modes import ring_modes
from tyrefrf.solvers.stability import instability
from tyrefrf.study.certify import plan_certificate
from tyrefrf.study.compare import compare
from tyrefrf.study.estimate import estimate
from tyrefrf.study.model import build_model
from tyrefrf.study.run import run_case

N = 15
FOLLOWING = pytest.mark.parametrize("follows", [True, False])
HEX20R = ('element = "hex8i"', 'element = "hex20r"')
LIMIT = 2.7651e7
"""Pressure [Pa] at which the small tyre buckles; far beyond what linear strains mean."""


def under(pressure, *changes, kind="linear", follows=True):
    table = (
        f'[inflation]\npressure = {pressure}\nkind = "{kind}"\n'
        f"pressure_stiffness = {str(follows).lower()}\n\n[cell]"
    )
    return case_with(("[cell]", table), *changes)


def negative(cell: CellMatrices, n_cells: int) -> dict[int, int]:
    """Negative eigenvalues of the static stiffness by order, by LAPACK."""
    free = ~cell.fixed
    n_face = int(free[: cell.n_face].sum())
    K = cell.sparse(sum(cell.K.values()) + cell.K_G + cell.K_P).toarray()[np.ix_(free, free)]
    counts = {
        h: int(np.sum(np.linalg.eigvalsh(order_matrix(K, n_face, 2.0 * np.pi * h / n_cells)) < 0.0))
        for h in range(n_cells // 2 + 1)
    }
    return {h: count for h, count in counts.items() if count}


def unchecked(monkeypatch, pressure, **more) -> CellMatrices:
    """The cell about a state whatever its stability."""
    monkeypatch.setattr("tyrefrf.study.inflate.instability", lambda *_: None)
    return build_model(under(pressure, **more)).problem.cell


def test_a_buckled_tyre_passes_every_other_proof(monkeypatch):
    """Why stability is looked for at all: nothing in the lines tells."""
    monkeypatch.setattr("tyrefrf.study.inflate.instability", lambda *_: None)
    results = run_case(under(1.2 * LIMIT), jobs=1)
    assert tyrefrf.results.proof.breaches(results) == ()
    assert results.residual.max() < 1e-10
    assert np.all(results.driving_point("radial").real[1:] > 0.0)


@FOLLOWING
@pytest.mark.parametrize("excess", [1.001, 1.2, 3.0])
def test_negative_directions_are_as_many_as_lapack_finds(excess, follows, monkeypatch):
    cell = unchecked(monkeypatch, excess * LIMIT, follows=follows)
    found = instability(cell, N)
    assert found.counts == negative(cell, N)
    assert found.share == pytest.approx(1.0 / excess, rel=3e-3)


@pytest.mark.parametrize("share", [0.5, 0.999])
def test_what_is_below_the_limit_is_let_pass(share, monkeypatch):
    cell = unchecked(monkeypatch, share * LIMIT)
    assert instability(cell, N) is None
    assert negative(cell, N) == {}
    build_model(under(share * LIMIT))


def test_the_message_names_orders_numbers_and_what_the_tyre_bears():
    message = (
        r"inflation\.pressure: the tyre buckles under 3e\+07 Pa: its static stiffness is "
        r"indefinite at circumferential order 0 \(2 negative eigenvalues\), 1 \(2\); it bears "
        r"2\.765e\+07 Pa; lower the pressure, or stiffen the tyre"
    )
    with pytest.raises(CaseError, match=message):
        build_model(under(3e7))


def test_a_tyre_that_its_soft_static_moduli_do_not_hold_is_refused():
    """What vibrates is stiff enough; what stands under the pressure is not."""
    pressure = 0.5 * LIMIT
    stiff, soft = (("eta = 0.1", f"eta = 0.1\nE_static = {k * 80e6}") for k in (0.6, 0.4))
    build_model(under(pressure, stiff))
    with pytest.raises(CaseError, match=r"with the moduli for inflation, is indefinite at .*bears"):
        build_model(under(pressure, soft))


def test_what_a_tyre_bears_grows_with_its_moduli():
    doubled = ('E = "80 MPa"', 'E = "160 MPa"')
    with pytest.raises(CaseError, match=r"it bears 5\.5[23]\d*e\+07 Pa"):
        build_model(under(6e7, doubled))


def estimated(case):
    estimate(case, 1)


def compared(case):
    compare(case, ["cyclic"])


def swept(case):
    tyrefrf.sweep(case, {"pressure": [0.0, 3e7]}, jobs=1)


def ran_adaptively(case):
    adaptive = case.frequency.model_copy(update={"adaptive": True})
    run_case(case.model_copy(update={"frequency": adaptive}), jobs=1)


def certified(case):
    at_rest = run_case(case_with(), jobs=1)
    plan_certificate(case, at_rest)


def moving(case):
    tyrefrf.deflections(case, [100.0])


def waves(case):
    tyrefrf.dispersion(case, lines=2, jobs=1)


def with_solver(name):
    def run(case):
        solver = case.solver.model_copy(update={"name": name})
        run_case(case.model_copy(update={"solver": solver}), jobs=1)

    run.__name__ = f"ran by {name}"
    return run


WAYS = [
    estimated, compared, swept, ran_adaptively, certified, moving, waves, tyrefrf.modes,
    *map(with_solver, ["recursive", "cyclic", "direct", "modal", "auto"]),
]  # fmt: skip


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.__name__)
def test_no_way_leads_past_it(way):
    with pytest.raises(CaseError, match="the tyre buckles"):
        way(under(3e7))


def test_at_rest_the_same_case_has_modes():
    assert tyrefrf.modes(under(3e7), count=2, at_rest=True).frequency[0] > 0.0


RING = lossless(tyre("hex8i", n_cells=9, elements_along=4, elements_around=2))


@pytest.fixture
def pressed(tmp_path):
    """Writes the ring's matrices with a geometric stiffness of so much of the stiffness."""

    def write(share):
        return export(stressed(replace(RING), share), tmp_path)

    return write


def test_brought_matrices_of_a_buckled_tyre_say_what_they_bear(pressed):
    message = (
        r"matrices\.K: the static stiffness is indefinite at circumferential order 0 \(\d+ "
        r"negative eigenvalues\), 1 .*, 4 \(\d+\): such a tyre is not stable, though it bears "
        r"0\.8 of K_G; see to K, and K_G"
    )
    with pytest.raises(CaseError, match=message):
        build_model(pressed(-1.25).case())


def test_brought_matrices_just_before_buckling_pass(pressed):
    build_model(pressed(-0.999).case())


def test_brought_stiffness_that_is_negative_itself_bears_nothing(pressed):
    exported = pressed(0.0)
    K = mmread(exported.directory / "K_rubber.mtx", spmatrix=False).tocsr()
    i = int(exported.rows[4, 0])
    K[i, i] *= -1.0
    mmwrite(exported.directory / "K_rubber.mtx", K)
    with pytest.raises(CaseError, match=r"such a tyre is not stable; see to K"):
        build_model(exported.case())


def test_a_mass_that_is_negative_for_three_nodes_together_is_refused(pressed):
    """Every two of them have one: M_ij^2 <= M_ii M_jj holds."""
    exported = pressed(0.0)
    M = mmread(exported.directory / "M.mtx", spmatrix=False).tocsr().tolil()
    # an interior node and two more, in one direction
    i, j, k = exported.rows[[14, 15, 12], 0]
    for a, b in ((i, j), (j, k), (i, k)):
        M[a, b] = M[b, a] = -0.9 * np.sqrt(M[a, a] * M[b, b])
    mmwrite(exported.directory / "M.mtx", M.tocsr())
    with pytest.raises(CaseError, match=r"matrices\.M: M is no mass: some motions of circumfer"):
        build_model(exported.case())


@pytest.mark.parametrize("excess", [1e-6, 1e-3])
def test_a_negative_direction_is_seen_as_soon_as_there_is_one(excess):
    """K_G = -(1 +- excess) times the lowest omega^2 M: one eigenvalue leaves zero."""
    modes = ring_modes(RING.cell, 9, count=1)
    lowest = min(order.omega[0] for order in modes if len(order.omega)) ** 2
    for sign, expected in ((1.0, 1), (-1.0, 0)):
        cell = replace(RING.cell, K_G=-(lowest * (1.0 + sign * excess)) * RING.cell.M)
        assert sum(unstable_orders(cell, 9).values()) == expected


def test_a_buckled_tyre_without_a_rim_is_told_from_its_rigid_motions():
    free = RING.with_free_rim()
    assert unstable_orders(free.cell, 9) == {}
    softer = replace(free.cell, K_G=-((2.0 * np.pi * 300.0) ** 2) * free.cell.M)
    assert sum(unstable_orders(softer, 9).values()) >= 4  # rigid motions, and modes below 300 Hz


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_state_just_before_buckling_is_answered(solver, monkeypatch):
    """Nearly no stiffness left in one direction: a large answer, and a right one."""
    case = under(0.9999 * LIMIT)
    problem = build_model(case).problem
    line = solve_line(problem, SOLVERS[solver](problem), 0.0)
    other = solve_line(problem, SOLVERS["cyclic"](problem), 0.0)
    scale = abs(other.receptance).max(axis=0)
    assert (abs(line.receptance - other.receptance) < 1e-6 * scale).all()


def test_check_warns_of_linear_strains_that_are_not_small():
    modest, large = (estimate(under(pressure), 1).warnings for pressure in (1e5, 3e6))
    assert not any("linear inflation" in warning for warning in modest)
    assert any("linear inflation strains the tyre by up to" in warning for warning in large)


@pytest.mark.parametrize(("kind", "element"), [("linear", "hex8i"), ("nonlinear", "hex20r")])
def test_equilibrium_is_judged_with_the_moduli_that_carry_the_pressure(kind, element):
    """Half the modulus, half the material stiffness about the same shape."""
    half = ("eta = 0.1", "eta = 0.1\nE_static = 40e6")
    change = ('element = "hex8i"', f'element = "{element}"')
    problem = build_model(under(5e4, half, change, kind=kind)).problem
    state = build_model(under(5e4, half, change, kind=kind)).inflation
    static = state.at_equilibrium(problem.cell, pressure_stiffness=True)
    K = sum(problem.cell.K.values())
    np.testing.assert_allclose(sum(static.K.values()), K / 2.0, atol=1e-9 * abs(K).max())
    np.testing.assert_array_equal(static.K_G, problem.cell.K_G)
