"""A case that leaves its solver open gets the one that is expected to be the faster."""

from __future__ import annotations

import numpy as np
import pytest
from small import case_with

from tyrefrf.case import make_grid, parse_case, starter_text
from tyrefrf.cli.report import describe_run, summary
from tyrefrf.study import choose
from tyrefrf.study.certify import plan_certificate
from tyrefrf.study.choose import decided, with_solver
from tyrefrf.study.estimate import estimate
from tyrefrf.study.model import build_model
from tyrefrf.study.run import run_case
from tyrefrf.study.sweep import run_sweep

AUTO = ("[frequency]", '[solver]\nname = "auto"\n\n[frequency]')
COSTS = {
    "recursive": {"recursive": 0.001, "cyclic": 0.002},
    "cyclic": {"recursive": 3, "cyclic": 2},
}


@pytest.fixture(params=COSTS)
def fastest(request, monkeypatch):
    """The solver that is made to look cheaper."""
    monkeypatch.setattr(choose, "line_seconds", lambda name, _: COSTS[request.param][name])
    return request.param


def test_the_cheaper_solver_is_taken_and_gives_its_own_digits(fastest):
    found = run_case(case_with(AUTO), jobs=1)
    named = run_case(case_with((AUTO[0], AUTO[1].replace("auto", fastest))), jobs=1)
    assert found.provenance.solver == fastest
    assert found.provenance.case_hash == named.provenance.case_hash
    np.testing.assert_array_equal(found.receptance, named.receptance)


def test_the_summary_says_what_was_picked_and_why(fastest):
    told = describe_run(summary(run_case(case_with(AUTO), jobs=1), []) | {"seconds": 1.0})
    expected = [f"{1e3 * s:.3g} ms by {name}" for name, s in COSTS[fastest].items()]
    assert f"{fastest}, picked: a line is expected to take {', '.join(expected)}" in told


def test_a_sweep_an_estimate_and_a_certificate_know_what_was_picked(fastest):
    case = case_with(AUTO)
    results = run_case(case, jobs=1)
    swept = run_sweep(make_grid(case, {"E_rubber": (2e7, 4e7)}), jobs=1)
    assert {point.provenance.solver for point in swept.points} == {fastest}
    assert swept.provenance.numbers["expected_cyclic"] == COSTS[fastest]["cyclic"]
    assert estimate(case, 1).solver == fastest
    assert plan_certificate(case, results).second.name != fastest


def test_a_solver_that_is_named_stays(fastest):
    case = case_with()
    assert decided(case, build_model(case).problem) == (case, {})


def test_on_the_papers_homogeneous_tyre_the_orders_are_expected_to_be_faster():
    case = with_solver(parse_case(starter_text(), "starter", "homogeneous"), "auto")
    chosen, expected = decided(case, build_model(case).problem)
    assert chosen.solver.name == "cyclic"
    assert 0.0 < expected["expected_cyclic"] < expected["expected_recursive"]
