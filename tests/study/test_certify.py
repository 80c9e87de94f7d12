"""A second look at a run finds what the run's own equations cannot: a wrong solver, a coarse ring.

The solver that lies says that its residual is fine; its field is off.
"""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from small import case_with

import tyrefrf
from tyrefrf.case import Frequency, Solver, cell
from tyrefrf.results import load_results, write_results
from tyrefrf.results.proof import breaches
from tyrefrf.solvers import SOLVERS, Recursive
from tyrefrf.study.certify import certified, plan_certificate, refined_case
from tyrefrf.study.model import build_model
from tyrefrf.study.run import run_case

ROUND_OFF = 1e-9
NODES = ("s = 0.31\nangle = 100.0", "s = 0.31\nangle = 130.0"), ('kind = "patch"\n', ""), (
    'diameter = "20 mm"\n', "",
)  # fmt: skip


def by(name):
    return ("[cell]", f'[solver]\nname = "{name}"\n\n[cell]')


def certify(case, results=None):
    return certified(plan_certificate(case, results or run_case(case, jobs=1)), 1)


@pytest.mark.parametrize(
    ("solver", "second"), [("recursive", "cyclic"), ("cyclic", "recursive"), ("direct", "cyclic")]
)
def test_two_solvers_agree_to_rounding(solver, second):
    results = certify(case_with(by(solver)))
    certificate = results.certificate
    assert certificate.solver == second
    assert certificate.frequency.tolist() == [0.0, 40.0, 150.0, 420.0]
    assert certificate.difference.shape == certificate.cell_difference.shape == (2, 4)
    assert certificate.difference.max() < ROUND_OFF
    assert certificate.cell_difference.max() < ROUND_OFF
    assert certificate.residual.max() < ROUND_OFF
    assert breaches(results) == ()


def test_the_level_changes_to_that_of_a_tyre_with_twice_the_cells():
    case = case_with()
    finer = run_case(case_with(("sector_angle = 24.0", "sector_angle = 12.0")), jobs=1)
    results = certify(case)
    assert results.certificate.n_cells == 30
    before, after = (20.0 * np.log10(abs(r.receptance)) for r in (results, finer))
    np.testing.assert_allclose(results.certificate.level_change, after - before, atol=1e-6)
    assert abs(results.certificate.level_change).max() > 1.0


@pytest.mark.parametrize("element", ["hex8i", "hex20"])
def test_nodes_stay_where_they_were_in_the_coarser_ring(element):
    """130 degrees is nearest to 120 with cells of 24, and nearest to 132 with cells of 12."""
    case = case_with(*NODES, ('element = "hex8i"', f'element = "{element}"'))
    coarse = build_model(case)
    fine = build_model(refined_case(case, coarse))
    assert fine.problem.n_cells == 30
    for a, b in zip(coarse.loads + coarse.probes, fine.loads + fine.probes, strict=True):
        assert (b.s, b.y, b.angle) == pytest.approx((a.s, a.y, a.angle), abs=1e-9)
    assert np.rad2deg(coarse.loads[1].angle) == pytest.approx(120.0)


def test_a_probe_that_shares_name_and_node_with_a_load_is_kept_apart():
    text = ('name = "sidewall"\ns = 0.8\nangle = 31.0\ndirection = "y"',
            'kind = "node"\nname = "radial"\ns = 0.5\nangle = 31.0\ndirection = "r"')  # fmt: skip
    case = case_with(text)
    model = build_model(case)
    assert refined_case(case, model).probes[0].angle == pytest.approx(24.0)
    assert refined_case(case, model).loads[0].angle == 0.0


def test_where_the_halved_cell_is_not_allowed_it_says_so(monkeypatch):
    case = case_with()
    results = run_case(case, jobs=1)
    monkeypatch.setattr(cell, "MAX_CELLS", 15)
    plan = plan_certificate(case, results)
    certificate = certified(plan, 1).certificate
    assert "cell.sector_angle: 12 deg is too small" in certificate.left_out
    assert certificate.left_out in plan.words(1)
    assert certificate.n_cells == 0
    assert certificate.level_change.shape == (2, 3, 0)
    assert certificate.difference.max() < ROUND_OFF


def test_probes_that_stand_still_by_symmetry_have_no_level():
    """A radial load at mid-tread moves nothing along the axle there."""
    still = case_with(
        ("s = 0.8\nangle = 31.0", "s = 0.5\nangle = 0.0"),
        ("s = 0.31\nangle = 100.0\ndirection = \"theta\"",
         "s = 0.31\nangle = 100.0\ndirection = \"r\""),
    )  # fmt: skip
    change = certify(still).certificate.level_change
    assert np.isnan(change[0, 2]).all()
    assert np.isfinite(change[1, 2]).all()


class Lying(Recursive):
    """Off by 1e-6 above 400 Hz, with the residual of the sound field."""

    def field(self, omega):
        field = super().field(omega)
        return replace(field, q=field.q * (1.0 + 1e-6)) if omega > 2.0 * np.pi * 400 else field


def test_a_second_solver_sees_what_a_lying_residual_hides(monkeypatch):
    monkeypatch.setitem(SOLVERS, "recursive", Lying)
    case = case_with()
    results = run_case(case, jobs=1)
    assert breaches(results) == ()
    assert breaches(certify(case, results)) == ("420 Hz: cyclic differs by 1.0e-06",)


def test_the_whole_field_is_compared_not_only_the_probes(monkeypatch):
    """Cell 9, at 216 to 240 degrees, moves otherwise; no probe looks there."""

    class Elsewhere(Recursive):
        def field(self, omega):
            field = super().field(omega)
            q = field.q.copy()
            q[9] *= 1.01
            return replace(field, q=q)

    monkeypatch.setitem(SOLVERS, "recursive", Elsewhere)
    certificate = certify(case_with()).certificate
    assert certificate.difference.max() < ROUND_OFF
    np.testing.assert_allclose(certificate.cell_difference, 0.01 / 1.01, rtol=0.02)


def test_modal_is_compared_by_its_responses_and_not_judged():
    """Made up: the responses of another solver, 3 % off, under the name of modal."""
    case = case_with()
    found = run_case(case, jobs=1)
    results = replace(
        found,
        receptance=1.03 * found.receptance,
        provenance=replace(found.provenance, solver="modal"),
    )
    modal = case.model_copy(update={"solver": Solver.model_validate({"name": "modal"})})
    certified_ = certify(modal, results)
    assert certified_.certificate.solver == "cyclic"
    np.testing.assert_allclose(certified_.certificate.difference, 0.03 / 1.03, rtol=1e-6)
    assert np.isnan(certified_.certificate.cell_difference).all()
    assert breaches(certified_) == ()


@pytest.fixture(scope="module")
def many():
    """A run of 60 lines, made up from one of four: the 18th has the largest residual."""
    case = case_with().model_copy(update={"frequency": Frequency(start=0.0, stop=590.0, step=10.0)})
    results = run_case(case, jobs=1)
    residual = results.residual.copy()
    residual[17] = 1e-9
    return case, replace(results, residual=residual)


def test_lines_are_spread_evenly_and_the_worst_is_among_them(many):
    plan = plan_certificate(*many)
    assert plan.checked.tolist() == [0, 8, 17, 25, 34, 42, 51, 59]
    assert len(plan.sampled) == 24
    assert np.diff(plan.sampled).max() - np.diff(plan.sampled).min() <= 1
    case, results = many
    worst = replace(results, residual=np.where(np.arange(60) == 20, 1e-8, results.residual))
    assert 20 in plan_certificate(case, worst).checked


def test_lines_without_an_answer_are_not_asked_for_again(many):
    case, results = many
    H, residual = results.receptance.copy(), results.residual.copy()
    H[..., 30:] = residual[30:] = np.nan
    half = replace(results, receptance=H, residual=residual, solved=~np.isnan(residual))
    plan = plan_certificate(case, half)
    assert plan.checked.max() == plan.sampled.max() == 29
    nothing = replace(half, residual=residual * np.nan, solved=half.solved & False)
    assert plan_certificate(case, nothing).n_lines == 0
    assert certified(plan_certificate(case, nothing), 1).certificate.difference.shape == (2, 0)


def test_the_certificate_does_not_depend_on_the_number_of_jobs(many):
    plan = plan_certificate(*many)
    counted = []
    one, two = certified(plan, 1, counted.append).certificate, certified(plan, 2).certificate
    assert sum(counted) == plan.n_lines
    for field in fields(one):
        np.testing.assert_array_equal(getattr(one, field.name), getattr(two, field.name))


def test_the_plan_says_what_it_costs(many):
    words = plan_certificate(*many).words(1)
    assert words.startswith("certify: 8 lines again by `cyclic`, 24 lines of 30 cells; about ")


def test_a_run_is_certified_from_python_and_its_file_keeps_that(tmp_path):
    results = tyrefrf.run(case_with(), jobs=1, certify=True)
    write_results(tmp_path / "small.h5", results)
    back = load_results(tmp_path / "small.h5").certificate
    for field in fields(back):
        np.testing.assert_array_equal(
            getattr(back, field.name), getattr(results.certificate, field.name)
        )
