"""Rings of equal chains under loads on one section: [16]-[22].

A ring of N cells is k chains of N/k. A chain is made by joining; the k faces that are left close
the ring by their orders, which for k = 1 is the paper's [22]. Which k, and how the chain is joined,
is what costs least.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import Any

import numpy as np

from tyrefrf.arrays import ComplexArray
from tyrefrf.solvers.chain import Chain
from tyrefrf.solvers.factor import factorise
from tyrefrf.solvers.mirror import MirrorChain

CLOSE = 8.0 / 3.0
"""Operations over n^3 of closing the ring at a pair of orders."""

MOST_CHAINS = 16
"""Chains that a ring is closed from: with more, the orders would do the recursion's work."""

AnyChain = Chain | MirrorChain

Steps = frozenset[tuple[int, int]]
"""Joins: (a, b) makes a + b cells of a and b."""


def ring_faces(
    cell: AnyChain, n_cells: int, F: ComplexArray, most_chains: int = MOST_CHAINS
) -> ComplexArray:
    """Displacements (n_cells, n, m) of all sections under forces F (n, m) [N] on the first.

    cell: a chain of one. F is the force applied to the tyre. most_chains: that the ring may be
    closed from; 1 is the paper's way.
    Raises SingularError if a chain with fixed ends, or the ring, resonates without damping.
    """
    k = n_chains(n_cells, cell.DOUBLE, cell.JOIN, most_chains)
    chain = chain_of(cell, n_cells // k)
    q = closed(chain, k, F)
    inner = chain.inner_faces(_side_by_side(q), _side_by_side(np.roll(q, -1, axis=0)))
    between = inner.reshape(len(inner), len(F), k, F.shape[1]).transpose(2, 0, 1, 3)
    return np.concatenate([q[:, None], between], axis=1).reshape(n_cells, *F.shape)


def chain_of(cell: AnyChain, n_cells: int) -> AnyChain:
    """A chain of n_cells, every chain on the way made once."""
    made: dict[int, Any] = {1: cell}  # all of one kind
    for a, b in sorted(steps(n_cells, cell.DOUBLE, cell.JOIN), key=sum):
        made[a + b] = made[a].joined(made[b])
    return made[n_cells]


def closed(chain: AnyChain, k: int, F: ComplexArray) -> ComplexArray:
    """Displacements (k, n, m) of the faces of a ring of k chains, forces F on the first.

    A_h = LL + RR + LR exp(i mu) + LR^T exp(-i mu) with mu = 2 pi h / k, and A_-h = A_h^T.
    """
    straight = chain.LL + chain.RR
    x = np.empty((k, *F.shape), complex)
    for h in range(k // 2 + 1):
        turn = np.exp(2j * np.pi * h / k)
        factor = factorise(straight + turn * chain.LR + chain.LR.T / turn)
        x[h], x[-h] = factor.solve(F), factor.solve(F, transposed=True)
    return np.fft.ifft(x, axis=0)


def _side_by_side(q: ComplexArray) -> ComplexArray:
    """(k, n, m) as (n, k m)."""
    return q.transpose(1, 0, 2).reshape(q.shape[1], -1)


@cache
def n_chains(n_cells: int, double: float, join: float, most: int = MOST_CHAINS) -> int:
    """Of how many chains a ring is closed at least cost; double, join: what these cost."""
    possible = [k for k in range(1, most + 1) if n_cells % k == 0]
    return min(possible, key=lambda k: _ring_cost(n_cells, k, double, join))


def operations(kind: type[AnyChain], n: int, n_cells: int, most: int = MOST_CHAINS) -> float:
    """Of a ring with n dofs on a face, joined and closed."""
    costs = kind.DOUBLE, kind.JOIN
    return _ring_cost(n_cells, n_chains(n_cells, *costs, most), *costs) * n**3


def _ring_cost(n_cells: int, k: int, double: float, join: float) -> float:
    """Operations over n^3 of joining and closing k chains."""
    return cost(steps(n_cells // k, double, join), double, join) + CLOSE * (k // 2 + 1)


@cache
def steps(n_cells: int, double: float, join: float) -> Steps:
    """The joins that make a chain: halves, or by the factor method (Knuth, TAOCP 2, 4.6.3)."""
    if n_cells == 1:
        return frozenset()
    rest = [n_cells // 2] if n_cells % 2 == 0 else [1, *_cofactors(n_cells)]
    ways = [
        steps(n_cells - b, double, join) | steps(b, double, join) | {(n_cells - b, b)} for b in rest
    ]
    return min(ways, key=lambda way: cost(way, double, join))


def cost(joins: Iterable[tuple[int, int]], double: float, join: float) -> float:
    """Operations over n^3."""
    return sum(double if a == b else join for a, b in joins)


def _cofactors(n: int) -> list[int]:
    """N / p for every prime p that divides n, but 1."""
    return [n // p for p in range(3, n, 2) if n % p == 0 and all(p % d for d in range(3, p, 2))]
