"""Regions and exports in a case: what is accepted, and what is said of what is not."""

from __future__ import annotations

import pytest
from small import TEXT, text_with

from tyrefrf.case import RegionProbe, parse_case
from tyrefrf.errors import CaseError

REGION = """
[[probes]]
name = "tread"
kind = "region"
s = [0.3, 0.7]
direction = "r"
"""


def problems(text):
    with pytest.raises(CaseError) as error:
        parse_case(text, "small.toml", "small")
    return str(error.value)


def test_a_region_is_a_whole_turn_unless_it_says_otherwise():
    probe = parse_case(TEXT + REGION, "small.toml", "small").probes[-1]
    assert isinstance(probe, RegionProbe)
    assert (probe.s, probe.angle, probe.count) == ((0.3, 0.7), (0.0, 360.0), (8, 36))
    assert len(list(probe.points())) == 288


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("s = [0.7, 0.3]", r"probes[2].s: first and last are not in order"),
        ("s = [0.3, 1.3]", r"probes[2].s[1]: "),
        ("s = [0.3]", r"probes[2].s: "),
        ("s = [0.3, 0.7]\nangle = [0, 400]", r"probes[2].angle[1]: "),
        ("s = [0.3, 0.7]\nangle = [-90, 300]", "at most 360 deg apart"),
        ("s = [0.3, 0.7]\ncount = [1000, 11]", "11000 points; at most 10000 in a region"),
        ("s = [0.3, 0.7]\ncount = [0, 11]", r"probes[2].count[0]: "),
        ("s = [0.3, 0.7]\ncuont = [2, 11]", "did you mean 'count'"),
    ],
)
def test_a_wrong_region_is_named(change, message):
    assert message in problems(TEXT + REGION.replace("s = [0.3, 0.7]", change))


def test_names_of_a_region_s_points_are_reserved():
    text = text_with(('name = "sidewall"', 'name = "tread.12"')) + REGION
    assert "'tread.12' is reserved for a point of region 'tread'" in problems(text)


def test_formats_are_few_and_each_once():
    case = parse_case(TEXT + '[output]\nexport = ["csv", "mat"]\n', "small.toml", "small")
    assert case.output.export == ("csv", "mat")
    assert "'csv' is listed twice" in problems(TEXT + '[output]\nexport = ["csv", "csv"]\n')
    assert "output.export[0]" in problems(TEXT + '[output]\nexport = ["unv"]\n')
