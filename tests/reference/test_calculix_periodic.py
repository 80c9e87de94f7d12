"""CalculiX's own one-cell decks, read as they are, against what CalculiX computed with them.

Their LEFT leads against our theta, their numbers are theirs, and nothing is sorted beforehand.
"""

from __future__ import annotations

import numpy as np
import pytest
from outside import bricks_of
from reference.calculix import (
    BRICK,
    N_CELLS,
    SECTOR,
    arrays,
    facts,
    needs_reference,
    node_error,
    read_outside,
)
from rings import PAPER, UNDAMPED, Ring, by_recursion

from tyrefrf.fem.elasticity import isotropic
from tyrefrf.fem.elements import ELEMENTS, Element
from tyrefrf.fem.inflation import Inflatable
from tyrefrf.mesh.cut import Side
from tyrefrf.mesh.free_surface import Surface
from tyrefrf.mesh.periodic import CellSets, periodic_cell

pytestmark = needs_reference

MATRICES = 1e-8  # of a node's own displacement; 5e-10 is reached
PRINTED = 2e-6  # seven digits, of the largest displacement
PRESSURE = 2e5

decks = pytest.mark.parametrize(
    ("name", "element", "truth"),
    [("A_C3D8I", BRICK, "frf_direct_cond"), ("A_C3D20-curved", ELEMENTS["hex20"], "frf_direct")],
)
sets = pytest.mark.parametrize("named", [True, False], ids=["named", "found"])


def deck(name: str, element: Element, named: bool) -> Ring:
    """The tyre of a deck, by its own sets or by those that are found."""
    mesh = read_outside(name)
    nodes = {key: Side(mesh.node_sets[key], key) for key in ("RIM", "LEFT", "RIGHT")}
    found = CellSets(nodes["RIM"])
    given = CellSets(
        nodes["RIM"], Surface(mesh.surfaces["INNER"], "INNER"), nodes["LEFT"], nodes["RIGHT"]
    )
    cell = periodic_cell(mesh, bricks_of(mesh), given if named else found, SECTOR)
    return Ring(cell, {"ERUBBER": PAPER}, element, N_CELLS, UNDAMPED)


def of_theirs(tyre: Ring, name: str, nodes: np.ndarray) -> np.ndarray:
    """Our ring node for nodes of their ring; their cells run against ours."""
    mesh = tyre.mesh
    cell, local = np.divmod(nodes, len(arrays(name)["ring_cyl"]))
    number = np.argsort(mesh.numbers)[local]  # theirs run from 1
    right = number >= mesh.n_own
    return (right - cell) % N_CELLS * mesh.n_own + number - right * mesh.n_own


@sets
@decks
def test_responses_are_those_of_calculix(name, element, truth, named):
    tyre, z = deck(name, element, named), arrays(name)
    drive = 3 * of_theirs(tyre, name, np.array([facts(name)["info"]["drive_node"]]))[0]
    loads = tyre.columns({drive: 1.0}, {drive + 2: -1.0}, {drive + 1: 1.0})
    nodes = of_theirs(tyre, name, z["frf_direct_nodes"])
    line = len(z["frf_direct_freq"]) // 2

    q = by_recursion(tyre.problem(loads), 2.0 * np.pi * z["frf_direct_freq"][line])
    u = (tyre.to_cartesian @ q.reshape(-1, 3)).reshape(-1, 3, 3)[nodes].transpose(2, 0, 1)

    assert node_error(u, z[truth][line]).max() < MATRICES


@sets
def test_inflated_shape_is_that_of_calculix(named):
    name, element = "A_C3D20-curved", ELEMENTS["hex20"]
    tyre = deck(name, element, named)
    C = {"ERUBBER": isotropic(PAPER.E, PAPER.nu)}
    shape = facts(name)["inflate_linear_static"]
    expected = np.stack([shape["section_ur"], shape["section_uy"]], axis=1)
    left = of_theirs(tyre, name, np.arange(len(expected))) % tyre.mesh.n_own

    state = Inflatable(tyre.mesh, element, tyre.cell, C, C).linear(PRESSURE)

    u = state.displacement[left]
    assert abs(u[:, :2] - expected).max() < PRINTED * abs(expected).max()
    assert abs(u[:, 2]).max() < 1e-12 * abs(u).max()
