"""Responses that were exported come back as measured ones."""

import numpy as np
import pytest
import synthetic

from tyrefrf.case import MeasuredFile
from tyrefrf.results import read_measured
from tyrefrf.results.export import export

LOAD, PROBE = "radial", "sidewall"
UFF_DIGITS = 1e-11
"""Of the largest value: what pyuff writes of each in ASCII."""


@pytest.fixture(scope="module")
def made():
    return synthetic.results(synthetic.LINES[::10])


def read(directory, **keys):
    table = {"load": LOAD, "probe": PROBE, **keys}
    (curve,) = read_measured([MeasuredFile.model_validate(table)], directory)
    return curve


@pytest.mark.parametrize("quantity", ["receptance", "mobility", "accelerance"])
def test_a_universal_file_comes_back(made, tmp_path, quantity):
    (path,) = export(made, tmp_path / "made", ["uff58"], quantity)
    record = made.pairs.index((LOAD, PROBE)) + 1
    curve = read(tmp_path, file=path.name, record=record)
    expected = made.response(LOAD, PROBE, quantity)
    assert curve.quantity == quantity
    np.testing.assert_allclose(curve.frequency, made.frequency, rtol=1e-9)
    np.testing.assert_allclose(
        curve.response, expected, rtol=0.0, atol=UFF_DIGITS * np.abs(expected).max()
    )


def test_a_table_comes_back_to_the_bit(made, tmp_path):
    path, *_ = export(made, tmp_path / "made", ["csv"])
    pair = f"mobility {LOAD} -> {PROBE}"
    columns = {part: f"{pair} {part} [m/(s N)]" for part in ("real", "imag")}
    curve = read(tmp_path, file=path.name, quantity="mobility", columns=columns)
    np.testing.assert_array_equal(curve.frequency, made.frequency)
    np.testing.assert_array_equal(curve.response, made.response(LOAD, PROBE))
