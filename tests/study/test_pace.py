"""Chunks of lines: short enough that lines are on disk soon, long enough to be worth the way."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefrf.study.spectrum import LONGEST_CHUNK, SOON, Pace

UNKNOWN = np.full(1000, np.nan)


def lengths(pace, n_lines, seconds):
    """How long chunks become where every line takes so many seconds."""
    found = []
    for chunk in pace.chunks(range(n_lines)):
        found.append(len(chunk))
        pace.learn([seconds] * len(chunk))
    return found


@pytest.mark.parametrize(("seconds", "length"), [(2.0, 1), (0.05, 4), (0.01, 20), (1e-6, 64)])
def test_a_chunk_takes_a_fifth_of_a_second_or_one_line(seconds, length):
    first, *others, _ = lengths(Pace(1000, UNKNOWN), 500, seconds)
    assert first == 1
    assert set(others) == {length}
    assert length == max(1, min(round(SOON / seconds), LONGEST_CHUNK))


def test_every_line_is_in_one_chunk():
    chunks = list(Pace(7, np.full(100, 1e-3)).chunks(range(5, 105)))
    assert [line for chunk in chunks for line in chunk] == list(range(5, 105))


def test_few_lines_are_shared_by_all_processes():
    assert lengths(Pace(3, np.full(6, 1e-4)), 6, 1e-4) == [3, 3]


def test_what_lines_took_before_is_known():
    took = UNKNOWN.copy()
    took[:3] = 0.02
    assert lengths(Pace(1000, took), 20, 0.02) == [10, 10]


def test_lines_that_took_no_time_teach_nothing():
    pace = Pace(1000, np.full(10, 0.1))
    pace.learn([0.0, 0.0])
    assert next(iter(pace.chunks(range(10)))) == range(2)
