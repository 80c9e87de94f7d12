"""One tyre, described in the four ways there are, has one set of responses.

The built-in profile, its section in a deck, its cell in a deck and its cell's matrices: the files
are shuffled, renumbered, turned about the axle and in other units and axes, each in its own way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from brought import Style, export
from outside import inp, number_of, outside
from rings import UNDAMPED, Ring
from written import inp_text, shuffled, write

from tyrefrf.case import Case, load_case, parse_case
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.results.results import Results
from tyrefrf.study.model import Model, build_model
from tyrefrf.study.run import run_case

SAME = 1e-9  # of the largest response of a line: condition 1e6 times the files' sixteen digits
TURNED = 0.3  # [rad] about the axle, of the frames of the cell's deck and matrices
TREAD, OFF_CENTRE, SIDEWALL = 9, 13, 5
"""Nodes of the section: left-hand ones and right-hand ones, outside and inside."""
ENTRIES = [
    ("loads", TREAD, 0.0, "r"),
    ("loads", OFF_CENTRE, 72.0, "theta"),
    ("probes", SIDEWALL, 192.0, "y"),
    ("probes", OFF_CENTRE, 312.0, "r"),
]
STUFF = """
[materials.rubber]
E = "80 MPa"
nu = 0.42
rho = 1200.0
eta = 0.1
"""
LINES = """
[damping]
alpha = 4.0
[frequency]
values = [0.0, 60.0, 400.0]
[[probes]]
name = "hub"
kind = "hub"
"""
TABLE = """
[mesh]
kind = "KIND"
file = "KIND.inp"
unit = "UNIT"
axis = "AXIS"
rim = "RIM"
materials = { SET = "rubber" }
"""


@dataclass(frozen=True)
class Tyre:
    """What all descriptions have in common: element, files' unit of length, and pressure."""

    element: str
    unit: str
    pressure: str

    def rest(self, number: Callable[[int], int], turned: float = 0.0) -> str:
        """The part of a case that follows the tyre: cell, lines, and entries at its nodes."""
        text = f'[cell]\nsector_angle = 24.0\nelement = "{self.element}"\n'
        text += LINES
        for k, (table, node, angle, direction) in enumerate(ENTRIES):
            text += f'[[{table}]]\nname = "p{k}"\nkind = "node"\nnode = {number(node)}\n'
            text += f'angle = {angle + float(np.rad2deg(turned))!r}\ndirection = "{direction}"\n'
        return text

    @property
    def stuff(self) -> str:
        """Materials and pressure, of those that are assembled here."""
        return STUFF + f'[inflation]\npressure = "{self.pressure}"\n'

    def built_in(self) -> Case:
        """The tyre of the built-in profile."""
        text = '[geometry]\nelements_along = 8\nmaterial = "rubber"\n' + self.stuff
        return parse_case(text + self.rest(int), "tyre.toml", "tyre")

    def table(self, kind: str, axis: str) -> str:
        """[mesh] of its section or its cell."""
        words = {"KIND": kind, "UNIT": self.unit, "AXIS": axis}
        words["SET"] = {"section": "RUBBER", "cell": "rubber"}[kind]  # as the files have it
        text = TABLE
        for word, value in words.items():
            text = text.replace(word, value)
        return text


def section_deck(tyre: Tyre, model: Model, folder: Path) -> Case:
    written = shuffled(model.mesh.section, 1, tyre.unit, "x")
    write(folder, "section.inp", inp_text(written))
    text = tyre.table("section", "x") + tyre.stuff
    return load_case(write(folder, "tyre.toml", text + tyre.rest(lambda k: written.numbers[k])))


def cell_deck(tyre: Tyre, model: Model, folder: Path) -> Case:
    written = outside(model.mesh, 1, TURNED)
    write(folder, "cell.inp", inp(written, {"m": 1.0, "mm": 1e-3}[tyre.unit], "z"))
    rest = tyre.rest(lambda k: number_of(written, model.mesh, k, TURNED), TURNED)
    return load_case(write(folder, "tyre.toml", tyre.table("cell", "z") + tyre.stuff + rest))


def matrices(tyre: Tyre, model: Model, folder: Path) -> Case:
    """Stiffness under load as its program has it: K of the material, and what pressure adds."""
    materials = model.case.materials
    ring = Ring(model.mesh, materials, ELEMENTS[tyre.element], 15, UNDAMPED)
    cell = model.problem.cell
    cell = replace(cell, K_G=cell.K_G + cell.K_P)
    ring.__dict__["cell"] = cell  # where the cached property keeps it
    units = {"m": "SI", "mm": "mm-t-s"}[tyre.unit]
    brought = export(ring, folder, Style(ending=".npz", units=units, axis="x", start=TURNED))
    head = brought.text.partition("[cell]")[0]
    rest = tyre.rest(lambda k: brought.number[k], TURNED)
    rest = rest.replace(f'element = "{tyre.element}"\n', "")
    rest = rest.replace("alpha = 4.0", "alpha = 0.0")  # C has it already
    return load_case(write(folder, "tyre.toml", head + rest))


@pytest.fixture(
    scope="module",
    params=[("hex8i", "m", "0 bar"), ("hex8i", "mm", "1 bar"), ("hex20r", "mm", "1 bar")],
    ids=lambda given: " ".join(given),
)
def tyre(request) -> Tyre:
    return Tyre(*request.param)


@pytest.fixture(scope="module")
def expected(tyre) -> Results:
    return run_case(tyre.built_in(), jobs=1)


def in_frame(force: np.ndarray, turned: float) -> np.ndarray:
    """Forces and moments (loads, 6, lines) on the hub in a frame turned about the axle [rad]."""
    c, s = np.cos(turned), np.sin(turned)
    turn = np.kron(np.eye(2), [[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    return np.einsum("ij,fjl->fil", turn, force)


@pytest.mark.parametrize(
    ("described", "turned"), [(section_deck, 0.0), (cell_deck, TURNED), (matrices, TURNED)]
)
def test_the_same_tyre_has_the_same_responses(tyre, expected, described, turned, tmp_path):
    """Driving points, transfers and forces on the rim; what pressure does to them included."""
    found = run_case(described(tyre, build_model(tyre.built_in()), tmp_path), jobs=1)

    scale = np.linalg.norm(expected.receptance, axis=(0, 1))
    error = np.linalg.norm(found.receptance - expected.receptance, axis=(0, 1)) / scale
    assert error.max() < SAME
    hub = in_frame(expected.blocked_force, turned)
    assert np.abs(found.blocked_force - hub).max() < SAME * np.abs(hub).max()
