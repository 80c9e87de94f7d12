"""A quantity written with its unit is the number in SI, exactly."""

from __future__ import annotations

import contextlib
from typing import Annotated

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from tyrefrf.case import units
from tyrefrf.case.units import Quantity


@pytest.mark.parametrize(
    ("dimension", "text", "number"),
    [
        (units.LENGTH, "14 mm", 0.014),
        (units.LENGTH, "1.4cm", 0.014),
        (units.LENGTH, " 14000 um ", 0.014),
        (units.LENGTH, ".5 m", 0.5),
        (units.STRESS, "2.2 bar", 2.2e5),
        (units.STRESS, "28 MPa", 28e6),
        (units.STRESS, "2e2 GPa", 200e9),
        (units.STRESS, "5 kPa", 5000.0),
        (units.DENSITY, "1.2 g/cm3", 1200.0),
        (units.DENSITY, "1.2 kg/dm3", 1200.0),
        (units.DENSITY, "7.8 t/m3", 7800.0),
        (units.ANGLE, "6 deg", 6.0),
        (units.ANGLE, "3.141592653589793 rad", 180.0),
        (units.FREQUENCY, "2 kHz", 2000.0),
        (units.TIME, "3 us", 3e-6),
        (units.RATE, "0.5 1/s", 0.5),
    ],
)
def test_text_with_unit(dimension, text, number):
    assert Quantity(dimension).read(text) == number


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_bare_number_is_itself(number):
    assert Quantity(units.LENGTH).read(number) == number
    assert Quantity(units.LENGTH).read(f"{number!r} m") == number


@pytest.mark.parametrize(
    "text", ["1e999 m", "nan m", "inf m", "1_000 m", "0x10 m", "1,5 m", "", "m"]
)
def test_what_is_not_a_finite_decimal_number_is_refused(text):
    with pytest.raises(Exception, match=r"finite|not a number|unknown unit 'x10 m'"):
        Quantity(units.LENGTH).read(text)


@given(st.text() | st.sampled_from(["1e9999999999 m", "1" * 1_100_000 + " m"]))
def test_any_text_is_a_number_or_a_validation_error(text):
    adapter = TypeAdapter(Annotated[float, Quantity(units.LENGTH, gt=0)])
    with contextlib.suppress(ValidationError):
        assert adapter.validate_python(text) > 0
