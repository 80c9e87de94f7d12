"""A section's quadrilaterals over a grid of nodes: stations along the profile, rows outwards."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from tyrefrf.arrays import BoolArray, FloatArray, IntArray
from tyrefrf.mesh.section import SectionMesh

Corner = tuple[int, int]
"""A corner of elements: columns before it, rows inside it."""


def grid_section(
    grid: FloatArray, rows: IntArray, step: int, material: IntArray, materials: tuple[str, ...]
) -> SectionMesh:
    """Quadrilaterals over a grid (stations, offsets, 2) of nodes.

    rows: (columns,) elements that stand on the inner surface between two stations; nodes beyond
        them are not used. step: 1 for four-node elements, 2 for eight-node ones.
    material: (columns, most rows) index into `materials`.
    Nodes are numbered along the profile from the rim at y < 0, and from the inside out. The outer
    surface climbs and descends the end faces where the number of rows changes.
    """
    used = _used(grid.shape[:2], rows, step)
    number = np.where(used, np.cumsum(used.ravel()).reshape(used.shape) - 1, -1)

    column, row = np.nonzero(np.arange(material.shape[1]) < rows[:, None])
    corners = [(0, 0), (0, step), (step, step), (step, 0)]
    mids = [(0, 1), (1, 2), (2, 1), (1, 0)] if step == 2 else []
    quads = np.stack(
        [number[step * column + dk, step * row + dj] for dk, dj in corners + mids], axis=1
    )
    return SectionMesh(
        points=grid[used],
        quads=quads,
        material=material[column, row],
        materials=materials,
        rim=np.concatenate([line[line >= 0] for line in (number[0], number[-1])]),
        outer=_edges(list(_outer_line(rows)), number, step),
        inner=_edges([(k, 0) for k in range(len(rows) + 1)], number, step),
    )


def _used(shape: tuple[int, ...], rows: IntArray, step: int) -> BoolArray:
    """Which nodes of the grid an element has."""
    k, j = np.meshgrid(np.arange(shape[0]), np.arange(shape[1]), indexing="ij")
    left, right = rows[np.maximum(k - 1, 0) // step], rows[np.minimum(k // step, len(rows) - 1)]
    inside = j <= step * np.maximum(left, right)
    return np.asarray(inside & ~((k % 2 == 1) & (j % 2 == 1)) if step == 2 else inside)


def _outer_line(rows: IntArray) -> Iterator[Corner]:
    """The corners along the outer surface, from the rim at y < 0 to the rim at y > 0."""
    heights = rows.tolist()
    yield 0, heights[0]
    for k, (low, high) in enumerate(pairwise(heights), start=1):
        yield k, low
        yield from ((k, j) for j in range(low + 1, high + 1))  # up an end face
        yield from ((k, j) for j in range(low - 1, high - 1, -1))  # or down
    yield len(heights), heights[-1]


def _edges(line: list[Corner], number: IntArray, step: int) -> IntArray:
    """A surface's edges along a line of corners: first, last and, if quadratic, the mid-side."""
    k, j = step * np.array(line).T
    ends = [number[k[:-1], j[:-1]], number[k[1:], j[1:]]]
    middle = [number[(k[:-1] + k[1:]) // 2, (j[:-1] + j[1:]) // 2]] if step == 2 else []
    return np.stack(ends + middle, axis=1)
