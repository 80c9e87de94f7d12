"""From bricks to the cell's matrices: materials apart, loss and damping on top, the rim held.

Exact: K is a sum over materials, each linear in its E; with C = alpha M + beta K,
D = sum (1 + i eta_m) K_m + i omega C - omega^2 M (the paper's [1] and [23]); a brick of no or
negative volume has no matrices.
"""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from fem.blocks import box, crooked_section, revolve

from tyrefrf.case import Isotropic
from tyrefrf.errors import MeshError
from tyrefrf.fem.assembly import CellMatrices, assemble_cell
from tyrefrf.fem.elasticity import isotropic
from tyrefrf.fem.elements import ELEMENTS, Element
from tyrefrf.mesh.cell import CellMesh

ROUND_OFF = 1e-14  # of the largest entry
RUBBER = Isotropic(E=28e6, nu=0.45, rho=1100.0, eta=0.1)
TREAD = Isotropic(E=400e6, nu=0.3, rho=1500.0, eta=0.05)
DAMPING = SimpleNamespace(alpha=3.0, beta=2e-5)
OMEGA = 2.0 * np.pi * 150.0

all_elements = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS.keys())


def layered(element: Element) -> CellMesh:
    """Six bricks, the outer two of tread; the first section line is the rim."""
    section = crooked_section(element)
    section = replace(
        section,
        material=np.array([0, 0, 0, 0, 1, 1]),
        materials=("rubber", "tread"),
        rim=np.array([0, 1, 2]),
    )
    return revolve(section, np.deg2rad(8.0), 1)


def assembled(element: Element, **materials: Isotropic) -> CellMatrices:
    return assemble_cell(
        layered(element), {"rubber": RUBBER, "tread": TREAD, **materials}, element, DAMPING
    )


@all_elements
def test_stiffness_is_linear_in_the_modulus_of_each_material(element):
    once = assembled(element)
    twice = assembled(element, tread=TREAD.model_copy(update={"E": 2.0 * TREAD.E}))
    largest = np.abs(twice.K["tread"]).max()
    assert np.abs(twice.K["tread"] - 2.0 * once.K["tread"]).max() <= ROUND_OFF * largest
    assert np.array_equal(twice.K["rubber"], once.K["rubber"])


@all_elements
def test_materials_that_are_equal_make_one_body(element):
    mixed = assembled(element, tread=RUBBER)
    mesh = replace(layered(element), material=np.zeros(6, dtype=np.int64), materials=("rubber",))
    plain = assemble_cell(mesh, {"rubber": RUBBER}, element, DAMPING)
    difference = mixed.K["rubber"] + mixed.K["tread"] - plain.K["rubber"]
    assert np.abs(difference).max() <= ROUND_OFF * np.abs(plain.K["rubber"]).max()
    assert np.abs(mixed.M - plain.M).max() <= ROUND_OFF * np.abs(plain.M).max()


@all_elements
def test_dynamic_stiffness_adds_loss_damping_and_inertia(element):
    cell = assembled(element)
    K_rubber, K_tread, M = cell.K["rubber"], cell.K["tread"], cell.M
    loss = 0.1 * K_rubber + 0.05 * K_tread + OMEGA * (3.0 * M + 2e-5 * (K_rubber + K_tread))
    D = cell.dynamic_stiffness(OMEGA)
    assert np.abs(D.real - (K_rubber + K_tread - OMEGA**2 * M)).max() <= ROUND_OFF * abs(D).max()
    assert np.abs(D.imag - loss).max() <= ROUND_OFF * abs(D).max()


@all_elements
def test_the_rim_is_held_in_all_directions(element):
    cell, mesh = assembled(element), layered(element)
    held = np.flatnonzero(cell.fixed.reshape(-1, 3).all(axis=1))
    assert np.array_equal(held, np.sort(mesh.rim))
    assert cell.fixed.sum() == 3 * len(mesh.rim)


@all_elements
def test_an_inverted_brick_is_refused_by_number(element):
    block = box(1, 1, 3)
    upside_down = block.bricks.copy()
    upside_down[1] = upside_down[1][[4, 5, 6, 7, 0, 1, 2, 3]]
    X = replace(block, bricks=upside_down).of(element).X
    with pytest.raises(MeshError, match=r"inverted or flat bricks: 1$"):
        element.stiffness(X, isotropic(1.0, 0.3))
    with pytest.raises(MeshError, match=r"inverted or flat bricks: 1$"):
        element.mass(X, 1.0)
