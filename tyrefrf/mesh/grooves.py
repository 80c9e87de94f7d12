"""Transverse grooves in the tread: which bricks of a cell they take away.

Grooves consist of whole bricks, and their sizes are those of the case: planes of the cell stand at
their walls, so that layers of bricks around the axle are not equally thick, and as many rows of
the tread as they are deep are as thick as they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.arrays import BoolArray, FloatArray
from tyrefrf.errors import CaseError, Problem
from tyrefrf.mesh.centre_line import centre_line
from tyrefrf.mesh.layers import element_materials, find_borders

if TYPE_CHECKING:
    from tyrefrf.case import Cell, Geometry, Tread
    from tyrefrf.case.geometry import Grooves

SAME_ANGLE = 1e-9  # of the pitch: a wall stands on the cell's boundary


@dataclass(frozen=True, slots=True, eq=False)
class Layers:
    """Layers of bricks around one cell.

    theta: (n + 1,) planes between them [rad], the cell's two sections included.
    grooved: (n,) which of them lie in a groove.
    """

    theta: FloatArray
    grooved: BoolArray


def groove_rows(tread: Tread) -> int:
    """How many of the tread's rows of elements its grooves take away, from the outside."""
    assert tread.grooves is not None
    n = tread.elements_through
    if tread.grooves.depth == tread.thickness:
        return n
    return int(np.clip(round(n * tread.grooves.depth / tread.thickness), 1, n - 1))


def tread_shares(tread: Tread, step: int) -> FloatArray:
    """Where the tread's nodes stand on the way (step * rows,) from its foot, at 0, to its outside.

    Even but for grooves, whose rows are together as thick as they are deep.
    """
    n = step * tread.elements_through
    even: FloatArray = (np.arange(n) + 1.0) / n
    if tread.grooves is None:
        return even
    floor = 1.0 - tread.grooves.depth / tread.thickness
    under = 1.0 - groove_rows(tread) / tread.elements_through
    return np.interp(even, [0.0, under, 1.0], [0.0, floor, 1.0]) if under else even


def cut_elements(geometry: Geometry) -> BoolArray:
    """Elements (e,) of the section of `mesh.profile` that grooves take away where they are."""
    tread = geometry.tread
    assert tread is not None
    assert tread.grooves is not None
    borders = find_borders(geometry, centre_line(geometry))
    half = np.arange(borders.n_columns)
    low = (half >= borders.elements_to(borders.foot)) & (half < borders.elements_to(borders.rib))
    sides = tread.grooves.sides
    columns = np.concatenate([low & (sides != "y>0"), low[::-1] & (sides != "y<0")])
    rows = element_materials(geometry, borders)[0]
    rows = np.concatenate([rows, rows[::-1]])
    column, row = np.nonzero(np.arange(rows.max()) < rows[:, None])
    return np.asarray(columns[column] & (row >= rows[column] - groove_rows(tread)))


def groove_layers(grooves: Grooves, outer_radius: float, cell: Cell) -> Layers:
    """The layers of a cell with grooves, an equal number of them at every groove.

    Raises CaseError, naming the key, where the grooves are wider than their pitch or the elements
    around do not suffice.
    """
    pitch = 2.0 * np.pi / cell.n_cells / grooves.number
    width = grooves.width / outer_radius
    if width >= pitch * (1.0 - SAME_ANGLE):
        raise _misfit(
            ("geometry", "tread", "grooves", "width"),
            f"{grooves.width:.6g} m leaves no block; must be below {pitch * outer_radius:.6g} m, "
            f"the outer circumference of {_parts(grooves.number)}",
        )
    across, along = _counts(grooves, cell, width / pitch)
    wall = (pitch / 2.0 + np.deg2rad(grooves.offset) - width / 2.0) % pitch
    if min(wall, pitch - wall) < SAME_ANGLE * pitch:
        wall = 0.0
    stretches = _stretches(wall, width, pitch, across, along)
    if min(count for _, count, _ in stretches) < 1:
        need = sum(max(count, 1) for _, count, _ in stretches) * grooves.number
        raise _misfit(
            ("cell", "elements_around"),
            f"{cell.elements_around} is too few for grooves and the blocks to either side; "
            f"must be at least {need}",
        )
    ends = np.cumsum([0.0, *(length for length, _, _ in stretches)])
    ends[-1] = pitch
    one = np.concatenate(
        [
            np.linspace(low, high, count, endpoint=False)
            for low, high, (_, count, _) in zip(ends[:-1], ends[1:], stretches, strict=True)
        ]
    )
    theta = (pitch * np.arange(grooves.number)[:, None] + one).ravel()
    grooved = np.concatenate([np.full(count, inside) for _, count, inside in stretches])
    return Layers(
        theta=np.append(theta, 2.0 * np.pi / cell.n_cells),
        grooved=np.tile(grooved, grooves.number),
    )


def _counts(grooves: Grooves, cell: Cell, share: float) -> tuple[int, int]:
    """Layers across one groove and along one block; share: of the pitch that is groove."""
    around = ("cell", "elements_around")
    n, rest = divmod(cell.elements_around, grooves.number)
    if rest:
        raise _misfit(
            around,
            f"{cell.elements_around} does not share out among {grooves.number} grooves; "
            f"nearest: {max(round(cell.elements_around / grooves.number), 3) * grooves.number}",
        )
    if n < 2:
        raise _misfit(
            around,
            f"{cell.elements_around} is too few for grooves; must be at least "
            f"{3 * grooves.number}, one in every groove and one to either side",
        )
    across = grooves.elements_across
    if across is None:
        # An even number for the block, so that both sides of the groove have as many.
        choices = range(2 - n % 2, n - 1, 2) or (1,)
        across = min(choices, key=lambda k: abs(k - n * share))
    elif across >= n:
        raise _misfit(
            ("geometry", "tread", "grooves", "elements_across"),
            f"{across} leaves no element for the blocks; must be below {n} with "
            f"cell.elements_around = {cell.elements_around}",
        )
    return across, n - across


def _stretches(
    wall: float, width: float, pitch: float, across: int, along: int
) -> list[tuple[float, int, bool]]:
    """What follows from the pitch's left end to its right: angle, layers, whether it is a groove.

    wall: where the groove begins [rad], before or beyond the right end.
    """
    over = wall + width - pitch
    if abs(over) < SAME_ANGLE * pitch:
        return [(wall, along, False), (width, across, True)]
    if over > 0.0:
        first = _share(over / width, across)
        return [
            (over, first, True),
            (pitch - width, along, False),
            (width - over, across - first, True),
        ]
    if wall == 0.0:
        return [(width, across, True), (pitch - width, along, False)]
    first = _share(wall / (pitch - width), along)
    return [(wall, first, False), (width, across, True), (-over, along - first, False)]


def _share(share: float, n: int) -> int:
    """The first of two parts of n elements, none of them empty but for n = 1."""
    return int(np.clip(round(share * n), 1, max(n - 1, 1)))


def _parts(number: int) -> str:
    return "the cell" if number == 1 else f"each of its {number} parts in the cell"


def _misfit(key: tuple[str, ...], message: str) -> CaseError:
    return CaseError([Problem(key, message)])
