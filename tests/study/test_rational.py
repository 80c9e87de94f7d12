"""Fits to responses that are rational: sums of residues over poles, known exactly.

f(x) = sum_k r_k / (p_k - x), with poles p_k off the real axis as those of a damped structure.
"""

import numpy as np
import pytest

from tyrefrf.study.rational import fit

EXACT = 1e-11
"""Relative to the largest response: rounding, times what lies between the samples."""


def poles(n, seed=0):
    rng = np.random.default_rng(seed)
    return np.sort(rng.uniform(0.0, 1.0, n)) + 1j * rng.uniform(0.005, 0.05, n)


def sums(x, p, n_responses, seed=1):
    """(len(x), n_responses) responses with the poles p in common."""
    rng = np.random.default_rng(seed)
    residues = rng.standard_normal((2, len(p), n_responses))
    values = (1.0 / (p - x[:, None])) @ (residues[0] + 1j * residues[1])
    return values / 1000.0


def fitted(x, values, tolerance=1e-14, start=()):
    return fit(x, values, np.ones(values.shape), tolerance, start)


@pytest.mark.parametrize("n_responses", [1, 5, 40])
def test_rational_functions_are_recovered(n_responses):
    p, x, between = poles(8), np.linspace(0.0, 1.0, 40), np.linspace(0.0, 1.0, 997)
    values, expected = sums(x, p, n_responses), sums(between, p, n_responses)
    found = fitted(x, values)
    error = np.abs(found.basis(between) @ values[found.support] - expected).max()
    assert error < EXACT * np.abs(expected).max()


def test_as_many_poles_are_found_as_there_are_and_where_they_are():
    p, x = poles(8), np.linspace(0.0, 1.0, 40)
    found = fitted(x, sums(x, p, 5), tolerance=1e-12)
    near = found.poles()[np.argmin(np.abs(found.poles() - p[:, None]), axis=1)]
    np.testing.assert_allclose(near, p, atol=1e-9)
    assert len(found.z) <= len(p) + 2


def test_residues_are_those_of_the_function():
    p, x = poles(6), np.linspace(0.0, 1.0, 40)
    values = sums(x, p, 3)
    found = fitted(x, values, tolerance=1e-12)
    at = p + 1e-7
    expected = sums(at, p, 3) * (at - p)[:, None]
    near = found.poles()[np.argmin(np.abs(found.poles() - p[:, None]), axis=1)]
    residues = found.residues(near) @ values[found.support]
    np.testing.assert_allclose(residues, expected, rtol=1e-4)  # of the other poles, 1e-7 away


def test_support_values_are_taken_to_the_bit():
    x = np.linspace(0.0, 1.0, 30)
    found = fitted(x, sums(x, poles(8), 4))
    expected = (np.arange(30) == found.support[:, None]).astype(complex)
    np.testing.assert_array_equal(found.basis(found.z), expected[:, found.support])


def test_common_poles_need_fewer_samples_than_one_response_alone():
    """2 n samples for n poles of one response, little more than n for those of many."""
    p, between = poles(12), np.linspace(0.0, 1.0, 997)
    x = np.linspace(0.0, 1.0, 18)
    values, expected = sums(x, p, 8), sums(between, p, 8)
    together, alone = fitted(x, values), fitted(x, values[:, :1])
    error = np.abs(together.basis(between) @ values[together.support] - expected).max()
    worse = np.abs(alone.basis(between) @ values[alone.support, :1] - expected[:, :1]).max()
    assert error < 1e-8 * np.abs(expected).max()
    assert worse > 1e-4 * np.abs(expected).max()


def test_an_error_that_counts_more_is_made_smaller():
    x = np.linspace(0.0, 1.0, 60)
    values = np.exp(6.0j * x[:, None]) / (1.0 + 25.0 * (x[:, None] - 0.5) ** 2)
    plain = fit(x, values, np.ones((60, 1)), 1e-3)
    strict = fit(x, values, np.full((60, 1), 1e4), 1e-3)
    assert len(strict.z) > len(plain.z)
    assert np.abs(strict.basis(x) @ values[strict.support] - values).max() < 1e-7


def test_a_constant_has_no_pole():
    x = np.linspace(0.0, 1.0, 10)
    found = fitted(x, np.ones((10, 2), complex))
    assert len(found.poles()) == 0
    np.testing.assert_array_equal(found.basis(x), 1.0)
