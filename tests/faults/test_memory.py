"""Estimates of memory are honest: at least 0.9, at most 1.5 of what a study takes at its peak."""

from __future__ import annotations

import sys

import pytest

from tests.faults.memory import LEAST, MOST, STUDIES, row_of

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="peaks are read from /proc")


def is_honest(study) -> bool:
    row = row_of(study)
    assert LEAST <= row.ratio <= MOST, row
    return True


def test_of_a_small_tyre():
    assert is_honest(STUDIES[0])


@pytest.mark.long
@pytest.mark.parametrize("study", STUDIES[1:], ids=lambda study: study.words)
def test_of_every_command_and_solver(study):
    assert is_honest(study)
