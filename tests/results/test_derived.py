"""Bands, levels and means over a region against closed forms.

The mean of |X|^2 = f^n over a band from f_1 to f_2 is (f_2^(n+1) - f_1^(n+1))/((n+1)(f_2 - f_1)),
that of a resonance of half-power width B at f_0 is B/2 [arctan(2(f - f_0)/B)] between the edges
over f_2 - f_1.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import synthetic

from tyrefrf.errors import ResultsError
from tyrefrf.results.derived import (
    ISO_1683,
    band_mean_square,
    bands_of,
    in_bands,
    level,
    lines_in,
    reference_of,
    regions_of,
    space_mean_square,
    third_octaves,
)

ROUND_OFF = 1e-12
TRAPEZIUM = (
    1.5e-5  # lines 0.5 Hz apart: n (n - 1)/12 (0.5 Hz/f)^2, 1.2e-5 for f^3 in the 100 Hz band
)
FINE = np.arange(0.0, 1500.0, 0.5)
LOG = np.geomspace(80.0, 1500.0, 4000)


def test_nominal_bands_are_those_of_the_standard():
    """IEC 61260-1, annex E: from 25 Hz to 3.15 kHz."""
    bands = third_octaves(25.0, 3150.0)
    nominal = "25 31.5 40 50 63 80 100 125 160 200 250 315 400 500 630 800 1000 1250 1600 2000 2500"
    np.testing.assert_allclose(bands.nominal, [*map(float, nominal.split()), 3150.0])


def test_three_bands_are_an_octave_of_base_ten_and_edges_meet():
    bands = third_octaves(20.0, 20000.0)
    np.testing.assert_allclose(bands.centre[3:] / bands.centre[:-3], 10.0**0.3)
    np.testing.assert_allclose(bands.upper[:-1], bands.lower[1:])
    np.testing.assert_allclose(bands.lower * bands.upper, bands.centre**2)
    assert bands.centre[bands.nominal == 1000.0] == pytest.approx(1000.0)


@pytest.mark.parametrize("n", [0, 1])
@pytest.mark.parametrize("frequency", [FINE, LOG], ids=["even", "log"])
def test_a_square_that_is_linear_has_its_exact_mean(n, frequency):
    bands = third_octaves(100.0, 1000.0)
    mean = band_mean_square(frequency, frequency**n, bands)
    np.testing.assert_allclose(mean, power_mean(bands, n), rtol=ROUND_OFF)


@pytest.mark.parametrize("n", [2, 3])
@pytest.mark.parametrize("frequency", [FINE, LOG], ids=["even", "log"])
def test_a_power_of_frequency_has_its_mean(n, frequency):
    bands = third_octaves(100.0, 1000.0)
    mean = band_mean_square(frequency, frequency**n, bands)
    np.testing.assert_allclose(mean, power_mean(bands, n), rtol=TRAPEZIUM)


def power_mean(bands, n):
    top = bands.upper ** (n + 1) - bands.lower ** (n + 1)
    return top / (n + 1) / (bands.upper - bands.lower)


@pytest.mark.parametrize(("fraction", "decibels"), [(5, 0.03), (2, 0.2)])
@pytest.mark.parametrize("eta", [0.02, 0.1])
@pytest.mark.parametrize("f_0", [905.0, 1000.0, 1110.0])
def test_a_resonance_is_right_where_its_width_has_lines(fraction, decibels, eta, f_0):
    width = eta * f_0
    frequency = np.arange(500.0, 1600.0, width / fraction)
    bands = third_octaves(1000.0, 1000.0)
    mean = band_mean_square(frequency, 1.0 / (1.0 + (2 * (frequency - f_0) / width) ** 2), bands)
    ends = [np.arctan(2 * (edge - f_0) / width) for edge in (bands.upper, bands.lower)]
    exact = width / 2 * (ends[0] - ends[1]) / (bands.upper - bands.lower)
    assert abs(10 * np.log10(mean / exact)) < decibels


def test_a_flat_spectrum_has_the_same_level_in_every_band():
    bands = bands_of(FINE)
    mean = band_mean_square(FINE, np.full(len(FINE), 4e-6), bands)
    levels = level(mean, reference_of("mobility"))
    covered = (bands.upper <= FINE[-1]) & (lines_in(bands, FINE) > 0)
    np.testing.assert_allclose(levels[covered], 10 * np.log10(4e-6))
    assert covered.sum() > 25


def test_bands_that_the_lines_do_not_cover_are_unknown():
    frequency = np.arange(100.0, 421.0, 5.0)
    bands = bands_of(frequency)
    mean = band_mean_square(frequency, np.ones(len(frequency)), bands)
    assert dict(zip(bands.nominal.tolist(), np.isnan(mean).tolist(), strict=True)) == {
        **{100.0: True, 125.0: False, 160.0: False, 200.0: False, 250.0: False, 315.0: False},
        400.0: True,
    }


def test_a_band_without_a_line_of_its_own_is_unknown():
    frequency = np.arange(0.0, 200.0, 10.0)
    bands = third_octaves(25.0, 40.0)
    assert lines_in(bands, frequency).tolist() == [0, 1, 1]
    mean = band_mean_square(frequency, np.ones(len(frequency)), bands)
    assert np.isnan(mean).tolist() == [True, False, False]


def test_a_failed_line_spoils_its_own_bands_only():
    square = np.where(FINE == 500.0, np.nan, 1.0)
    bands = third_octaves(400.0, 630.0)
    assert np.isnan(band_mean_square(FINE, square, bands)).tolist() == [False, True, False]


def test_the_iso_references_are_ratios_of_those_of_motion_and_force():
    """ISO 1683: 1 pm, 1 nm/s, 1 um/s^2, and 1 uN."""
    values = {quantity: reference.value for quantity, reference in ISO_1683.items()}
    assert values == {"receptance": 1e-6, "mobility": 1e-3, "accelerance": 1.0}
    Y = np.array([2.5e-3])
    velocity = 20 * np.log10(Y / 1e-9)  # of a force of 1 N, whose own level is 120 dB
    found = level(Y**2, reference_of("mobility", "iso1683"))
    np.testing.assert_allclose(found, velocity - 20 * np.log10(1.0 / 1e-6))


def test_a_reference_of_the_user_s_own_has_its_units():
    assert reference_of("mobility", "5e-8").name == "5e-08 m/(s N)"
    assert level(np.array([0.0]), reference_of("mobility")).tolist() != [0.0]


@pytest.mark.parametrize("value", ["-1", "0", "nan", "inf", "loud"])
def test_what_is_no_reference_is_refused(value):
    with pytest.raises(ResultsError, match="no reference"):
        reference_of("mobility", value)


def region(r: float, number: int):
    return replace(synthetic.place(f"tread.{number}", 0.4, "r"), kind="region", r=r)


@pytest.fixture
def with_region():
    """A region of two points, the second twice as far from the axle."""
    probes = (*synthetic.PROBES, region(0.1, 1), region(0.2, 2))
    made = synthetic.results(np.arange(0.0, 1500.0, 2.0), probes=probes)
    receptance = made.receptance.copy()
    receptance[:, -2], receptance[:, -1] = 1e-6, 2e-6j
    return replace(made, receptance=receptance)


def test_points_of_a_region_count_by_the_area_that_they_stand_for(with_region):
    assert regions_of(with_region.probes) == {"tread": [8, 9]}
    mean = space_mean_square(with_region, "tread", "receptance")
    np.testing.assert_allclose(mean, (1.0 * 1e-12 + 2.0 * 4e-12) / 3.0)
    assert mean.shape == (2, 750)


def test_probes_by_name_count_equally(with_region):
    names = ["tread.1", "tread.2"]
    mean = space_mean_square(with_region, names, "receptance")
    np.testing.assert_allclose(mean, 2.5e-12)


def test_one_probe_is_its_own_mean(with_region):
    Y = with_region.response("tangential", "sidewall")
    mean = space_mean_square(with_region, ["sidewall"])[1]
    np.testing.assert_allclose(mean, np.abs(Y) ** 2)


def test_bands_of_a_region_and_of_a_response(with_region):
    bands, mean = in_bands(with_region, "radial", "tread", "receptance")
    known = ~np.isnan(mean)
    assert known.sum() > 20
    np.testing.assert_allclose(mean[known], 3e-12)
    Y = np.abs(with_region.response("radial", "shoulder"))
    _, single = in_bands(with_region, "radial", "shoulder")
    np.testing.assert_array_equal(single, band_mean_square(with_region.frequency, Y**2, bands))


@pytest.mark.parametrize(
    ("region", "message"),
    [
        ("tred", "no region 'tred'.*did you mean 'tread'"),
        (["nowhere"], "no probe"),
        ([], "name at"),
    ],
)
def test_unknown_regions_are_refused(with_region, region, message):
    with pytest.raises(ResultsError, match=message):
        space_mean_square(with_region, region)
