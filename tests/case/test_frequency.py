"""The lines of a range: both ends, in order, and not one lost to rounding."""

from __future__ import annotations

import re
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tyrefrf.case import Frequency


def test_a_list_is_itself():
    assert Frequency(values=(0, 50.0, 63.5)).lines() == [0, 50.0, 63.5]


def test_a_range_includes_stop_where_the_step_divides_it():
    lines = Frequency(stop=2000, step=5).lines()
    assert (len(lines), lines[0], lines[1], lines[-1]) == (401, 0.0, 5.0, 2000.0)


def test_a_range_ends_before_stop_where_the_step_does_not_divide_it():
    assert Frequency(start=1, stop=2, step=0.4).lines() == [1.0, 1.4, 1.8]


def test_a_step_that_divides_only_in_decimals_still_reaches_stop():
    lines = Frequency(stop=0.3, step=0.1).lines()  # 3 * 0.1 = 0.30000000000000004
    assert lines == [0.0, 0.1, 0.2, 0.3]


def test_a_count_includes_both_ends():
    assert Frequency(start=10, stop=20, count=3).lines() == [10.0, 15.0, 20.0]


def test_a_log_range_has_constant_ratio_and_exact_ends():
    lines = Frequency(start=10, stop=1000, count=5, spacing="log").lines()
    assert (lines[0], lines[-1]) == (10.0, 1000.0)
    assert [b / a for a, b in pairwise(lines)] == pytest.approx([10**0.5] * 4)


@given(st.integers(0, 10**6), st.integers(1, 3000), st.integers(1, 5000))
def test_decimal_ranges_have_every_line_once(start, n, step):
    """In milli-hertz the range is made of integers, so its lines are known exactly."""
    stop = start + n * step
    frequency = Frequency(start=start / 1000, stop=stop / 1000, step=step / 1000)
    expected = [(start + k * step) / 1000 for k in range(n + 1)]
    assert frequency.lines() == pytest.approx(expected, rel=1e-14)
    assert frequency.lines()[-1] == stop / 1000


@given(
    st.floats(1e-3, 1e5),
    st.floats(1.0, 9e5),
    st.integers(2, 1000),
    st.sampled_from(["linear", "log"]),
)
def test_lines_increase_from_start_to_stop(start, width, count, spacing):
    stop = start + width
    if width / (count - 1) < 2e-3:
        count = 2
    lines = Frequency(start=start, stop=stop, count=count, spacing=spacing).lines()
    assert (len(lines), lines[0], lines[-1]) == (count, start, stop)
    assert all(a < b for a, b in pairwise(lines))


def test_a_million_lines_are_allowed():
    assert len(Frequency(stop=99_999.9, step=0.1).lines()) == 1_000_000


@pytest.mark.parametrize(
    ("given", "expected"), [(1e-4, 1e-4), ("20e-3 dB", 10**0.001 - 1), ("0.01dB", 10**0.0005 - 1)]
)
def test_a_tolerance_is_a_share_or_decibels(given, expected):
    assert Frequency(stop=10, step=1, tolerance=given).tolerance == pytest.approx(expected)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (0.5, "0.5 of the peak is out of range; must be at most 0.1 of the peak"),
        (0, "0 of the peak is out of range; must be at least 1e-09 of the peak"),
        ("3 dB", "3 dB is out of range; must be at most 0.1 of the peak"),
        ("1 %", "unknown unit '%'; use one of dB"),
        (True, "true is not a number or text in dB"),
    ],
)
def test_a_tolerance_that_is_none_is_refused(given, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        Frequency(stop=10, step=1, tolerance=given)
