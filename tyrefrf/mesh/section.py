"""The tyre's section: a mesh of quadrilaterals in the (r, y) half plane."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tyrefrf.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class SectionMesh:
    """Quadrilaterals in (r, y), with the sets that the tyre needs.

    points: (n, 2) r and y of every node [m].
    quads: (e, 4) or (e, 8) node numbers, counter-clockwise in (r, y); of eight, the corners
        first, then the mid-sides, the first of them between corners 0 and 1. Corners 0 and 1
        lie along the thickness, from the inside out: the axes of layers follow.
    material: (e,) index into `materials`.
    materials: names, in the order of the indices.
    rim: numbers of the nodes on the rim.
    outer, inner: (k, 2) or (k, 3) edges of the two surfaces from the rim at y < 0 to the rim at
        y > 0: first node, last node, and of three the mid-side last.
    numbers: (n,) of the nodes in the file that they were read from; None if they were made here.
    """

    points: FloatArray
    quads: IntArray
    material: IntArray
    materials: tuple[str, ...]
    rim: IntArray
    outer: IntArray
    inner: IntArray
    numbers: IntArray | None = None

    @property
    def n_nodes(self) -> int:
        """How many nodes the section has."""
        return len(self.points)

    @property
    def n_elements(self) -> int:
        """How many quadrilaterals the section has."""
        return len(self.quads)

    def without(self, cut: BoolArray) -> SectionMesh:
        """The section without some of its elements (e,), none of them on its inner surface.

        Nodes keep their order; the outer surface is what is now outermost.
        """
        used = np.zeros(self.n_nodes, dtype=bool)
        used[self.quads[~cut]] = True
        number = np.cumsum(used) - 1
        quads = number[self.quads[~cut]]
        return replace(
            self,
            points=self.points[used],
            quads=quads,
            material=self.material[~cut],
            rim=number[self.rim],
            outer=_outline(quads, *number[self.outer[[0, -1], [0, 1]]].tolist()),
            inner=number[self.inner],
        )


def _outline(quads: IntArray, first: int, last: int) -> IntArray:
    """Edges (k, 2) or (k, 3) of the boundary from one of its nodes to another, counter-clockwise.

    An edge is on the boundary where no other element has it the other way round.
    """
    corners = quads[:, :4]
    edges = [
        corners,
        np.roll(corners, -1, axis=1),
        *([quads[:, 4:]] if quads.shape[1] == 8 else []),
    ]
    of = {
        (edge[0], edge[1]): edge
        for edge in np.stack(edges, axis=2).reshape(-1, len(edges)).tolist()
    }
    after = {a: edge for (a, b), edge in of.items() if (b, a) not in of}
    outline = [after.pop(first)]
    while outline[-1][1] != last:
        outline.append(after.pop(outline[-1][1]))
    return np.array(outline)
