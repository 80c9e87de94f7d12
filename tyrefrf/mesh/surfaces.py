"""The outer and the inner surface of a section from a file: its boundary, parted by the rim.

The boundary's edges that are not on the rim make chains from rim to rim. Two of them lead from
one side of the rim to the other. Counter-clockwise in (r, y), where r points to the right and y
up, the outer one leads up and the inner one down, as the cavity is between wall and rim.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from tyrefrf.arrays import BoolArray, IntArray
from tyrefrf.mesh.sheet import Sheet


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """Edges (k, 2) or (k, 3) of both surfaces, from the rim at small y to that at large y."""

    outer: IntArray
    inner: IntArray


def part_boundary(sheet: Sheet, loop: IntArray, rim: IntArray) -> Surfaces:
    """The two surfaces, from the boundary's edges in order and the rim's nodes.

    Raises MeshError where the rim is not on the boundary, on one side only, or has gaps.
    """
    held = np.zeros(len(sheet.points), dtype=bool)
    held[rim] = True
    if not held[loop[:, 0]].any():
        raise sheet.fault(
            f"the rim is not on the section's boundary: none of its {len(rim)} nodes, such as "
            f"node {sheet.nodes[rim[0]]}, is"
        )
    _refuse_free_mid_sides(sheet, loop, held)
    y = sheet.points[:, 1]
    ends = loop[held[loop[:, 0]], 0]
    middle = (y[ends].min() + y[ends].max()) / 2.0
    chains = _chains(loop, held)
    up = [c for c in chains if y[c[0, 0]] < middle < y[c[-1, 1]]]
    down = [c for c in chains if y[c[0, 0]] > middle > y[c[-1, 1]]]
    if len(up) != 1 or len(down) != 1:
        at = ", ".join(str(n) for n in sorted(sheet.nodes[ends])[:6])
        raise sheet.fault(
            "the rim must hold the section at two places, one on either side, with the two "
            f"surfaces between them; its nodes on the boundary are {at}"
            f"{'...' if len(ends) > 6 else ''}: {len(up)} chain(s) of edges lead from the lower y "
            f"to the higher outside, {len(down)} inside (half a section must be mirrored first)"
        )
    backwards = [1, 0, 2][: loop.shape[1]]
    return Surfaces(outer=up[0], inner=down[0][::-1, backwards])


def refuse_other_inner(sheet: Sheet, inner: IntArray, named: BoolArray, name: str) -> None:
    """Raise MeshError where the inner surface that was found is not the named one.

    named: (k,) whether each edge of the inner surface found is in it. The pressure's stiffness is
    only right where the surface under it ends on the rim.
    """
    if named.all():
        return
    edge = inner[np.argmin(named)]
    found = f"the edge from node {sheet.nodes[edge[0]]} to {sheet.nodes[edge[1]]}"
    raise sheet.fault(
        f"inner = '{name}' does not hold all of the section's side towards the cavity, from rim "
        f"to rim: {found} is not in it; extend it, or the rim's set"
    )


def _chains(loop: IntArray, held: BoolArray) -> list[IntArray]:
    """Runs of edges between nodes on the rim, without the edges on the rim."""
    first = int(np.argmax(held[loop[:, 0]]))
    loop = np.roll(loop, -first, axis=0)
    starts = np.append(np.flatnonzero(held[loop[:, 0]]), len(loop))
    runs = [loop[a:b] for a, b in pairwise(starts.tolist())]
    return [run for run in runs if len(run) > 1 or not held[run].all()]


def _refuse_free_mid_sides(sheet: Sheet, loop: IntArray, held: BoolArray) -> None:
    """Raise MeshError where corners beside each other are on the rim, and the node between not."""
    if loop.shape[1] == 2:
        return
    free = held[loop[:, 0]] & held[loop[:, 1]] & ~held[loop[:, 2]]
    if free.any():
        a, b, mid = sheet.nodes[loop[np.argmax(free)]]
        raise sheet.fault(
            f"node {mid}, the mid-side between the rim's nodes {a} and {b}, is not in the rim's set"
        )
