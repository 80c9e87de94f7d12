"""The answer depends neither on how N cells are joined nor on where the ring is cut."""

from __future__ import annotations

from functools import reduce

import numpy as np
import pytest
from rings import THETA, R, Y, by_recursion, lopsided, omegas, section_error, tyre
from scipy.sparse import csc_array

from tyrefrf.solvers.condense import Condenser
from tyrefrf.solvers.recursive import share_of
from tyrefrf.solvers.ring import chain_of, closed, ring_faces
from tyrefrf.solvers.symmetry import shares

ROUND_OFF = 1e-9
LINES = omegas(30.0, 700.0, 2000.0)


def cheapest(cell):
    """As the ring is closed, whatever that is."""
    return chain_of(cell, 45)


def ascending(cell):
    """1 + 4 + 8 + 32."""
    return reduce(joined, [chain_of(cell, n) for n in (1, 4, 8, 32)])


def thirds(cell):
    """3 x 15, each 3 x 5."""
    five = chain_of(cell, 5)
    fifteen = five.joined(five).joined(five)
    return fifteen.joined(fifteen.joined(fifteen))


def one_and_the_rest(cell):
    """1 + 44."""
    return cell.joined(chain_of(cell, 44))


def one_by_one(cell):
    """((1 + 1) + 1) + ..."""
    return reduce(joined, [cell] * 45)


def joined(a, b):
    return a.joined(b)


def general(cell, omega):
    """A chain of one cell, nothing assumed of it."""
    chain, _ = Condenser(cell)(cell.dynamic_stiffness(omega))
    return chain


def mirrored(cell, omega):
    """The same as its own mirror image, for the motions that mirror in y."""
    return share_of(general(cell, omega), shares(cell)[0])


@pytest.mark.parametrize("omega", LINES)
@pytest.mark.parametrize("order", [ascending, thirds, one_and_the_rest, one_by_one])
@pytest.mark.parametrize("kind", [general, mirrored])
def test_45_cells_in_any_order(kind, order, omega):
    cell = kind(tyre().cell, omega)
    f = np.zeros((len(cell.LL), 2))
    f[[20, 55], [0, 1]] = 1.0

    faces = {}
    for way in (cheapest, order):
        chain = way(cell)
        q = np.linalg.solve(chain.LL + chain.LR + chain.LR.T + chain.RR, f)
        faces[way] = np.concatenate([q[None], chain.inner_faces(q, q)])

    assert chain.n_cells == 45
    assert section_error(faces[order], faces[cheapest], f.shape[0]) < ROUND_OFF


@pytest.mark.parametrize("k", [1, 3, 5, 9, 15])
@pytest.mark.parametrize("kind", [general, mirrored])
def test_a_ring_closed_from_k_chains(kind, k):
    """[22] is k = 1; the orders of k faces give the same."""
    cell = kind(tyre().cell, LINES[1])
    f = np.eye(len(cell.LL))[:, [20, 55]] + 0j
    expected = ring_faces(cell, 45, f, most_chains=1)
    chain = chain_of(cell, 45 // k)
    assert section_error(closed(chain, k, f), expected[:: 45 // k], len(f)) < ROUND_OFF


@pytest.mark.parametrize("turn", [1, 13, 44])
def test_a_turned_load_gives_the_turned_answer(turn):
    paper = tyre()
    places = [(0, 29, R), (4, 40, Y), (30, 17, THETA)]
    here = paper.point_loads(*places)
    there = paper.point_loads(*((section + turn, node, d) for section, node, d in places))

    q, turned = (by_recursion(paper.problem(f), LINES[1]) for f in (here, there))

    assert section_error(turned, np.roll(q, turn, axis=0), paper.cell.n_face) < ROUND_OFF


@pytest.mark.parametrize("n_cells", [1, 2, 7, 45])
def test_a_load_does_not_care_what_else_is_solved(n_cells):
    """Loads alone (fewer kept sections), together, and added up to one."""
    ring = lopsided(tyre(n_cells=n_cells, elements_along=4, elements_around=max(2, 6 // n_cells)))
    places = [(0, 3, R), (n_cells // 2, ring.mesh.n_face + 2, Y), (n_cells - 1, 6, THETA)]
    together = ring.point_loads(*places)
    summed = csc_array(together @ csc_array([[2.0], [-3.0], [0.5]]))

    q = by_recursion(ring.problem(together), LINES[1])
    alone = [by_recursion(ring.problem(ring.point_loads(p)), LINES[1]) for p in places]
    sum_q = by_recursion(ring.problem(summed), LINES[1])

    assert section_error(np.concatenate(alone, axis=2), q, ring.cell.n_face) < ROUND_OFF
    assert section_error(sum_q, q @ [[2.0], [-3.0], [0.5]], ring.cell.n_face) < ROUND_OFF
