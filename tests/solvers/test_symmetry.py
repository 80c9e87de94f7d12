"""Symmetries of the cell: found where they are, not where they are not, and worth no digit.

The referee of the recursion that uses them is the recursion as the paper writes it: the general
join of [18], the whole section, and [22] for one chain around the ring.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rings import PAPER, THETA, R, Y, lopsided, omegas, section_error, tyre, with_steel_belt

from tyrefrf.case import Cord, Ply
from tyrefrf.solvers import Direct, Recursive, recursive
from tyrefrf.solvers.condense import Condenser
from tyrefrf.solvers.recursive import share_of
from tyrefrf.solvers.symmetry import shares

ROUND_OFF = 1e-9
OMEGA = omegas(620.0)[0]
CORDS = Ply(
    kind="ply",
    cord=Cord(E=5e9, nu=0.3, rho=1400.0),
    rubber={"E": 20e6, "nu": 0.45, "rho": 1100.0, "eta": 0.1},
    volume_fraction=0.3,
    angles=(20.0,),
)


def angled(ring):
    """Every cord at 20 degrees: only a half turn about a radius maps the tyre onto itself."""
    return replace(ring, materials={"rubber": CORDS})


def one_sided(ring):
    """Another material where y > 0: the cell still mirrors about its own middle plane."""
    mesh = ring.mesh
    right = mesh.points[mesh.bricks, 1].mean(axis=1) > 0.0
    return replace(
        ring,
        mesh=replace(mesh, material=right.astype(np.int64), materials=("rubber", "tread")),
        materials={"rubber": PAPER, "tread": PAPER.model_copy(update={"E": 30e6})},
    )


def angled_on_one_side(ring):
    """Neither mirror nor half turn."""
    return replace(one_sided(ring), materials={"rubber": CORDS, "tread": PAPER})


RINGS = {
    "both mirrors": lambda ring: ring,
    "steel belt": with_steel_belt,
    "half turn": angled,
    "one mirror": one_sided,
    "none": angled_on_one_side,
    "lopsided": lopsided,
}


def small(kind: str, element: str = "hex8i", n_cells: int = 12):
    ring = tyre(element, n_cells=n_cells, elements_along=6, elements_around=2)
    return RINGS[kind](ring)


@pytest.mark.parametrize("element", ["hex8i", "hex20r"])
@pytest.mark.parametrize(
    ("kind", "n_shares", "mirrored"),
    [
        ("both mirrors", 2, True),
        ("steel belt", 2, True),
        ("half turn", 1, True),
        ("one mirror", 1, True),
        ("none", 1, False),
        ("lopsided", 1, False),
    ],
)
def test_the_symmetries_that_are_there_are_found(kind, n_shares, mirrored, element):
    found = shares(small(kind, element).cell)
    assert len(found) == n_shares
    assert [share.n_even is not None for share in found] == [mirrored] * n_shares


@pytest.mark.parametrize("kind", RINGS)
def test_the_shares_are_an_orthonormal_basis(kind):
    cell = small(kind).cell
    Q = np.hstack([share.Q.toarray() for share in shares(cell)])
    assert Q.shape == (np.sum(~cell.fixed[: cell.n_face]),) * 2
    np.testing.assert_allclose(Q.T @ Q, np.eye(len(Q)), atol=1e-15)


@pytest.mark.parametrize("kind", ["both mirrors", "steel belt", "half turn", "one mirror"])
def test_the_mirror_gives_the_right_face_from_the_left(kind):
    cell = small(kind).cell
    chain, _ = Condenser(cell)(cell.dynamic_stiffness(OMEGA))
    for share in shares(cell):
        Q, part = share.Q, share_of(chain, share)
        np.testing.assert_allclose(part.RR, Q.T @ (chain.RR @ Q), atol=1e-11 * abs(chain.RR).max())
        np.testing.assert_allclose(
            part.LR.T, part.sign[:, None] * part.LR * part.sign, atol=1e-11 * abs(chain.LR).max()
        )


@pytest.mark.parametrize("difference", [1e-8, 1e-6])
def test_a_cell_that_is_nearly_its_own_image_is_not_taken_for_it(difference):
    ring = one_sided(tyre(n_cells=12, elements_along=6))
    nearly = {"rubber": PAPER, "tread": PAPER.model_copy(update={"E": 80e6 * (1.0 + difference)})}
    assert len(shares(replace(ring, materials=nearly).cell)) == 1


@pytest.mark.parametrize("n_cells", [1, 2, 3, 7, 12, 45, 64])
@pytest.mark.parametrize("element", ["hex8i", "hex20"])
@pytest.mark.parametrize("kind", RINGS)
def test_symmetries_change_nothing(kind, element, n_cells):
    ring = RINGS[kind](
        tyre(element, n_cells=n_cells, elements_along=4, elements_around=max(2, 6 // n_cells))
    )
    inside = ring.mesh.n_face + 2
    loads = ring.point_loads((0, 3, R), (n_cells // 2, 4, THETA), (n_cells - 1, inside, Y))
    problem = ring.problem(loads)

    field = Recursive(problem).field(OMEGA)
    papers = Recursive(problem, symmetries=False, most_chains=1).field(OMEGA)

    assert (field.remark, papers.remark) == ("", "")
    assert section_error(field.q, papers.q, ring.cell.n_face) < ROUND_OFF
    assert section_error(field.q, Direct(problem).field(OMEGA).q, ring.cell.n_face) < ROUND_OFF


def test_a_load_in_the_middle_plane_excites_one_share(monkeypatch):
    ring = tyre(n_cells=12, elements_along=6)
    middle = int(np.flatnonzero(abs(ring.mesh.section.points[:, 1]) < 1e-12)[0])
    solved = []
    monkeypatch.setattr(
        recursive, "ring_faces", lambda *a: solved.append(a[2].shape) or np.zeros((12, *a[2].shape))
    )
    Recursive(ring.problem(ring.point_loads((0, middle, R), (0, middle, THETA))))._solve(
        ring.cell.dynamic_stiffness(OMEGA)
    )
    assert [columns for _, columns in solved] == [2]
