"""Adaptive lines of small tyres against all lines solved."""

from pathlib import Path

import numpy as np
import pytest
from small import case_with, text_with
from typer.testing import CliRunner

import tyrefrf
from tyrefrf.case import make_grid, parse_case
from tyrefrf.cli.main import app
from tyrefrf.cli.report import describe_run, summary
from tyrefrf.cli.sweeping import describe_sweep, sweep_summary
from tyrefrf.errors import SolveError
from tyrefrf.solvers.modes import ring_modes
from tyrefrf.study import adaptive, spectrum
from tyrefrf.study.model import build_model
from tyrefrf.study.run import run_case
from tyrefrf.study.sweep import run_sweep

CASES = Path(__file__).parents[2] / "cases"
LINES = "values = [0.0, 40.0, 150.0, 420.0]"
CYCLIC = ("[cell]", '[solver]\nname = "cyclic"\n\n[cell]')
RANGE = "stop = 400.0\nstep = 1.0"


def tyre(lines=RANGE, *changes, tolerance=None):
    """The small tyre at some lines, adaptive where there is a tolerance."""
    keys = "" if tolerance is None else f"\nadaptive = true\ntolerance = {tolerance}"
    return case_with((LINES, lines + keys), CYCLIC, *changes)


def largest_error(fitted, solved):
    """Of any response, as a share of the peak of its load's driving point or of the hub's force."""
    errors = []
    for i, load in enumerate(solved.loads):
        for quantity in ("receptance", "mobility"):
            peak = np.abs(solved.driving_point(load.name, quantity)).max()
            difference = getattr(fitted, quantity)[i] - getattr(solved, quantity)[i]
            errors.append(np.abs(difference).max() / peak)
        force = np.abs(solved.blocked_force[i, :3]).max()
        errors.append(np.abs(fitted.blocked_force[i] - solved.blocked_force[i]).max() / force)
    return max(errors)


@pytest.fixture(scope="module")
def solved():
    return run_case(tyre(), jobs=1)


@pytest.fixture(scope="module")
def fitted():
    return run_case(tyre(tolerance=1e-5), jobs=1)


def test_forces_on_the_rim_count_as_such_and_moments_by_their_arm():
    arms = adaptive.rim_arms(build_model(tyre()).problem)
    displacements, forces, moments = np.split(arms, [3, 6])
    np.testing.assert_array_equal(displacements, 0.0)
    np.testing.assert_allclose(forces, 1.0, rtol=0.01)  # 15 cells: cos of up to 6 degrees
    np.testing.assert_allclose(moments, 0.168, rtol=0.02)  # the rim's radius


def test_few_lines_give_them_all(solved, fitted):
    numbers = fitted.provenance.numbers
    assert numbers["solved_lines"] == fitted.solved.sum() < 0.15 * len(fitted.frequency)
    assert numbers["fit_error"] <= numbers["fit_tolerance"] == 1e-5
    assert largest_error(fitted, solved) <= 1e-5


def test_solved_lines_are_those_of_a_run_of_all(solved, fitted):
    here = fitted.solved
    np.testing.assert_array_equal(fitted.receptance[..., here], solved.receptance[..., here])
    np.testing.assert_array_equal(fitted.residual[here], solved.residual[here])


def test_a_fitted_line_has_an_answer_and_neither_residual_nor_time_nor_remark(fitted):
    left = ~fitted.solved
    assert fitted.n_failed == 0
    assert np.isnan(fitted.residual[left]).all()
    assert np.isnan(fitted.solve_time[left]).all()
    assert not np.isnan(fitted.residual[fitted.solved]).any()
    assert set(fitted.remark) == {""}


def test_driving_points_of_fitted_lines_absorb_power(fitted):
    Y = fitted.mobility[[0, 1], [0, 1]]
    assert (Y.real >= -1e-5 * np.abs(Y).max(axis=1, keepdims=True)).all()


@pytest.mark.parametrize("jobs", [2, 3])
def test_same_lines_and_bits_for_any_number_of_jobs(fitted, jobs):
    other = run_case(tyre(tolerance=1e-5), jobs=jobs)
    np.testing.assert_array_equal(other.solved, fitted.solved)
    np.testing.assert_array_equal(other.receptance, fitted.receptance)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-7])
@pytest.mark.parametrize("seed", range(3))
def test_tolerance_is_kept_on_random_tyres(seed, tolerance):
    rng = np.random.default_rng(seed)
    changes = (
        ("elements_along = 8", f"elements_along = {rng.integers(2, 6) * 2}"),
        ("sector_angle = 24.0", f"sector_angle = {rng.choice([40.0, 30.0, 24.0])}"),
        ('E = "80 MPa"', f'E = "{rng.uniform(10.0, 200.0):.3f} MPa"'),
        ("eta = 0.1", f"eta = {10.0 ** rng.uniform(-2.5, -0.5):.4f}"),
        ("s = 0.5\n", f"s = {rng.uniform(0.3, 0.7):.3f}\n"),
    )
    found = run_case(tyre(RANGE, *changes, tolerance=tolerance), jobs=1)
    assert found.solved.sum() < len(found.frequency)
    assert largest_error(found, run_case(tyre(RANGE, *changes), jobs=1)) <= tolerance


@pytest.mark.parametrize("eta", [1e-3, 0.0])
def test_no_resonance_of_a_lightly_damped_tyre_is_missed(eta):
    change = ("eta = 0.1", f"eta = {eta}")
    lines = "stop = 350.0\nstep = 0.5"
    found = run_case(tyre(lines, change, tolerance=1e-5), jobs=1)
    assert found.provenance.numbers["narrow_lines"] > 20
    assert found.solved.sum() < 0.2 * len(found.frequency)
    assert largest_error(found, run_case(tyre(lines, change), jobs=1)) <= 1e-5


def test_lines_on_both_sides_of_narrow_resonances_are_solved():
    case = tyre("stop = 300.0\nstep = 0.5", ("eta = 0.1", "eta = 0.001"), tolerance=1e-3)
    found = run_case(case, jobs=1)
    modes = ring_modes(build_model(case).problem.cell, 15, below=found.omega[-1])
    natural = np.concatenate([order.omega for order in modes])
    after = np.searchsorted(found.omega, natural)
    assert len(natural) > 10
    assert found.solved[after].all()
    assert found.solved[after - 1].all()


def test_more_narrow_resonances_than_lines_for_them_are_all_lines():
    lines = "start = 150.0\nstop = 450.0\nstep = 5.0"
    found = run_case(tyre(lines, ("eta = 0.1", "eta = 0.001"), tolerance=1e-5), jobs=1)
    assert found.solved.all()
    assert "too narrow to be fitted" in describe_run(summary(found, []))


def test_what_cannot_be_fitted_is_solved_and_said(monkeypatch):
    """Another tyre on every line: nothing that a rational function could follow."""
    exact = spectrum.answer

    def shaken(problem, solver, omega):
        line = exact(problem, solver, omega)
        rng = np.random.default_rng(int(omega * 1e3))
        shake = 1.0 + 0.1 * rng.standard_normal(line.receptance.shape)
        return type(line)(line.receptance * shake, line.residual)

    monkeypatch.setattr(spectrum, "answer", shaken)
    found = run_case(tyre("stop = 400.0\nstep = 4.0", tolerance=1e-5), jobs=1)
    assert found.solved.all()
    assert found.provenance.numbers["fit_error"] > 1e-3
    assert "all solved: the fit was not trusted" in describe_run(summary(found, []))


def test_a_tyre_whose_modes_cannot_be_counted_has_all_lines_solved(monkeypatch):
    def fails(*_):
        raise SolveError("buckled")

    monkeypatch.setattr(adaptive, "modes_below", fails)
    found = run_case(tyre("stop = 400.0\nstep = 4.0", tolerance=1e-5), jobs=1)
    assert found.solved.all()
    assert "could not be counted" in describe_run(summary(found, []))


@pytest.mark.parametrize(
    "lines",
    [
        "values = [120.0]",
        "values = [0.0, 120.0]",
        "values = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0]",
    ],
)
def test_few_lines_are_all_solved(lines):
    found = run_case(tyre(lines, tolerance=1e-5), jobs=1)
    assert found.solved.all()
    np.testing.assert_array_equal(found.receptance, run_case(tyre(lines), jobs=1).receptance)
    assert "too few to be fitted" in describe_run(summary(found, []))


def test_log_spaced_lines():
    lines = 'start = 1.0\nstop = 500.0\ncount = 300\nspacing = "log"'
    found = run_case(tyre(lines, tolerance=1e-4), jobs=1)
    assert found.solved.sum() < 0.4 * len(found.frequency)
    assert largest_error(found, run_case(tyre(lines), jobs=1)) <= 1e-4


def test_rubber_that_depends_on_frequency_is_fitted_too():
    zener = (
        'E = "80 MPa"\nnu = 0.42\nrho = 1200.0\neta = 0.1',
        "nu = 0.42\nrho = 1200.0\nmodulus = "
        '{ kind = "zener", E_0 = 30e6, E_inf = 3e9, alpha = 0.6, tau = 1e-6 }',
    )
    found = run_case(tyre(RANGE, zener, tolerance=1e-5), jobs=1)
    assert found.solved.sum() < 0.2 * len(found.frequency)
    assert largest_error(found, run_case(tyre(RANGE, zener), jobs=1)) <= 1e-5


def test_every_point_of_a_sweep_is_a_run_of_its_own():
    grid = make_grid(tyre(tolerance=1e-4), {"E_rubber": (4e7, 8e7)})
    swept = run_sweep(grid, jobs=2)
    for point, case in zip(swept.points, grid.cases, strict=True):
        alone = run_case(case, jobs=1)
        np.testing.assert_array_equal(point.solved, alone.solved)
        np.testing.assert_array_equal(point.receptance, alone.receptance)


def test_progress_counts_every_line():
    counted = []
    run_case(tyre(tolerance=1e-4), jobs=1, progress=counted.append)
    assert sum(counted) == 401


def test_files_keep_what_was_solved_and_how_wrong_the_rest_is(fitted, tmp_path):
    tyrefrf.write_results(tmp_path / "fitted.h5", fitted)
    again = tyrefrf.load_results(tmp_path / "fitted.h5")
    np.testing.assert_array_equal(again.solved, fitted.solved)
    assert again.provenance.numbers == fitted.provenance.numbers
    assert again.n_failed == 0


def test_the_command_line_says_what_was_solved(tmp_path):
    keys = RANGE + '\nadaptive = true\ntolerance = "0.001 dB"'
    (tmp_path / "tyre.toml").write_text(text_with((LINES, keys), CYCLIC))
    arguments = ["run", str(tmp_path / "tyre.toml"), "--jobs", "1", "--output", str(tmp_path)]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    assert "solved, the others fitted: error on held-back lines" in done.output
    assert "nan" not in done.output


def test_a_sweep_says_of_every_point_what_was_solved():
    swept = run_sweep(make_grid(tyre(tolerance=1e-4), {"E_rubber": (4e7, 8e7)}), jobs=1)
    words = describe_sweep(sweep_summary(swept, []) | {"seconds": 1.0})
    assert words.count("solved, the others fitted: error on held-back lines") == 2
    assert "nan" not in words


@pytest.mark.long
def test_the_paper_s_tyre_in_1_hz_steps_takes_at_most_150_lines():
    text = (CASES / "homogeneous.toml").read_text().replace("step = 5.0", "step = 1.0")
    text += '\n[solver]\nname = "cyclic"\n'
    keys = ("step = 1.0", "step = 1.0\nadaptive = true")
    found = run_case(parse_case(text.replace(*keys), "tyre.toml", "tyre"))
    assert found.solved.sum() <= 150
    solved = run_case(parse_case(text, "tyre.toml", "tyre"))
    assert len(solved.frequency) == 2001
    assert largest_error(found, solved) <= 1e-5
