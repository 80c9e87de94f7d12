"""The cell's own K and M against those that CalculiX 2.20 assembled for the same bricks.

`A_C3D8I_cellmat.npz` (written by ccx, Cartesian, no supports) keeps the incompatible modes as
unknowns. Condensed statically they must give the K of our brick without Taylor's factor; the mass
of the nodes must be ours on 2x2x2 points. See ../shared/reference/README.md, "Element formulas".
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from reference.calculix import BRICK, SECTOR, condensed_cell, needs_reference, ring

from tyrefrf.fem.elements import ELEMENTS

pytestmark = needs_reference

NAME = "A_C3D8I"
WRITTEN = 1e-11  # coordinates of 13 digits; 3e-14 is reached


@pytest.fixture(scope="module")
def theirs():
    return condensed_cell(NAME)


def our_matrix(letter, element, dofs):
    """Our cell's matrix in their Cartesian axes and numbering."""
    tyre = ring(NAME, element)
    cell, mesh = tyre.cell, tyre.mesh
    A = cell.sparse(cell.M if letter == "M" else cell.K["rubber"]).toarray()
    theta = mesh.points[:, 2] - SECTOR
    axes = np.zeros((mesh.n_nodes, 3, mesh.n_nodes, 3))
    n = np.arange(mesh.n_nodes)
    axes[n, 0, n, 0] = axes[n, 2, n, 2] = np.cos(theta)
    axes[n, 2, n, 0] = np.sin(theta)
    axes[n, 0, n, 2] = -np.sin(theta)
    axes[n, 1, n, 1] = 1.0
    T = axes.reshape(A.shape)
    ours = (dofs[:, 0] + mesh.n_face) % mesh.n_nodes  # their LEFT is our right section
    rows = 3 * ours + dofs[:, 1]
    return (T @ A @ T.T)[np.ix_(rows, rows)]


def largest_difference(A, B):
    return np.abs(A - B).max() / np.abs(B).max()


def test_stiffness_is_theirs(theirs):
    K, _, dofs = theirs
    assert largest_difference(our_matrix("K", BRICK, dofs), K) < WRITTEN


def test_mass_is_theirs(theirs):
    _, M, dofs = theirs
    assert largest_difference(our_matrix("M", BRICK, dofs), M) < WRITTEN


def test_our_finer_mass_quadrature_differs_in_the_fourth_digit(theirs):
    _, M, dofs = theirs
    M_ours = our_matrix("M", ELEMENTS["hex8i"], dofs)
    assert 1e-4 < largest_difference(M_ours, M) < 2e-4
    assert M_ours.sum() == pytest.approx(M.sum(), rel=WRITTEN)


def test_taylors_factor_changes_the_stiffness_by_three_percent(theirs):
    K, _, dofs = theirs
    K_taylor = our_matrix("K", replace(BRICK, corrected=True), dofs)
    assert largest_difference(K_taylor, K) == pytest.approx(0.0292, abs=0.0005)
