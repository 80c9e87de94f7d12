"""The cells close the turn."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from tyrefrf.case import Cell


@given(st.integers(3, 100_000))
def test_an_angle_written_with_ten_digits_divides_the_turn(n):
    assert Cell(sector_angle=float(f"{360 / n:.10g}")).n_cells == n


@pytest.mark.parametrize("n", [1, 2])
def test_rings_of_one_and_two_cells_need_three_elements(n):
    assert Cell(sector_angle=360 / n, elements_around=3).n_cells == n


@given(st.floats(0.0036, 360.0, exclude_min=True))
def test_the_nearest_angle_that_a_message_gives_is_accepted(angle):
    try:
        Cell(sector_angle=angle, elements_around=3)
    except ValidationError as error:
        message = error.errors()[0]["msg"]
        nearest = float(message.split("nearest: ")[1].split(" deg")[0])
        assert abs(nearest / angle - 1) < 0.5
        Cell(sector_angle=nearest, elements_around=3)
