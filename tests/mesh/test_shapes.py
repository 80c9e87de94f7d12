"""Shape functions of lines, quadrilaterals and bricks.

Exact properties: each function is one at its own node and zero at the others; they sum to one;
they reproduce every linear field, and those with mid-sides every quadratic one; their gradients are
their slopes. In straight-sided bricks that are parallelepipeds quadratic fields of x, y, z are
quadratic in the natural coordinates too, so the twenty-node brick reproduces them.
Reference: Zienkiewicz & Taylor, The Finite Element Method, vol. 1, chapter 6.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
import pytest

from tyrefrf.arrays import FloatArray
from tyrefrf.mesh.shapes import HEX8, HEX20, LINE2, LINE3, QUAD4, QUAD8, shape

FAMILIES = {
    "LINE2": LINE2,
    "LINE3": LINE3,
    "QUAD4": QUAD4,
    "QUAD8": QUAD8,
    "HEX8": HEX8,
    "HEX20": HEX20,
}
QUADRATIC = ("LINE3", "QUAD8", "HEX20")
ROUND_OFF = 1e-14  # of sums of at most twenty terms of size one
STEP = 1e-5  # central differences err by STEP^2 * third derivative, and by eps/STEP
SLOPE_ERROR = 1e-9

families = pytest.mark.parametrize("nodes", FAMILIES.values(), ids=FAMILIES.keys())
quadratic = pytest.mark.parametrize("nodes", [FAMILIES[k] for k in QUADRATIC], ids=QUADRATIC)


def somewhere(nodes: FloatArray, count: int = 40) -> FloatArray:
    """Points (count, d) inside the natural line, square or cube."""
    return np.random.default_rng(1).uniform(-1.0, 1.0, (count, nodes.shape[1]))


def monomials(x: FloatArray, degree: int) -> FloatArray:
    """All products (n, m) of at most `degree` coordinates (n, d)."""
    with_one = np.column_stack([np.ones(len(x)), x])
    choices = combinations_with_replacement(range(with_one.shape[1]), degree)
    return np.column_stack([np.prod(with_one[:, list(choice)], axis=1) for choice in choices])


@families
def test_one_at_its_own_node_and_zero_at_the_others(nodes):
    N, _ = shape(nodes, nodes)
    assert np.array_equal(N, np.eye(len(nodes)))


@families
def test_functions_sum_to_one_and_gradients_to_zero(nodes):
    N, dN = shape(nodes, somewhere(nodes))
    assert np.abs(N.sum(axis=1) - 1.0).max() <= ROUND_OFF
    assert np.abs(dN.sum(axis=1)).max() <= ROUND_OFF


@families
def test_linear_fields_are_reproduced(nodes):
    xi = somewhere(nodes)
    N, _ = shape(nodes, xi)
    assert np.abs(N @ monomials(nodes, 1) - monomials(xi, 1)).max() <= ROUND_OFF


@quadratic
def test_quadratic_fields_are_reproduced(nodes):
    xi = somewhere(nodes)
    N, _ = shape(nodes, xi)
    assert np.abs(N @ monomials(nodes, 2) - monomials(xi, 2)).max() <= ROUND_OFF


@pytest.mark.parametrize(
    ("name", "axis"), [(name, axis) for name, a in FAMILIES.items() for axis in range(a.shape[1])]
)
def test_gradients_are_the_slopes(name, axis):
    nodes = FAMILIES[name]
    xi = somewhere(nodes)
    ahead, behind = xi.copy(), xi.copy()
    ahead[:, axis] += STEP
    behind[:, axis] -= STEP
    slope = (shape(nodes, ahead)[0] - shape(nodes, behind)[0]) / (2.0 * STEP)
    assert np.abs(shape(nodes, xi)[1][:, :, axis] - slope).max() <= SLOPE_ERROR


def test_twenty_nodes_reproduce_quadratic_fields_in_a_parallelepiped():
    edges = np.array([[1.0, 0.2, -0.1], [0.3, 0.8, 0.2], [-0.2, 0.1, 1.3]])
    xi = somewhere(HEX20)
    N, _ = shape(HEX20, xi)
    assert np.abs(N @ monomials(HEX20 @ edges, 2) - monomials(xi @ edges, 2)).max() <= ROUND_OFF


@pytest.mark.parametrize(("few", "many"), [(LINE2, LINE3), (QUAD4, QUAD8), (HEX8, HEX20)])
def test_corners_come_first(few, many):
    assert np.array_equal(many[: len(few)], few)
    assert np.all(np.sum(many[len(few) :] == 0.0, axis=1) == 1)


def test_mid_sides_stand_in_abaqus_order():
    ends = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
    ends += [(0, 4), (1, 5), (2, 6), (3, 7)]
    assert np.array_equal(HEX20[8:], [(HEX8[a] + HEX8[b]) / 2.0 for a, b in ends])
