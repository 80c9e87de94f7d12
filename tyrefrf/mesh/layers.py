"""Where the regions of the wall lie among its elements: tread, belt, bead core, and the carcass.

Regions consist of whole elements, and their borders are where the case says: stations along the
profile are placed so that one stands at the core's top, one at the tread's foot and one at the
belt's edge, and the rows of the body are as thick there as the core and the belt are. Between
these places spacing and rows change smoothly. The number of elements in each region is the one
that makes them about equally long, unless the case gives the tread's.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.errors import CaseError, Problem
from tyrefrf.mesh.centre_line import CentreLine

if TYPE_CHECKING:
    from tyrefrf.case import Geometry

SAME_PLACE = 1e-6  # of the half's length: the tread's foot and the belt's edge are one station


@dataclass(frozen=True, slots=True)
class Borders:
    """Where regions end in the half at y <= 0: arc lengths [m] and elements, from the rim.

    places: of all borders from the rim (0) to the crown; counts: elements before each of them.
    core: top of the bead's core; foot: of the tread; belt: its edge; rib: edge of the rib that
    grooves leave. Without such a region they are at the rim or at the crown, with no elements
    between.
    """

    places: tuple[float, ...]
    counts: tuple[int, ...]
    core: float
    foot: float
    belt: float
    rib: float

    @property
    def n_columns(self) -> int:
        """Elements along the half."""
        return self.counts[-1]

    def elements_to(self, place: float) -> int:
        """Elements between the rim and a border."""
        return self.counts[int(np.argmin(np.abs(np.array(self.places) - place)))]


def find_borders(geometry: Geometry, line: CentreLine) -> Borders:
    """Place the borders of the regions along the profile.

    Raises CaseError, naming the key, where the sizes do not fit or the elements do not suffice.
    """
    core = line.at_radius(geometry.inner_radius + geometry.bead.height) if geometry.bead else 0.0
    foot = _foot(geometry, line)
    belt = _belt_edge(geometry, line, foot)
    _refuse_thick_layers(geometry, line, core, belt)

    rib = _rib_edge(geometry, line, foot)
    places = sorted([0.0, core, foot, belt, rib, line.length])
    tolerance = SAME_PLACE * line.length
    apart = [0.0, *(b for a, b in pairwise(places) if b - a > tolerance)]
    return Borders(tuple(apart), _counts(geometry, apart, foot), core, foot, belt, rib)


def _foot(geometry: Geometry, line: CentreLine) -> float:
    """Arc length at which the tread's foot begins; the crown's without a tread."""
    if geometry.tread is None:
        return line.length
    room = line.shoulder - line.widest
    if geometry.tread.buttress >= room:
        raise _misfit(
            ("tread", "buttress"),
            f"{geometry.tread.buttress:.6g} m is too large; must be below {_down(room)} m, the way "
            "along the profile from the tread's edge to the widest place",
        )
    return line.shoulder - geometry.tread.buttress


def _belt_edge(geometry: Geometry, line: CentreLine, foot: float) -> float:
    """Arc length of the belt's edge; the crown's without a belt."""
    if geometry.belt is None:
        return line.length
    lowest, what = (
        (foot, "the tread's foot (tread_width and twice tread.buttress, along the profile)")
        if geometry.tread
        else (line.widest, "the profile between the widest places")
    )
    room = 2.0 * (line.length - lowest)
    if geometry.belt.width > room * (1.0 + SAME_PLACE):
        raise _misfit(
            ("belt", "width"),
            f"{geometry.belt.width:.6g} m is too wide; must be at most {_down(room)} m, the width "
            f"of {what}",
        )
    return line.length - geometry.belt.width / 2.0


def _rib_edge(geometry: Geometry, line: CentreLine, foot: float) -> float:
    """Arc length at which grooves end beside the rib at mid-tread; the crown's without a rib.

    As stations share the foot out, they share out the angle of the crown's circle.
    """
    grooves = geometry.tread.grooves if geometry.tread else None
    if grooves is None:
        return line.length
    R = geometry.crown_radius
    share = np.arcsin(grooves.rib / 2.0 / R) / np.arcsin(geometry.tread_width / 2.0 / R)
    return line.length - float(share) * (line.length - foot)


def _refuse_thick_layers(geometry: Geometry, line: CentreLine, core: float, belt: float) -> None:
    """Raise CaseError where the body is thinner than its layers: it is thinnest at their ends."""
    for name, place, where in (
        ("bead", core, "at the core's top"),
        ("belt", belt, "at the belt's edge"),
    ):
        layer = getattr(geometry, name)
        room = float(line.thickness(np.array(place)))
        if layer is not None and layer.thickness >= room:
            raise _misfit(
                (name, "thickness"),
                f"{layer.thickness:.6g} m is too large; must be below {_down(room)} m, the body's "
                f"thickness {where}",
            )


def _counts(geometry: Geometry, places: list[float], foot: float) -> tuple[int, ...]:
    """Elements before each border of the half: shares of the length, unless the tread's are given.

    Raises CaseError where there are fewer elements than stretches between borders.
    """
    n = geometry.elements_along // 2
    lengths = np.diff(places)
    below = int(np.sum(np.array(places[1:]) <= foot + SAME_PLACE * places[-1]))  # stretches
    given = geometry.tread.elements_along if geometry.tread else None
    if n < len(lengths):
        raise _misfit(
            ("elements_along",),
            f"{2 * n} is too few for the regions of the section; "
            f"must be at least {2 * len(lengths)}",
        )
    if given is None:
        counts = _shares(n, lengths)
    elif given // 2 < len(lengths) - below:
        rib = "a rib, or " if geometry.tread and geometry.tread.grooves else ""
        raise _misfit(
            ("tread", "elements_along"),
            f"{given} is too few for {rib}a belt narrower than the tread's foot; "
            f"must be at least {2 * (len(lengths) - below)}",
        )
    else:
        counts = _shares(n - given // 2, lengths[:below]) + _shares(given // 2, lengths[below:])
    return tuple(np.cumsum([0, *counts]).tolist())


def _shares(n: int, lengths: FloatArray) -> list[int]:
    """Share n elements among stretches in proportion to their lengths, at least one each."""
    ideal = n * lengths / lengths.sum()
    counts = np.maximum(1, np.floor(ideal)).astype(int)
    while counts.sum() < n:
        counts[np.argmax(ideal - counts)] += 1
    while counts.sum() > n:
        counts[np.argmax(np.where(counts > 1, counts - ideal, -np.inf))] -= 1
    return counts.tolist()


def station_places(borders: Borders, step: int) -> FloatArray:
    """Arc lengths (step * columns + 1,) of the half's stations, from the rim to the crown.

    Even where there are no regions; else monotone and smooth through the borders. Stations of
    mid-sides are half-way.
    """
    from scipy.interpolate import PchipInterpolator

    n = borders.n_columns
    if len(borders.places) == 2:
        return np.linspace(0.0, borders.places[-1], step * n + 1)
    corners = PchipInterpolator(borders.counts, borders.places)(np.arange(n + 1))
    return np.interp(np.arange(step * n + 1) / step, np.arange(n + 1), corners)


def row_offsets(
    geometry: Geometry, borders: Borders, line: CentreLine, s: FloatArray, step: int
) -> FloatArray:
    """Offsets (stations, step * rows + 1) of the body's nodes, of its thickness: -1/2 to 1/2.

    Even but for the belt and the bead's core, where as many rows as these have are as thick as
    they are; from their ends to the widest place the rows become even again.
    """
    n, bead, belt = geometry.elements_through, geometry.bead, geometry.belt
    rows = np.arange(step * n + 1) / step
    offset = np.tile(np.linspace(-0.5, 0.5, step * n + 1), (len(s), 1))
    if bead:
        near = _ease(np.interp(s, [borders.core, line.widest], [1.0, 0.0]))
        border = bead.thickness / line.thickness(np.minimum(s, borders.core))
        offset += near[:, None] * _shifts(rows, bead.elements_through, border)
    if belt:
        near = _ease(np.interp(s, [line.widest, borders.belt], [0.0, 1.0]))
        border = 1.0 - belt.thickness / line.thickness(np.maximum(s, borders.belt))
        offset += near[:, None] * _shifts(rows, n - belt.elements_through, border)
    return offset


def _shifts(rows: FloatArray, row: int, border: FloatArray) -> FloatArray:
    """How far (stations, rows) rows move so that number `row` stands at `border` (stations,).

    Of the thickness, from the inside. The rows to either side stay even.
    """
    n = rows[-1]
    return np.outer(border - row / n, np.interp(rows, [0.0, row, n], [0.0, 1.0, 0.0]))


def _ease(x: FloatArray) -> FloatArray:
    """From 0 at x = 0 to 1 at x = 1, with level ends."""
    return x * x * (3.0 - 2.0 * x)


def element_materials(
    geometry: Geometry, borders: Borders
) -> tuple[IntArray, IntArray, tuple[str, ...]]:
    """Rows (columns,) of the half, materials (columns, rows) of its elements, and their names.

    Names are those used, in the order carcass, tread, belt, bead.
    """
    g, columns = geometry, np.arange(borders.n_columns)
    n_body = g.elements_through
    rows = np.full(len(columns), n_body)
    name = np.full((len(columns), n_body + (g.tread.elements_through if g.tread else 0)), 0)
    regions = [g.material]
    if g.tread:
        above = columns >= borders.elements_to(borders.foot)
        rows[above] += g.tread.elements_through
        name[above, n_body:] = len(regions)
        regions.append(g.tread.material)
    if g.belt:
        across = columns >= borders.elements_to(borders.belt)
        name[across, n_body - g.belt.elements_through : n_body] = len(regions)
        regions.append(g.belt.material)
    if g.bead:
        name[columns < borders.elements_to(borders.core), : g.bead.elements_through] = len(regions)
        regions.append(g.bead.material)
    materials = tuple(dict.fromkeys(regions))
    return rows, np.array([materials.index(region) for region in regions])[name], materials


def _down(length: float) -> str:
    """A length [m] in hundredths of a millimetre, rounded down: it fits where it is a limit."""
    return f"{np.floor(1e5 * length) / 1e5:.5f}"


def _misfit(key: tuple[str, ...], message: str) -> CaseError:
    return CaseError([Problem(("geometry", *key), message)])
