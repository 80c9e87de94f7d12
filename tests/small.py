"""A small tyre that is solved in milliseconds, as case text and as a case."""

from tyrefrf.case import Case, parse_case

TEXT = """\
title = "Small tyre"

[geometry]
elements_along = 8
material = "rubber"

[materials.rubber]
E = "80 MPa"
nu = 0.42
rho = 1200.0
eta = 0.1

[cell]
sector_angle = 24.0
element = "hex8i"

[frequency]
values = [0.0, 40.0, 150.0, 420.0]

[[loads]]
name = "radial"
s = 0.5
direction = "r"

[[loads]]
name = "patch"
kind = "patch"
s = 0.31
angle = 100.0
direction = "theta"
diameter = "20 mm"

[[probes]]
name = "sidewall"
s = 0.8
angle = 31.0
direction = "y"

[[probes]]
name = "hub"
kind = "hub"
"""


def case_with(*changes: tuple[str, str]) -> Case:
    """The small tyre with parts of its text replaced."""
    return parse_case(text_with(*changes), "small.toml", "small")


def text_with(*changes: tuple[str, str]) -> str:
    """The small tyre's text with parts of it replaced; every part must be there."""
    text = TEXT
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return text
