"""How far each element is from the truth as rubber becomes incompressible.

Two thick vessels under internal pressure, with Lame's exact displacement u(R) along the radius:
- the plane-strain cylinder of MacNeal & Harder, A proposed standard set of problems to test finite
  element accuracy, Finite Elements in Analysis and Design 1 (1985), 3-20, thick-walled cylinder:
  radii 3 to 9, E = 1000, p = 1, five bricks in all, in one cell of 10 degrees;
- the sphere of the same radii, from the equator to 45 degrees of latitude, five by four bricks.
Bodies slide freely on their ends and on the cell's two sections. The error is the norm of the
difference of nodal displacements, relative to the norm of the exact ones; the pressure acts on the
mesh's own inner surface.

The table does not show bending, vibration, or bricks distorted worse than the sphere's wedges.

    python benchmarks/element_accuracy.py
"""

from __future__ import annotations

import platform
from dataclasses import dataclass
from math import cos, degrees, radians

import numpy as np

from tyrefrf.arrays import BoolArray, FloatArray
from tyrefrf.case import Damping, Isotropic
from tyrefrf.fem.assembly import assemble_cell
from tyrefrf.fem.elements import ELEMENTS, Element, jacobian
from tyrefrf.fem.frames import rotations
from tyrefrf.fem.quadrature import gauss
from tyrefrf.mesh.cell import CellMesh, revolve
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.mesh.shapes import HEX8, HEX20, shape

E, PRESSURE = 1000.0, 1.0
RADII = np.array([3.0, 3.5, 4.2, 5.2, 6.75, 9.0])
INNER, OUTER = RADII[0], RADII[-1]
SECTOR_ANGLE = radians(10.0)
POISSON = (0.3, 0.48, 0.499)


@dataclass(frozen=True, slots=True)
class Vessel:
    """A thick vessel between its two ends.

    stations: heights [m] of a cylinder's nodes, or latitudes [rad] of a sphere's.
    """

    name: str
    spherical: bool
    stations: FloatArray

    def place(self, R: FloatArray, s: FloatArray) -> FloatArray:
        """Places (..., 2) in r and y at radius R and station s."""
        return np.stack([R * np.cos(s), R * np.sin(s)] if self.spherical else [R, s], axis=-1)

    def stations_at(self, r: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Radius and station of a place: the inverse of `place`."""
        return (np.hypot(r, y), np.arctan2(y, r)) if self.spherical else (r, y)

    def displacement(self, R: FloatArray, nu: float) -> FloatArray:
        """Lame's displacement along the radius [m].

        Source: Timoshenko & Goodier, Theory of Elasticity, articles 28 and 136.
        """
        if self.spherical:
            bulk, shear = (1.0 - 2.0 * nu) * R, (1.0 + nu) * OUTER**3 / (2.0 * R**2)
            return PRESSURE * INNER**3 / (E * (OUTER**3 - INNER**3)) * (bulk + shear)
        bulk, shear = (1.0 - 2.0 * nu) * R, OUTER**2 / R
        return (1.0 + nu) * PRESSURE * INNER**2 / (E * (OUTER**2 - INNER**2)) * (bulk + shear)


CYLINDER = Vessel("cylinder", False, np.array([0.0, 1.0]))
SPHERE = Vessel("sphere", True, np.linspace(0.0, radians(45.0), 5))
VESSELS = (CYLINDER, SPHERE)


def error(vessel: Vessel, element: Element, nu: float) -> float:
    """Relative error of the nodal displacements under internal pressure."""
    mesh = revolve(section(vessel, element.n_nodes == 20), SECTOR_ANGLE, 1)
    r, y, theta = mesh.points.T
    R, s = vessel.stations_at(r, y)
    axes, free = sliding_axes(vessel, s, theta)

    matrices = assemble_cell(mesh, {"rubber": Isotropic(E=E, nu=nu, rho=1.0)}, element, Damping())
    K = axes @ matrices.sparse(matrices.K["rubber"]) @ axes.T
    f = axes @ rotations(theta[None])[0] @ pressure_load(mesh)
    u = np.zeros(len(f))
    u[free] = np.linalg.solve(K[np.ix_(free, free)], f[free])

    exact = np.zeros((len(R), 3))
    exact[:, 0] = vessel.displacement(R, nu)
    return float(np.linalg.norm(u - exact.ravel()) / np.linalg.norm(exact))


def sliding_axes(vessel: Vessel, s: FloatArray, theta: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Axes along the vessel's own radius, across it and around, and which dofs are free in them.

    Returns a block-diagonal rotation (3n, 3n) of (r, y, theta) and a mask (3n,).
    """
    tilt = s if vessel.spherical else np.zeros_like(s)
    n = len(s)
    axes = np.zeros((n, 3, n, 3))
    k = np.arange(n)
    axes[k, 0, k, 0] = axes[k, 1, k, 1] = np.cos(tilt)
    axes[k, 0, k, 1], axes[k, 1, k, 0] = np.sin(tilt), -np.sin(tilt)
    axes[k, 2, k, 2] = 1.0
    at_end = np.isclose(s, vessel.stations[0]) | np.isclose(s, vessel.stations[-1])
    on_section = np.isclose(theta, 0.0) | np.isclose(theta, SECTOR_ANGLE)
    free = np.stack([np.ones(n, dtype=bool), ~at_end, ~on_section], axis=1)
    return axes.reshape(3 * n, 3 * n), free.ravel()


def pressure_load(mesh: CellMesh) -> FloatArray:
    """Nodal forces (3n,) in x, y, z: the integral of p N n dA over the innermost bricks' faces."""
    square, w = gauss(3, 2)
    xi = np.column_stack([np.full(len(square), -1.0), square])
    N, dN = shape(HEX8 if mesh.bricks.shape[1] == 8 else HEX20, xi)
    innermost = mesh.bricks[: len(mesh.section.inner)]
    J = jacobian(mesh.cartesian[innermost], dN)
    into_the_wall = np.cross(J[:, :, 1], J[:, :, 2])
    f = np.zeros((mesh.n_nodes, 3))
    np.add.at(f, innermost, PRESSURE * np.einsum("ga,egi,g->eai", N, into_the_wall, w))
    return f.ravel()


def section(vessel: Vessel, quadratic: bool) -> SectionMesh:
    """The wall's quadrilaterals, innermost first, mid-sides on the vessel's own curves."""
    R, s = (halved(RADII), halved(vessel.stations)) if quadratic else (RADII, vessel.stations)
    step = 2 if quadratic else 1
    k, j = np.meshgrid(np.arange(len(R)), np.arange(len(s)), indexing="ij")
    used = (k % step == 0) | (j % step == 0)
    number = np.where(used, np.cumsum(used.ravel()).reshape(used.shape) - 1, -1)
    places = [(0, 0), (step, 0), (step, step), (0, step)]
    places += [(1, 0), (2, 1), (1, 2), (0, 1)] if quadratic else []
    low = (k[:-1:step, :-1:step].ravel(), j[:-1:step, :-1:step].ravel())
    quads = np.stack([number[low[0] + dk, low[1] + dj] for dk, dj in places], axis=1)
    ends = [number[0, :-1:step], number[0, step::step]]
    return SectionMesh(
        points=vessel.place(R[k], s[j])[used],
        quads=quads,
        material=np.zeros(len(quads), dtype=np.int64),
        materials=("rubber",),
        rim=np.zeros(0, dtype=np.int64),
        outer=np.zeros((0, 2), dtype=np.int64),
        inner=np.stack(ends, axis=1),
    )


def halved(values: FloatArray) -> FloatArray:
    """The values and the means of neighbours between them."""
    fine = np.repeat(values, 2)[:-1]
    fine[1::2] = (values[1:] + values[:-1]) / 2.0
    return fine


def table() -> str:
    """Errors of all elements in both vessels, in percent, as a Markdown table."""
    heads = [f"{vessel.name}, nu = {nu}" for vessel in VESSELS for nu in POISSON]
    lines = [f"| element | {' | '.join(heads)} |", "|---" * (len(heads) + 1) + "|"]
    for name, element in ELEMENTS.items():
        errors = [error(vessel, element, nu) for vessel in VESSELS for nu in POISSON]
        lines.append(f"| {name} | {' | '.join(f'{100.0 * value:.3f} %' for value in errors)} |")
    return "\n".join(lines)


def main() -> None:
    angle = f"{degrees(SECTOR_ANGLE):.0f}"
    chord = 1.0 - cos(SECTOR_ANGLE / 2.0)
    print("Error of nodal displacements against Lame's, thick vessels under internal pressure\n")
    print(table())
    print(f"\nA chord of {angle} degrees lies {100.0 * chord:.2f} % inside its circle half-way.")
    print(f"numpy {np.__version__}, {platform.machine()}")


if __name__ == "__main__":
    main()
