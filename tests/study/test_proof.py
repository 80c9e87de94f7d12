"""Real tyres prove themselves: with every solver, with loss and without, and not when damaged."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq
from small import case_with

from tyrefrf.case import Frequency
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.results.proof import MEASURES, breaches, passivity, power
from tyrefrf.solvers import SOLVERS, Cyclic, Field
from tyrefrf.solvers.orders import Orders
from tyrefrf.study.model import build_model
from tyrefrf.study.run import run_case

UNDAMPED = ("eta = 0.1", "eta = 0.0")
BESIDE = (1e-3, -1e-4, 1e-5, -1e-6, 1e-7)
"""Of a resonance without loss, relatively. From 1e-6 on residuals rise above 1e-8."""


def with_lines(case, frequency):
    return case.model_copy(update={"frequency": Frequency(values=tuple(map(float, frequency)))})


def by(name):
    return ("[cell]", f'[solver]\nname = "{name}"\n\n[cell]')


def resonances(problem, order):
    """Natural frequencies [Hz] of a circumferential order, dense."""
    cell, orders, mu = problem.cell, Orders(problem.cell), 2.0 * np.pi * order / problem.n_cells
    K, M = (
        orders.matrix(orders.folded(entries.astype(complex)).at(mu)).toarray()
        for entries in (sum(cell.K.values()), cell.M)
    )
    return np.sqrt(eigh(K, M, eigvals_only=True)) / (2.0 * np.pi)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_damped_tyre_takes_power_at_every_line(solver):
    results = run_case(case_with(by(solver)), jobs=1)
    assert breaches(results) == ()
    assert passivity(results)[:, 1:].min() > 0.01
    assert power(results)[1:].min() > 0.001


@pytest.mark.parametrize("solver", SOLVERS)
def test_an_undamped_tyre_gives_no_false_breach_beside_its_resonances(solver):
    case = case_with(UNDAMPED, by(solver))
    found = np.concatenate([resonances(build_model(case).problem, h)[:3] for h in (0, 1, 2, 5)])
    lines = np.unique(found[:, None] * (1.0 + np.array(BESIDE)))
    results = run_case(with_lines(case, lines), jobs=1)
    assert results.n_failed == 0
    assert results.residual.max() > 1e-8
    found = breaches(results)
    assert len(found) == (results.residual > 1e-8).sum()
    assert all(breach.endswith("is above 1e-08") for breach in found)  # and nothing else


def test_an_antiresonance_of_one_undamped_load_is_no_breach():
    """Where the driving point stands still, what is left of Y is rounding, of either sign."""
    text = case_with(UNDAMPED, by("cyclic"))
    case = text.model_copy(update={"loads": text.loads[:1], "probes": ()})
    problem = build_model(case).problem
    solver = Cyclic(problem)

    def H(hertz):
        q = solver.field(2.0 * np.pi * hertz).q
        return float((problem.probes.T @ q.reshape(problem.n_ring_dofs, -1))[0, 0].real)

    hertz = np.linspace(10.0, 400.0, 200)
    responses = np.array([H(x) for x in hertz])
    turns = np.flatnonzero(np.diff(np.sign(responses)) > 0)[0]  # a resonance jumps down
    still = brentq(H, hertz[turns], hertz[turns + 1], xtol=1e-14, rtol=1e-15)
    around = still * (1.0 + np.array([*np.linspace(-1.0, 1.0, 9), 100.0, 1e4, 1e13]) * 1e-14)
    lines = np.unique(np.concatenate([np.linspace(10.0, 0.9 * still, 29), around]))

    results = run_case(with_lines(case, lines), jobs=1)

    Y = results.driving_point("radial")
    assert abs(Y).min() < 1e-9 * abs(Y).max()
    assert breaches(results) == ()


def test_loss_of_the_wrong_sign_is_a_breach_that_its_residual_does_not_show(monkeypatch):
    sound = CellMatrices.dynamic_stiffness
    monkeypatch.setattr(
        CellMatrices, "dynamic_stiffness", lambda cell, omega: sound(cell, omega).conj()
    )
    results = run_case(case_with(), jobs=1)
    assert MEASURES["residual"].worst_of(results).value < 1e-10
    found = breaches(results)
    assert [breach.partition(":")[0] for breach in found] == ["40 Hz", "150 Hz", "420 Hz"]
    assert all("at radial: power comes out" in breach for breach in found)


def test_a_field_that_is_off_is_a_breach_of_its_residual(monkeypatch):
    """One line is moved at random until its residual is 5e-8: far below what is no answer."""

    class Off(Cyclic):
        def field(self, omega):
            sound = super().field(omega)
            if omega < 2.0 * np.pi * 400.0:
                return sound
            push = np.random.default_rng(1).standard_normal(sound.q.shape)
            push[:, ~self.problem.free] = 0.0
            D = self.problem.cell.dynamic_stiffness(omega)
            size = Field.checked(self.problem, D, push).residual
            return Field.checked(self.problem, D, sound.q + 5e-8 / size * push)

    monkeypatch.setitem(SOLVERS, "cyclic", Off)
    results = run_case(case_with(by("cyclic")), jobs=1)
    assert breaches(results) == ("420 Hz: residual 5.0e-08 is above 1e-08",)
