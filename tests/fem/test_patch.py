"""Patch test: a crooked patch of bricks must carry every constant strain exactly.

A unit cube of seven bricks, six of them distorted around a distorted seventh, has the linear
displacement u = eps x imposed on its surface. Exact solution: the same u inside, and on the
surface the nodal forces of the constant stress lambda tr(eps) I + 2 mu eps. On a square face they
are 1/4 of the face's pull at each corner of a four-node face, and -1/12 and 1/3 of it at corners
and mid-sides of an eight-node one.
Reference: MacNeal & Harder, A proposed standard set of problems to test finite element accuracy,
Finite Elements in Analysis and Design 1 (1985), 3-20, patch test for solids.
"""

from __future__ import annotations

import numpy as np
import pytest
from fem.blocks import Block, on_surface, solve

from tyrefrf.arrays import FloatArray
from tyrefrf.fem.elasticity import isotropic
from tyrefrf.fem.elements import ELEMENTS, Element, Incompatible
from tyrefrf.mesh.shapes import HEX8

E, NU = 1e6, 0.25  # MacNeal & Harder's
MU, LAMBDA = E / (2.0 * (1.0 + NU)), E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU))
C = isotropic(E, NU)
INNER = [
    [0.249, 0.342, 0.192],
    [0.826, 0.288, 0.288],
    [0.850, 0.649, 0.263],
    [0.273, 0.750, 0.230],
    [0.320, 0.186, 0.643],
    [0.677, 0.305, 0.683],
    [0.788, 0.693, 0.644],
    [0.165, 0.745, 0.702],
]
FACES = [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [3, 2, 6, 7], [0, 3, 7, 4], [1, 5, 6, 2]]
"""Corners of the cube's faces, turning about the inward normal."""
PATCH = Block(
    np.vstack([(HEX8 + 1.0) / 2.0, INNER]),
    np.array([[8, 9, 10, 11, 12, 13, 14, 15], *(face + [8 + a for a in face] for face in FACES)]),
)
STRAINS = {"xx": 0, "yy": 1, "zz": 2, "xy": 3, "yz": 4, "zx": 5}
SIZE = 1e-3  # of the strain: any, the problem is linear
ROUND_OFF = 1e-13  # relative; measured: 6e-15 at most

everywhere = pytest.mark.parametrize("strain", STRAINS.values(), ids=STRAINS.keys())
all_elements = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS.keys())


def tensor(strain: int) -> FloatArray:
    """The symmetric strain tensor (3, 3) whose only strain component is the given one."""
    i, j = ("xyz".index(axis) for axis in list(STRAINS)[strain])
    eps = np.zeros((3, 3))
    eps[i, j] = eps[j, i] = SIZE if i == j else SIZE / 2.0
    return eps


def stretched(element: Element, strain: int) -> tuple[Block, FloatArray, FloatArray, FloatArray]:
    """The patch, its exact and its computed displacements (n, 3), and the computed nodal forces."""
    patch = PATCH.of(element)
    exact = patch.points @ tensor(strain)
    K = patch.assembled(element.stiffness(patch.X, C))
    known = np.repeat(on_surface(patch.points), 3)
    u = solve(K, np.zeros(len(known)), known, exact.ravel())
    return patch, exact, u.reshape(-1, 3), (K @ u).reshape(-1, 3)


def pull_of_constant_stress(patch: Block, stress: FloatArray, quadratic: bool) -> FloatArray:
    """Nodal forces (n, 3) of a constant stress (3, 3) on the cube's six faces."""
    forces = np.zeros_like(patch.points)
    for axis in range(3):
        for side in (0.0, 1.0):
            face = patch.points[:, axis] == side
            corner = np.all((patch.points == 0.0) | (patch.points == 1.0), axis=1)
            share = np.where(corner, -1.0 / 12.0, 1.0 / 3.0) if quadratic else 0.25
            forces += np.outer(face * share, (2.0 * side - 1.0) * stress[axis])
    return forces


@all_elements
@everywhere
def test_interior_follows_the_imposed_strain(element, strain):
    _, exact, u, _ = stretched(element, strain)
    assert np.abs(u - exact).max() <= ROUND_OFF * np.abs(exact).max()


@all_elements
@everywhere
def test_surface_is_pulled_as_by_the_constant_stress(element, strain):
    patch, _, _, forces = stretched(element, strain)
    eps = tensor(strain)
    stress = LAMBDA * np.trace(eps) * np.eye(3) + 2.0 * MU * eps
    expected = pull_of_constant_stress(patch, stress, element.n_nodes == 20)
    assert np.abs(forces - expected).max() <= ROUND_OFF * np.abs(expected).max()


@all_elements
@everywhere
def test_strain_is_the_same_at_every_gauss_point(element, strain):
    patch, _, u, _ = stretched(element, strain)
    B, _ = element.strain(patch.X)
    eps = np.einsum("egvn,en->egv", B, u[patch.bricks].reshape(len(B), -1))
    expected = SIZE * np.eye(6)[strain]
    assert np.abs(eps - expected).max() <= ROUND_OFF * SIZE


@everywhere
def test_incompatible_modes_stay_asleep(strain):
    element = ELEMENTS["hex8i"]
    patch = PATCH.of(element)
    B_m, dV = element.mode_strain(patch.X), element.strain(patch.X)[1]
    drive = np.einsum("egvm,v,eg->em", B_m, C[:, strain] * SIZE, dV)
    assert np.abs(drive).max() <= ROUND_OFF * np.abs(C).max() * SIZE


@everywhere
def test_without_taylors_correction_the_patch_fails(strain):
    _, exact, u, _ = stretched(Incompatible(corrected=False), strain)
    assert np.abs(u - exact).max() > 0.01 * np.abs(exact).max()  # measured: 0.037 to 0.073
