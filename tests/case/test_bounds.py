"""What a case asks for is bounded, with the place that asks for too much."""

from __future__ import annotations

import pytest

from tyrefrf.case import make_grid, parse_case
from tyrefrf.case.sweep import Range
from tyrefrf.errors import CaseError

PROBES = '[[probes]]\nname = "p{}"\nkind = "region"\ns = [0.1, 0.9]\ndirection = "r"\n'


def messages(make) -> list[str]:
    with pytest.raises(CaseError) as caught:
        make()
    return str(caught.value).splitlines()


def with_changes(text: str, *changes: tuple[str, str]) -> str:
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        (
            [
                ("[geometry]\n", "[geometry]\nelements_along = 2000\nelements_through = 50\n"),
                ("[cell]\n", "[cell]\nelements_around = 11\n"),
            ],
            "t.toml:10: cell.elements_around: 100000 elements in a section make 1100000 in a cell; "
            "must be at most 1000000",
        ),
        (
            [
                ("[geometry]\n", "[geometry]\nelements_along = 2000\n"),
                ("sector_angle = 8", "sector_angle = 0.0036"),
            ],
            "t.toml:9: cell.sector_angle: 100000 cells of 2000 elements make 200000000; must be at "
            "most 100000000",
        ),
    ],
    ids=["elements", "cells"],
)
def test_a_mesh_that_is_too_large_is_refused_at_its_place(small, changes, expected):
    text = with_changes(small, *changes)
    assert messages(lambda: parse_case(text, "t.toml", "small")) == [expected]


def test_points_of_all_probes_are_bounded(small):
    text = small + "".join(f"{PROBES.format(k)}count = [100, 100]\n" for k in range(11))
    assert messages(lambda: parse_case(text, "t.toml", "small")) == [
        "t.toml:16: probes: have 110000 points together; must be at most 100000"
    ]


def test_responses_are_bounded(small):
    text = with_changes(small, ("stop = 2000\nstep = 5", "stop = 400_000\nstep = 0.5"))
    text += f"{PROBES.format(0)}count = [50, 50]\n"
    assert messages(lambda: parse_case(text, "t.toml", "small")) == [
        "t.toml:9: frequency: 800001 lines of 1 loads at 2501 probes, driving points included, "
        "make 2000802501 responses; must be at most 1000000000"
    ]


def test_deflections_of_many_loads_are_bounded(small):
    loads = "".join(f'[[loads]]\nname = "{k}"\ns = 0.5\ndirection = "r"\n' for k in range(100))
    values = ", ".join(str(k + 1.5) for k in range(100))
    text = f"{small}{loads}[output]\ndeflections = [{values}]\n"
    [message] = messages(lambda: parse_case(text, "t.toml", "small"))
    assert message.endswith(
        "output.deflections: make 10100 fields of all loads; must make at most 10000"
    )


def test_a_grid_of_a_million_million_points_is_refused_at_once(small):
    case = parse_case(small, "t.toml", "small")
    values = Range(range=(0.1, 0.2), count=1000)
    wanted = {"eta_rubber": values, "nu_rubber": values, "alpha": values, "beta": values}
    [message] = messages(lambda: make_grid(case, wanted))
    assert message == "case: the grid has more than 10000 points; use fewer"


def test_a_grid_of_many_lines_is_refused_at_once(small):
    text = small.replace("stop = 2000\nstep = 5", "stop = 400_000\nstep = 0.5")
    case = parse_case(text, "t.toml", "small")
    wanted = {"eta_rubber": Range(range=(0.1, 0.2), count=1000), "nu_rubber": (0.3, 0.4)}
    assert messages(lambda: make_grid(case, wanted)) == [
        "case: the grid's 2000 points make 1600002000 responses; must be at most 1000000000: use "
        "fewer points or lines"
    ]
