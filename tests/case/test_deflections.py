"""The frequencies of deflections in a case: units, order, and what is refused."""

from __future__ import annotations

import pytest

from tyrefrf.case import parse_case
from tyrefrf.errors import CaseError

TABLE = """
modulus = { kind = "table", frequencies = [10.0, 500.0], E = [8e7, 9e7], eta = [0.1, 0.2] }
"""


def with_output(small, line):
    return small + f"\n[output]\ndeflections = {line}\n"


def test_they_keep_their_order_and_may_carry_units(small):
    case = parse_case(with_output(small, '["0.25 kHz", 100, "33.5 Hz", 0.0]'), "t.toml", "t")
    assert case.output.deflections == (250.0, 100.0, 33.5, 0.0)


def test_there_are_none_by_default(small):
    assert parse_case(small, "t.toml", "t").output.deflections == ()


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("[100.0, '0.1 kHz']", "output.deflections[1]: 100 Hz is listed twice"),
        ("[-1.0]", "output.deflections[0]: -1.0 Hz is out of range; must be at least 0 Hz"),
        ("['100 rpm']", "output.deflections[0]: unknown unit 'rpm'; use one of Hz, kHz"),
        ("100.0", "output.deflections"),
    ],
)
def test_what_is_wrong_is_named(small, line, words):
    with pytest.raises(CaseError) as caught:
        parse_case(with_output(small, line), "t.toml", "t")
    assert f": {words}" in str(caught.value)


def test_a_table_of_moduli_has_to_reach_over_them(small):
    text = small.replace('E = "80 MPa"\n', TABLE)
    assert text != small
    text = text.replace("stop = 2000", "start = 10\nstop = 400")
    parse_case(with_output(text, "[10.0, 500.0]"), "t.toml", "t")
    with pytest.raises(CaseError, match=r"the frequency line 501 Hz is above the table"):
        parse_case(with_output(text, "[20.0, 501.0]"), "t.toml", "t")
