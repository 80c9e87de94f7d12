"""Rigid motions cost no energy, and nothing else is free.

A free elastic body has exactly six strain-free motions, u = t + w x X: K t = 0, all the other
eigenvalues of K are positive. The twenty-node brick integrated at 2x2x2 points is the known
exception: 8 points with 6 strains each give rank 48 at most, of 60 dofs, so a single brick has
60 - 48 = 12 free motions, six of them spurious. A straight row of such bricks keeps some (three
for two bricks, five for four); a crooked row, a layer of two by two and a ring lose them all.
Reference: Hughes, The Finite Element Method, section 4.6 (rank deficiency).
"""

from __future__ import annotations

import numpy as np
import pytest
from fem.blocks import Block, box, cell_of, crooked_section, dense, order_matrix, revolve

from tyrefrf.arrays import FloatArray
from tyrefrf.fem.elasticity import isotropic
from tyrefrf.fem.elements import ELEMENTS, Element

C = isotropic(28e6, 0.45)
FREE = 1e-13  # of the largest eigenvalue is zero; measured: below 2e-16, the next above 6e-10
ROUND_OFF = 1e-14  # of the largest entry of K; measured: below 1e-15

RIGID = 6
FREE_MOTIONS = {"hex8i": RIGID, "hex8": RIGID, "hex20": RIGID, "hex20r": RIGID + 6}
FREE_MOTIONS_OF_STRAIGHT_PAIR = {**FREE_MOTIONS, "hex20r": RIGID + 3}

all_elements = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS.keys())


def crooked(points: FloatArray) -> FloatArray:
    """A smooth distortion that leaves no two edges parallel."""
    x, y, z = points.T
    return points + 0.12 * np.stack(
        [np.sin(2.0 * y + z), np.sin(1.7 * z + 0.6 + x * y), np.cos(1.9 * x - y * z)], axis=1
    )


def body(element: Element, *counts: int) -> tuple[Block, FloatArray]:
    """A crooked block and its stiffness."""
    block = box(*counts).mapped(crooked).of(element)
    return block, block.assembled(element.stiffness(block.X, C)).toarray()


def rigid_motions(points: FloatArray) -> FloatArray:
    """Three translations and three rotations (3n, 6) of the points."""
    turns = [np.cross(axis, points).ravel() for axis in np.eye(3)]
    return np.column_stack([np.tile(np.eye(3), (len(points), 1)), *turns])


def free_motions(K: FloatArray) -> int:
    """How many eigenvalues are zero."""
    values = np.linalg.eigvalsh(K)
    return int(np.sum(np.abs(values) < FREE * values[-1]))


@all_elements
def test_rigid_motions_are_strain_free(element):
    block, K = body(element, 1, 1, 1)
    assert np.abs(K @ rigid_motions(block.points)).max() <= ROUND_OFF * np.abs(K).max()


@pytest.mark.parametrize("name", FREE_MOTIONS)
def test_a_brick_has_six_free_motions_and_the_reduced_one_twelve(name):
    _, K = body(ELEMENTS[name], 1, 1, 1)
    assert free_motions(K) == FREE_MOTIONS[name]


@pytest.mark.parametrize("name", FREE_MOTIONS)
def test_a_straight_pair_of_reduced_bricks_keeps_three_spurious_motions(name):
    element = ELEMENTS[name]
    pair = box(1, 1, 2).of(element)
    K = pair.assembled(element.stiffness(pair.X, C)).toarray()
    assert free_motions(K) == FREE_MOTIONS_OF_STRAIGHT_PAIR[name]


@all_elements
def test_a_ring_one_brick_thick_has_no_spurious_motion(element):
    mesh = revolve(crooked_section(element), 2.0 * np.pi / 8, 1)
    cell = cell_of(mesh, element, 28e6, 0.45, 1100.0)
    K, _ = dense(cell)
    orders = [order_matrix(K, cell.n_face, mu) for mu in 2.0 * np.pi / 8 * np.arange(8)]
    values = np.concatenate([np.linalg.eigvalsh(A) for A in orders])
    assert np.sum(values < FREE * values.max()) == RIGID


@all_elements
@pytest.mark.parametrize("counts", [(1, 1, 2), (1, 2, 2), (2, 2, 2)], ids=str)
def test_an_assembly_has_six_free_motions(element, counts):
    _, K = body(element, *counts)
    assert free_motions(K) == RIGID


@all_elements
def test_stiffness_is_symmetric(element):
    _, K = body(element, 1, 1, 1)
    assert np.abs(K - K.T).max() <= ROUND_OFF * np.abs(K).max()


@all_elements
def test_no_motion_has_negative_energy(element):
    values = np.linalg.eigvalsh(body(element, 1, 1, 2)[1])
    assert values[0] >= -FREE * values[-1]
