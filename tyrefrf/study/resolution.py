"""How finely the waves in each material are meshed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.fem.constitutive import Constitutive
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.mesh.section import SectionMesh

ENOUGH = {8: 6.0, 20: 3.0}
"""Elements per wavelength that keep the error near a few per cent, by nodes of the brick."""


@dataclass(frozen=True, slots=True)
class Resolution:
    """How finely one material's waves are meshed at the top frequency, where that is worst.

    shear: wavelength in the material [m]. bending: that of the whole wall there, all its layers
    together, as of a free flat plate [m]. thickness: of that wall [m]. size: longest edge of the
    element there, along the profile or around the axle [m]. enough: elements per wavelength that
    are recommended for this element.
    """

    material: str
    shear: float
    bending: float
    thickness: float
    size: float
    enough: float

    @property
    def per_wavelength(self) -> float:
        """Elements in the shorter of the two wavelengths."""
        return min(self.shear, self.bending) / self.size

    @property
    def fine(self) -> bool:
        """Whether that is enough."""
        return self.per_wavelength >= self.enough


@dataclass(frozen=True, slots=True)
class _Waves:
    """What the waves of a material depend on.

    plate: stress over strain in bending [Pa], across the layer free and along it held, in the
    softer direction; E/(1 - nu^2) if isotropic. shear: the smallest shear modulus [Pa].
    rho: density [kg/m3].
    """

    plate: float
    shear: float
    rho: float


def _waves(law: Constitutive, omega: float) -> _Waves:
    """Of a material at omega [rad/s]."""
    C = law.elasticity(omega).real
    Q = C - np.outer(C[:, 2], C[2]) / C[2, 2]
    return _Waves(min(Q[0, 0], Q[1, 1]), min(C[3, 3], C[4, 4], C[5, 5]), law.rho)


def resolutions(
    mesh: CellMesh, laws: Mapping[str, Constitutive], top: float
) -> tuple[Resolution, ...]:
    """How finely each material's waves at the top frequency [Hz] are meshed."""
    omega = 2.0 * np.pi * max(top, 1e-9)
    stuff = [_waves(laws[name], 2.0 * np.pi * top) for name in mesh.materials]
    of = mesh.section.material
    c_shear = np.sqrt([m.shear / m.rho for m in stuff])
    thickness, bending_stiffness, mass = _walls(mesh.section, stuff)
    bending = 2.0 * np.pi * (bending_stiffness / (mass * omega**2)) ** 0.25
    shear = (2.0 * np.pi / omega * c_shear)[of]
    size = _over_section(mesh, element_sizes(mesh).max(axis=1))

    per_wavelength = np.minimum(shear, bending) / size
    worst = [
        int(np.argmin(np.where(of == index, per_wavelength, np.inf))) for index in range(len(stuff))
    ]
    enough = ENOUGH[mesh.bricks.shape[1]]
    return tuple(
        Resolution(
            name, float(shear[e]), float(bending[e]), float(thickness[e]), float(size[e]), enough
        )
        for name, e in zip(mesh.materials, worst, strict=True)
    )


def _over_section(mesh: CellMesh, size: FloatArray) -> FloatArray:
    """The largest (e,) of what the bricks over each element of the section have (bricks,)."""
    if not len(mesh.quads):
        return size[: mesh.section.n_elements]
    largest = np.zeros(mesh.section.n_elements)
    np.maximum.at(largest, mesh.quads, size)
    return largest


def element_sizes(mesh: CellMesh) -> FloatArray:
    """Longest edge (e, 2) [m] of every brick, along the profile and around the axle."""
    X = mesh.cartesian[mesh.bricks[:, :8]]
    along = [(0, 3), (1, 2), (4, 7), (5, 6)]
    around = [(0, 4), (1, 5), (2, 6), (3, 7)]
    return np.stack(
        [
            np.max([np.linalg.norm(X[:, b] - X[:, a], axis=1) for a, b in edges], axis=0)
            for edges in (along, around)
        ],
        axis=1,
    )


def _walls(section: SectionMesh, stuff: list[_Waves]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of the wall that each quadrilateral is part of: thickness, bending stiffness, mass.

    (e,) each; [m], [N m] per width about the neutral axis, and [kg/m2]. Layers are taken as flat.
    In a free mesh, which has no columns, a quadrilateral's wall is as thick as the surfaces are
    apart there, and all of its own material.
    """
    t = _layer_thickness(section)
    plate = np.array([m.plate for m in stuff])[section.material]
    rho = np.array([m.rho for m in stuff])[section.material]
    gap = _gaps(section)
    wall = np.stack([gap, plate * gap**3 / 12.0, rho * gap])
    for stack in _stacks(section):
        h, E = t[stack], plate[stack]
        z = np.cumsum(h) - h / 2.0
        z0 = (E * h) @ z / (E @ h)
        stiffness = np.sum(E * (h**3 / 12.0 + h * (z - z0) ** 2))
        wall[:, stack] = np.array([[h.sum()], [stiffness], [rho[stack] @ h]])
    return wall[0], wall[1], wall[2]


def _stacks(section: SectionMesh) -> list[IntArray]:
    """Numbers of the quadrilaterals of each column, from the inner surface to the outer.

    A quadrilateral's first edge, between its corners 0 and 3, is its inner one. Where a column of
    a free mesh ends inside the wall, it is none.
    """
    inside, outside = section.quads[:, [0, 3]], section.quads[:, [1, 2]]
    on = {tuple(edge): e for e, edge in enumerate(inside.tolist())}
    outer = {frozenset(edge) for edge in section.outer[:, :2].tolist()}
    stacks = []
    for edge in section.inner[:, :2].tolist():
        stack = [on[tuple(edge)]] if tuple(edge) in on else []
        while stack and (above := on.get(tuple(outside[stack[-1]].tolist()))) is not None:
            stack.append(above)
        if stack and frozenset(outside[stack[-1]].tolist()) in outer:
            stacks.append(np.array(stack))
    return stacks


def _gaps(section: SectionMesh) -> FloatArray:
    """Distance (e,) [m] from the inner to the outer surface, by way of each quadrilateral."""
    middle = section.points[section.quads[:, :4]].mean(axis=1)
    inner, outer = (
        cKDTree(section.points[edges].reshape(-1, 2)).query(middle)[0]
        for edges in (section.inner, section.outer)
    )
    return np.asarray(inner + outer)


def _layer_thickness(section: SectionMesh) -> FloatArray:
    """Mean thickness (e,) [m] of the quadrilaterals: area over length along the profile."""
    P = section.points[section.quads[:, :4]]
    r, y = np.moveaxis(P, 2, 0)
    area = 0.5 * np.sum(r * np.roll(y, -1, axis=1) - y * np.roll(r, -1, axis=1), axis=1)
    return area / np.linalg.norm((P[:, 3] + P[:, 2] - P[:, 0] - P[:, 1]) / 2.0, axis=1)
