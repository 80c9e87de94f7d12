"""Deflections of the whole tyre: what the probes see in them is the response, by every solver."""

from __future__ import annotations

import numpy as np
import pytest
from small import TEXT, case_with

import tyrefrf
from tyrefrf.errors import ResultsError, SingularError, SolveError
from tyrefrf.results.deflection import at_phase, mode_deflection, phase_of_most
from tyrefrf.solvers import SOLVERS, Recursive
from tyrefrf.solvers.problem import ring_forces
from tyrefrf.study.deflection import deflected, deflections
from tyrefrf.study.model import build_model
from tyrefrf.study.modes import modes

SAME = 1e-12  # the same solver's answer, taken by another way
ROUND_OFF = 1e-9
LINES = [0.0, 40.0, 150.0, 420.0]
INFLATED = ("[cell]", '[inflation]\npressure = "0.5 bar"\n\n[cell]')


@pytest.mark.parametrize("solver", ["recursive", "cyclic", "direct", "auto"])
@pytest.mark.parametrize("change", [(), (INFLATED,), (('"hex8i"', '"hex20"'),)])
def test_probes_see_in_the_field_what_the_responses_say(solver, change):
    case = case_with(("[cell]", f'[solver]\nname = "{solver}"\n\n[cell]'), *change)
    results, model = tyrefrf.run(case, jobs=1), build_model(case)
    free = np.tile(model.problem.free, model.problem.n_cells)
    probes = model.problem.probes[:, : len(model.probes)]
    found = iter(deflections(case, LINES))
    for line in range(len(LINES)):
        for load in range(2):
            seen = probes.T @ (next(found).u.ravel() * free)
            expected = results.receptance[load, :, line]
            np.testing.assert_allclose(seen, expected, atol=SAME * np.abs(expected).max())


def test_there_is_one_for_every_frequency_and_load_in_order():
    found = deflections(case_with(), [150.0, 33.0])
    assert [(d.frequency, d.name) for d in found] == [
        (150.0, "radial"), (150.0, "patch"), (33.0, "radial"), (33.0, "patch"),
    ]  # fmt: skip
    assert [d.stem for d in found[1:3]] == ["patch_150Hz", "radial_33Hz"]
    assert all(d.load.name == d.name for d in found)
    assert max(d.residual for d in found) < ROUND_OFF


def test_a_file_may_be_named(tmp_path):
    (tmp_path / "t.toml").write_text(TEXT)
    (found, _) = tyrefrf.deflections(tmp_path / "t.toml", [10.0])
    assert found.provenance.case_name == "t"
    assert found.provenance.case_text == TEXT


def test_loads_that_differ_in_case_only_have_files_of_their_own():
    case = case_with(('name = "patch"', 'name = "RADIAL"'))
    assert [d.stem for d in deflections(case, [10.0])] == ["radial_10Hz", "RADIAL-2_10Hz"]


class Refusing(Recursive):
    """Has no answer at 40 Hz."""

    def field(self, omega):
        if omega == 2 * np.pi * 40.0:
            raise SingularError("not today")
        return super().field(omega)


def test_a_frequency_without_an_answer_leaves_the_others_theirs(monkeypatch):
    monkeypatch.setitem(SOLVERS, "recursive", Refusing)
    found = list(deflected(case_with(), [10.0, 40.0, 70.0]))
    assert [len(line.deflections) for line in found] == [2, 0, 2]
    before, why, after = (line.failure for line in found)
    assert (before, after) == ("", "")
    assert why.startswith("40 Hz: not today; ")
    with pytest.raises(SolveError, match="40 Hz: not today; "):
        deflections(case_with(), [40.0])


def test_an_untrustworthy_line_is_refused_as_any(monkeypatch):
    monkeypatch.setattr("tyrefrf.solvers.lines.RESIDUAL_MAX", 1e-30)
    (line,) = deflected(case_with(), [40.0])
    assert "40 Hz: no trustworthy solution" in line.failure


@pytest.fixture(scope="module")
def natural():
    case = case_with(INFLATED)
    return build_model(case), modes(case, count=12)


@pytest.mark.parametrize("number", [1, 2, 5, 8])
def test_a_mode_moves_the_whole_ring_by_its_own_equation(natural, number):
    """K phi = omega^2 M phi, loss-free, over the assembled ring."""
    model, found = natural
    problem, motion = model.problem, mode_deflection(found, number)
    cell, omega = problem.cell, 2 * np.pi * motion.frequency
    q = motion.u.reshape(problem.n_cells, cell.n_own, 1)
    K = sum(cell.K.values()) + cell.K_G + cell.K_P
    elastic, inertial = ring_forces(problem, K, q), omega**2 * ring_forces(problem, cell.M, q)
    lack = (elastic - inertial)[:, problem.free]
    assert np.linalg.norm(lack) < 1e-7 * np.linalg.norm(inertial)


@pytest.mark.parametrize("number", [1, 2, 5, 8])
def test_a_mode_has_its_order_around_and_no_other(natural, number):
    model, found = natural
    motion = mode_deflection(found, number)
    waves = np.fft.fft(motion.u.reshape(model.problem.n_cells, -1), axis=0)
    power = np.sum(np.abs(waves) ** 2, axis=1)
    assert power[found.order[number - 1]] == pytest.approx(power.sum(), rel=ROUND_OFF)


def test_a_pair_s_parts_are_equal_and_perpendicular(natural):
    """Standing waves a quarter of a wavelength apart: together they run, and nothing beats."""
    _, found = natural
    number = 1 + int(np.argmax(found.members == 2))
    motion = mode_deflection(found, number)
    real, imag = motion.u.real, motion.u.imag
    assert np.sum(real * imag) == pytest.approx(0.0, abs=ROUND_OFF * np.sum(real**2))
    assert np.sum(imag**2) == pytest.approx(np.sum(real**2), rel=ROUND_OFF)
    assert phase_of_most(motion.u) == 0.0
    assert motion.units["displacement"] == "1/sqrt(kg)"
    assert motion.stem == f"mode_{number}_{motion.frequency:.5g}Hz"


@pytest.mark.parametrize("number", [0, 99])
def test_a_mode_that_is_not_there_is_refused(natural, number):
    with pytest.raises(ResultsError, match=f"no mode {number}; there are: 1 to"):
        mode_deflection(natural[1], number)


@pytest.mark.parametrize("phase", [0.0, 0.7, 2.0, -1.0])
def test_most_motion_is_where_the_squares_are_largest(phase):
    u = np.array([1.0, -2.0, 3.0 + 0.5j]) * np.exp(-1j * phase)
    times = np.linspace(0.0, 2.0 * np.pi, 1001)
    largest = max(np.sum(at_phase(u, t) ** 2) for t in times)
    assert np.sum(at_phase(u, phase_of_most(u)) ** 2) == pytest.approx(largest, rel=1e-4)


def test_a_visible_scale_is_round_and_keeps_the_tyre_in_sight():
    for motion in deflections(case_with(), [40.0, 420.0]):
        size = motion.visible_scale * np.linalg.norm(motion.u, axis=1)
        mantissa = motion.visible_scale / 10.0 ** np.floor(np.log10(motion.visible_scale))
        assert round(mantissa, 9) in (1.0, 2.0, 5.0)
        assert size.max() <= 0.3 * 0.278
        assert np.quantile(size, 0.95) <= 0.08 * 0.278
        assert 2.5 * max(size.max() / 0.3, np.quantile(size, 0.95) / 0.08) >= 0.278
