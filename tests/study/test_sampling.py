"""Which lines are solved of made-up structures, whose responses are known on every line.

H_ij(omega) = sum_k phi_ki phi_kj / (omega_k^2 (1 + i eta) - omega^2): two loads, and as many
probes as points.
"""

import numpy as np
import pytest

from tyrefrf.study.sampling import START, Sampling, Scale

OMEGA = np.linspace(0.0, 1000.0, 1001)
TOLERANCE = 1e-5


def structure(omega, eta=0.05, n_modes=30, n_points=6, seed=0):
    """(n_points, 2, f) responses; the first two points are the loads'."""
    rng = np.random.default_rng(seed)
    natural = np.sort(rng.uniform(50.0, 1100.0, n_modes))
    phi = rng.standard_normal((n_modes, n_points))
    modal = 1.0 / (natural[:, None] ** 2 * (1.0 + 1j * eta) - omega**2)
    return np.einsum("kp,kl,kf->plf", phi, phi[:, :2], modal)


def sampled(H, omega=OMEGA, tolerance=TOLERANCE, first=(), arms=None):
    arms = np.zeros(len(H)) if arms is None else arms
    sampling = Sampling(omega, arms, tolerance, np.array(first, int))
    while len(lines := sampling.next_lines()):
        sampling.add(lines, H[..., lines])
    return sampling


def true_error(sampling, H):
    """The worst error on lines that are not solved, as shares of the driving points' peaks."""
    left = np.flatnonzero(~sampling.solved)
    error = np.abs(sampling.fitted(left) - H[..., left])
    drive = np.abs(H[[0, 1], [0, 1]])[..., None, :]
    slow = (error / drive.max(axis=-1)[None, :, :]).max()
    omega = sampling.omega
    fast = (omega[left] * error / (omega * drive).max(axis=-1)[None, :, :]).max()
    return max(slow, fast)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("seed", range(4))
def test_tolerance_is_kept_from_a_share_of_the_lines(seed, tolerance):
    H = structure(OMEGA, seed=seed)
    sampling = sampled(H, tolerance=tolerance)
    assert not sampling.given_up
    assert sampling.solved.sum() < 0.15 * len(OMEGA)
    assert sampling.held_back_error <= tolerance
    assert true_error(sampling, H) <= tolerance


def test_responses_that_are_zero_by_symmetry_change_no_line():
    """Rounding noise is measured by the driving point, and not fitted."""
    H = structure(OMEGA)
    rng = np.random.default_rng(5)
    peak = np.abs(H[0, 0]).max()
    noise = 1e-16 * peak * rng.standard_normal((3, 2, len(OMEGA)))
    sampling = sampled(np.concatenate([H, noise]))
    assert not sampling.given_up
    assert sampling.solved.sum() <= sampled(H).solved.sum() + 6  # a batch
    assert true_error(sampling, np.concatenate([H, noise])) <= TOLERANCE


def test_a_moment_that_is_zero_is_measured_by_the_forces():
    H = structure(OMEGA)
    rng = np.random.default_rng(5)
    force = 1e6 * H[2:4]  # other units
    noise = 1e-14 * rng.standard_normal((1, 2, len(OMEGA)))
    arms = np.array([0.0] * 6 + [1.0, 1.0, 0.2])
    sampling = sampled(np.concatenate([H, force, noise * np.abs(force).max()]), arms=arms)
    assert not sampling.given_up
    left = np.flatnonzero(~sampling.solved)
    error = np.abs(sampling.fitted(left)[6:8] - force[..., left]).max()
    assert error <= TOLERANCE * np.abs(force).max()


@pytest.mark.parametrize("level", [1e-4, 10.0])
def test_what_is_not_rational_is_given_up_and_solved(level):
    omega = OMEGA[::3]
    H = structure(omega)
    rng = np.random.default_rng(2)
    noise = level * np.abs(H[0, 0]).max() * rng.standard_normal(H.shape)
    sampling = sampled(H + noise, omega)
    assert sampling.given_up
    assert sampling.solved.all()
    assert not sampling.held_back_error <= TOLERANCE


def test_predictions_that_no_longer_improve_end_the_search_long_before_half_of_the_lines():
    H = structure(OMEGA)
    rng = np.random.default_rng(2)
    sampling = sampled(H + 1e-4 * np.abs(H[0, 0]).max() * rng.standard_normal(H.shape))
    assert sampling.given_up
    assert len(sampling.errors) < 40  # of the 79 batches that half of the lines allow


def test_noise_below_the_tolerance_is_no_reason_to_give_up():
    H = structure(OMEGA)
    rng = np.random.default_rng(2)
    noise = 1e-7 * np.abs(H[0, 0]).max() * rng.standard_normal(H.shape) / (1.0 + OMEGA)
    sampling = sampled(H + noise, tolerance=1e-3)
    assert not sampling.given_up
    assert true_error(sampling, H) <= 1e-3


def test_a_resonance_between_lines_is_seen_from_its_flanks():
    """A mode 300 times narrower than the lines' spacing, at none of the first lines."""
    H = structure(OMEGA, n_modes=8)
    narrow = 1e-3 / (613.4**2 * (1.0 + 5e-6j) - OMEGA**2)
    sampling = sampled(H + narrow)
    assert not sampling.given_up
    assert sampling.solved[[613, 614]].any()
    assert true_error(sampling, H + narrow) <= TOLERANCE


def test_lines_that_have_to_be_solved_are():
    H = structure(OMEGA)
    sampling = sampled(H, first=[17, 500, 999])
    assert sampling.solved[[17, 500, 999]].all()


def test_too_many_lines_that_have_to_be_solved_are_all_lines():
    sampling = sampled(structure(OMEGA), first=np.arange(0, 1001, 2))
    assert sampling.given_up
    assert np.isnan(sampling.held_back_error)


def test_lines_that_fail_tell_nothing_and_spoil_nothing():
    H = structure(OMEGA)
    broken = H.copy()
    broken[..., [0, 1000]] = np.nan  # of the first batch, both ends
    sampling = sampled(broken)
    assert not sampling.given_up
    inner = np.flatnonzero(~sampling.solved)
    error = np.abs(sampling.fitted(inner) - H[..., inner]).max()
    assert error <= TOLERANCE * np.abs(H[[0, 1], [0, 1]]).max()


def test_nothing_but_failures_is_solved_to_the_end():
    sampling = sampled(np.full((2, 2, 1001), complex(np.nan, np.nan)))
    assert sampling.given_up
    assert sampling.solved.all()


@pytest.mark.parametrize("omega", [np.geomspace(5.0, 1000.0, 700), np.arange(30.0) ** 2])
def test_any_increasing_lines_will_do(omega):
    H = structure(omega)
    sampling = sampled(H, omega)
    assert true_error(sampling, H) <= TOLERANCE if not sampling.given_up else sampling.solved.all()


def test_first_lines_reach_from_the_first_to_the_last():
    lines = Sampling(OMEGA, np.zeros(2), TOLERANCE, np.empty(0, int)).next_lines()
    assert len(lines) == START
    assert (lines[0], lines[-1]) == (0, 1000)
    assert (np.diff(lines[1:], n=2) >= -1).all()  # narrower apart at low frequencies


def test_receptance_and_mobility_are_measured_by_their_own_peaks():
    omega = np.array([10.0, 20.0, 100.0])
    H = np.array([4.0, 1.0, 0.5])[None, None] + 0j
    weight = Scale.of(omega, H, np.zeros(1)).at(omega)[0, 0]
    np.testing.assert_allclose(weight, [1.0 / 4.0, 20.0 / 50.0, 100.0 / 50.0])
