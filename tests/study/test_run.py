"""Whole runs of a small tyre: the same for any number of jobs, and honest about failed lines."""

import numpy as np
import pytest
from small import case_with

import tyrefrf
from tyrefrf.study.run import run_case

RECIPROCITY = 1e-10


@pytest.fixture(scope="module")
def results():
    return run_case(case_with(), jobs=1)


@pytest.mark.parametrize("jobs", [2, 3])
def test_same_bits_for_any_number_of_jobs(results, jobs):
    other = run_case(case_with(), jobs=jobs)
    np.testing.assert_array_equal(other.receptance, results.receptance)
    np.testing.assert_array_equal(other.residual, results.residual)


@pytest.mark.parametrize("solver", ["cyclic", "direct"])
def test_same_answer_by_every_solver(results, solver):
    other = run_case(case_with(("[cell]", f'[solver]\nname = "{solver}"\n\n[cell]')), jobs=1)
    scale = abs(results.receptance).max(axis=(0, 1))
    assert (abs(other.receptance - results.receptance).max(axis=(0, 1)) < 1e-10 * scale).all()


def test_driving_points_absorb_power(results):
    for load in results.loads:
        Y = results.driving_point(load.name)
        assert (Y.real >= -1e-10 * abs(Y)).all()
        assert (Y.real[1:] > 0.0).all()


def test_patch_and_node_are_reciprocal(results):
    H = results.receptance[:, :2]  # loads with driving points
    np.testing.assert_allclose(H, H.transpose(1, 0, 2), atol=RECIPROCITY * abs(H).max(), rtol=0.0)


def test_quantities_differ_by_i_omega(results):
    omega = 2 * np.pi * results.frequency
    H = results.response("radial", "sidewall", "receptance")
    np.testing.assert_allclose(results.response("radial", "sidewall"), 1j * omega * H)
    np.testing.assert_allclose(
        results.response("radial", "sidewall", "accelerance"), -(omega**2) * H
    )


def test_every_line_carries_its_residual(results):
    assert results.solved.all()
    assert results.residual.max() < 1e-12
    assert (results.solve_time > 0.0).all()


def test_progress_counts_every_line():
    counted = []
    run_case(case_with(), jobs=1, progress=counted.append)
    assert sum(counted) == 4


def test_undamped_tyre_gives_no_power_and_fails_nowhere_by_itself():
    results = run_case(case_with(("eta = 0.1", "eta = 0.0")), jobs=1)
    Y = results.driving_point("radial")
    assert abs(Y.real).max() < 1e-10 * abs(Y).max()
    assert results.n_failed == 0


def test_run_takes_a_path(tmp_path):
    from small import TEXT

    path = tmp_path / "tyre.toml"
    path.write_text(TEXT)
    results = tyrefrf.run(path, jobs=1)
    assert results.provenance.case_name == "tyre"
    assert results.provenance.case_text == TEXT
    tyrefrf.write_results(tmp_path / "tyre.h5", results)
    again = tyrefrf.load_results(tmp_path / "tyre.h5")
    np.testing.assert_array_equal(again.mobility, results.mobility)


def test_finer_cells_bring_the_patch_s_mobility_to_rest():
    """A patch's driving point converges as the mesh is refined; a node's keeps falling away."""

    def statics(along, angle):
        results = run_case(
            case_with(
                ("elements_along = 8", f"elements_along = {along}"),
                ("sector_angle = 24.0", f"sector_angle = {angle}"),
                ("values = [0.0, 40.0, 150.0, 420.0]", "values = [0.0]"),
                ('element = "hex8i"', 'element = "hex20"'),
                ("s = 0.31\nangle = 100.0", "s = 0.5\nangle = 0.0"),
                ('direction = "theta"', 'direction = "r"'),
            ),
            jobs=1,
        )
        return [abs(results.driving_point(name, "receptance")[0]) for name in ("radial", "patch")]

    coarse, fine, finest = (np.array(statics(n, a)) for n, a in [(16, 8), (32, 4), (64, 2)])
    node, patch = (finest - fine) / fine
    assert abs(patch) < 0.02
    assert node > 5 * abs(patch)
    assert (fine[0] - coarse[0]) > 0.0
