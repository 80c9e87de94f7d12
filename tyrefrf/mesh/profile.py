"""The built-in tyre's section: the body thickened from its centre line, the tread upon it.

The tread is ruled between the body's outside and the crown's circle: the nodes of a station share
the half tread's arc on the circle as its foot is shared on the centre line, so that the end faces
lean inwards from the foot, which the buttress makes wider, to the tread's edge.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.arrays import FloatArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.centre_line import centre_line
from tyrefrf.mesh.grid import grid_section
from tyrefrf.mesh.grooves import tread_shares
from tyrefrf.mesh.layers import element_materials, find_borders, row_offsets, station_places
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.mesh.shapes import folded

if TYPE_CHECKING:
    from tyrefrf.case import Geometry


def tyre_section(geometry: Geometry, quadratic: bool) -> SectionMesh:
    """Mesh the section of the built-in tyre, mirror-symmetric about y = 0.

    quadratic: eight-node quadrilaterals with mid-sides on the curves, else four-node ones.
    Nodes are numbered along the profile from the rim at y < 0, and from the inside out.
    Raises CaseError, naming the key, where the sizes of tread, belt or bead do not fit, and
    MeshError where the thickness exceeds what the profile's curvature leaves room for.
    """
    step = 2 if quadratic else 1
    line = centre_line(geometry)
    borders = find_borders(geometry, line)
    s = station_places(borders, step)
    centre, normal, thickness = line.stations(s)
    offset = row_offsets(geometry, borders, line, s, step)
    half = centre[:, None] + (thickness[:, None] * offset)[..., None] * normal[:, None]
    if geometry.tread is not None:
        top = _tread_surface(geometry, (line.length - s) / (line.length - borders.foot))
        half = np.hstack([half, _ruled(half[:, -1], top, tread_shares(geometry.tread, step))])

    rows, material, materials = element_materials(geometry, borders)
    section = grid_section(
        _mirrored(half),
        np.concatenate([rows, rows[::-1]]),
        step,
        np.concatenate([material, material[::-1]]),
        materials,
    )
    if folded(section.points, section.quads).any():
        tread = ", or tread.buttress smaller" if geometry.tread else ""
        raise MeshError(
            "the section folds over itself: it is thicker than twice the radius of its bends; make "
            f"geometry.thickness smaller, or section_width or widest_radius larger{tread}"
        )
    return section


def _tread_surface(geometry: Geometry, share: FloatArray) -> FloatArray:
    """Points (n, 2) on the crown's circle at shares (n,) of the way from mid-tread to its edge."""
    R = geometry.crown_radius
    phi = np.arcsin(geometry.tread_width / 2.0 / R) * share
    return np.stack([geometry.outer_radius - R * (1.0 - np.cos(phi)), -R * np.sin(phi)], axis=1)


def _ruled(inside: FloatArray, outside: FloatArray, x: FloatArray) -> FloatArray:
    """Nodes (stations, n, 2) at shares x (n,) of the straight lines from `inside` to `outside`."""
    return (1.0 - x[:, None]) * inside[:, None] + x[:, None] * outside[:, None]


def _mirrored(half: FloatArray) -> FloatArray:
    """A half's nodes and their mirror images about y = 0, the crown once and exactly on it."""
    crown = half[-1:].copy()
    crown[..., 1] = 0.0
    return np.concatenate([half[:-1], crown, half[-2::-1] * [1.0, -1.0]])
