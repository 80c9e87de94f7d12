"""The tyre's section: a mesh of quadrilaterals in the (r, y) half plane."""

from __future__ import annotations

from dataclasses import dataclass

from tyrefrf.arrays import FloatArray, IntArray


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
