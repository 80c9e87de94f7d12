"""A small valid case; tests change one thing in it."""

from __future__ import annotations

from pathlib import Path

import pytest

SMALL = """\
[geometry]
material = "rubber"
[materials.rubber]
E = "80 MPa"
nu = 0.42
rho = 1200
[cell]
sector_angle = 8
[frequency]
stop = 2000
step = 5
[[loads]]
name = "radial"
s = 0.5
direction = "r"
"""


@pytest.fixture
def small() -> str:
    return SMALL


@pytest.fixture
def shipped() -> Path:
    return Path(__file__).parents[2] / "cases"
