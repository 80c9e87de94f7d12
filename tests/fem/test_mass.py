"""Mass, static moments and inertia of the body that the mesh really is.

A ring of N cells of straight-sided quadrilaterals is a polygonal body where the edges around are
chords; with mid-sides on the circle they are parabolas. In the frame of a brick's mid-angle a
point of the section at radius r moves along x = r g(t), z = r h(t), -1 <= t <= 1, where with
a = half the brick's angle
    chord:     g = cos a,                   h = t sin a,
    parabola:  g = 1 - t^2 (1 - cos a),     h = t sin a.
Exact solution: with P_pq = integral of r^p y^q over the section's polygon and w = g h' - h g',
    mass             rho P_10 int w dt
    static moments   rho P_11 int w dt (along y),     rho P_20 int g w dt (along x)
    inertia about y  rho P_30 int (g^2 + h^2) w dt,   and int y^2 = rho P_12 int w dt.
P_pq follows from the boundary alone by Green's theorem, int r^p y^q dA = loop of
r^(p+1)/(p+1) y^q dy. With N to infinity these become Pappus's: mass = 2 pi rho P_10.
A consistent mass gives each as v^T M v with the nodal values v of a rigid motion, because shape
functions reproduce linear fields and straight-sided bricks alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from fem.blocks import cell_of, crooked_section, dense, rectangle, revolve
from numpy.polynomial import Polynomial

from tyrefrf.arrays import FloatArray
from tyrefrf.case.geometry import Geometry
from tyrefrf.fem.elements import ELEMENTS, Element
from tyrefrf.fem.frames import rotations
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.mesh.profile import tyre_section
from tyrefrf.mesh.section import SectionMesh

RHO = 1100.0
ROUND_OFF = 1e-12  # relative; measured: below 1e-14
SIXTH_POWER = 1e-8  # the inertia of a parabolic sweep is of degree 6 in t, 3 points know 5: 4e-9
N_CELLS = 30


def polygon_moment(section: SectionMesh, p: int, q: int) -> float:
    """P_pq: integral of r^p y^q over a section of straight-sided quadrilaterals."""
    corners = section.points[section.quads[:, :4]]  # edges inside cancel in the loop
    start, step = corners, np.roll(corners, -1, axis=1) - corners
    t, w = np.polynomial.legendre.leggauss(4)  # exact up to degree 7
    r, y = np.moveaxis(start[..., None] + step[..., None] * (1.0 + t) / 2.0, 2, 0)
    return float(np.sum(r ** (p + 1) / (p + 1) * y**q * step[:, :, 1:] * w / 2.0))


def test_polygon_moments_of_a_rectangle():
    r, y = np.array([1.0, 2.5, 3.0]), np.array([2.0, 5.0])
    section = rectangle(r, y, ELEMENTS["hex8"])
    assert polygon_moment(section, 1, 2) == pytest.approx((9 - 1) / 2 * (125 - 8) / 3, rel=1e-14)


@dataclass(frozen=True)
class Path:
    """How a point of the section sweeps through a brick."""

    g: Polynomial
    h: Polynomial

    @classmethod
    def of(cls, brick_angle: float, straight: bool) -> Path:
        s, c = np.sin(brick_angle / 2.0), np.cos(brick_angle / 2.0)
        return cls(Polynomial([c] if straight else [1.0, 0.0, c - 1.0]), Polynomial([0.0, s]))

    def integral(self, weight: Polynomial) -> float:
        """Of weight * w over -1 <= t <= 1."""
        whole = (weight * (self.g * self.h.deriv() - self.h * self.g.deriv())).integ()
        return float(whole(1.0) - whole(-1.0))


@dataclass(frozen=True)
class Body:
    """A cell, its mass matrix in cylindrical dofs, and the closed forms of its shape."""

    mesh: CellMesh
    M: FloatArray
    path: Path

    def exact(self, p: int, q: int, weight: Polynomial) -> float:
        """Closed form: rho P_pq times an integral over the sweep, all layers [kg m^(p+q-1)]."""
        return RHO * polygon_moment(self.mesh.section, p, q) * self.path.integral(weight)

    def product(self, u: FloatArray, v: FloatArray) -> float:
        """The integral of rho u . v, both (n, 3) in x, y, z at the nodes."""
        T = rotations(self.mesh.points[None, :, 2])[0]
        return float((T @ u.ravel()) @ self.M @ (T @ v.ravel()))


def body(section: SectionMesh, element: Element, n_cells: int, straight: bool = True) -> Body:
    """One of n_cells cells, the middle of it at angle 0, with chords or with circles around."""
    angle = 2.0 * np.pi / n_cells
    mesh = revolve(section, angle, 1)
    middle = mesh.points[:, 2] == angle / 2.0
    mesh.points[:, 2] -= angle / 2.0
    if straight:
        mesh.points[middle, 0] *= np.cos(angle / 2.0)
    M = dense(cell_of(mesh, element, 28e6, 0.45, RHO))[1]
    return Body(mesh, M, Path.of(angle, straight))


def along(axis: int, mesh: CellMesh, by: FloatArray | float = 1.0) -> FloatArray:
    """Displacements (n, 3) along x, y or z, everywhere the same or varying."""
    return np.outer(np.broadcast_to(by, mesh.n_nodes), np.eye(3)[axis])


ONE = Polynomial([1.0])


@pytest.fixture(params=ELEMENTS.values(), ids=ELEMENTS.keys())
def crooked(request):
    return body(crooked_section(request.param), request.param, N_CELLS)


@pytest.fixture(params=["hex20", "hex20r"])
def round_one(request):
    element = ELEMENTS[request.param]
    return body(crooked_section(element), element, N_CELLS, straight=False)


@pytest.mark.parametrize("axis", [0, 1, 2], ids="xyz")
def test_mass_is_that_of_the_meshed_body(crooked, axis):
    whole = along(axis, crooked.mesh)
    assert crooked.product(whole, whole) == pytest.approx(crooked.exact(1, 0, ONE), rel=ROUND_OFF)


@pytest.mark.parametrize("pair", [(0, 1), (1, 2), (2, 0)], ids=str)
def test_translations_do_not_couple(crooked, pair):
    u, v = (along(axis, crooked.mesh) for axis in pair)
    assert abs(crooked.product(u, v)) <= ROUND_OFF * crooked.exact(1, 0, ONE)


@pytest.mark.parametrize("axis", [0, 1, 2], ids="xyz")
def test_static_moments_are_those_of_the_meshed_body(crooked, axis):
    exact = [crooked.exact(2, 0, crooked.path.g), crooked.exact(1, 1, ONE), 0.0][axis]
    u = along(0, crooked.mesh)
    v = along(0, crooked.mesh, by=crooked.mesh.cartesian[:, axis])
    scale = ROUND_OFF * crooked.exact(2, 0, ONE)
    assert crooked.product(u, v) == pytest.approx(exact, abs=scale)


def test_inertia_about_the_axle_is_that_of_the_meshed_body(crooked):
    spin = np.cross(np.array([0.0, 1.0, 0.0]), crooked.mesh.cartesian)
    g, h = crooked.path.g, crooked.path.h
    exact = crooked.exact(3, 0, g**2 + h**2)
    assert crooked.product(spin, spin) == pytest.approx(exact, rel=ROUND_OFF)


def test_second_moment_across_the_mid_plane_is_that_of_the_meshed_body(crooked):
    shear = along(2, crooked.mesh, by=crooked.mesh.cartesian[:, 1])
    exact = crooked.exact(1, 2, ONE)
    assert crooked.product(shear, shear) == pytest.approx(exact, rel=ROUND_OFF)


def test_mass_of_curved_bricks_is_that_of_the_meshed_body(round_one):
    whole = along(0, round_one.mesh)
    assert round_one.product(whole, whole) == pytest.approx(
        round_one.exact(1, 0, ONE), rel=ROUND_OFF
    )


def test_inertia_of_curved_bricks_is_nearly_that_of_the_meshed_body(round_one):
    spin = np.cross(np.array([0.0, 1.0, 0.0]), round_one.mesh.cartesian)
    g, h = round_one.path.g, round_one.path.h
    exact = round_one.exact(3, 0, g**2 + h**2)
    assert round_one.product(spin, spin) == pytest.approx(exact, rel=SIXTH_POWER)


def test_mass_of_the_built_in_tyre_is_that_of_its_polygon():
    section = tyre_section(Geometry(material="rubber"), quadratic=False)
    tyre = body(section, ELEMENTS["hex8i"], 45)
    whole = along(1, tyre.mesh)
    assert tyre.product(whole, whole) == pytest.approx(tyre.exact(1, 0, ONE), rel=ROUND_OFF)


@pytest.mark.parametrize(("name", "order"), [("hex8i", 2.0), ("hex8", 2.0), ("hex20", 4.0)])
def test_mass_of_the_ring_converges_to_pappus(name, order):
    section = crooked_section(ELEMENTS[name])
    pappus = 2.0 * np.pi * RHO * polygon_moment(section, 1, 0)
    n_cells = np.array([15, 30, 60])
    error = [abs(ring_mass(section, ELEMENTS[name], n) / pappus - 1.0) for n in n_cells]
    observed = -np.polyfit(np.log(n_cells), np.log(error), 1)[0]
    assert observed == pytest.approx(order, abs=0.05)


def ring_mass(section: SectionMesh, element: Element, n_cells: int) -> float:
    """Mass of the whole ring [kg], mid-sides on the circle."""
    cell = body(section, element, n_cells, straight=element.n_nodes == 8)
    whole = along(1, cell.mesh)
    return n_cells * cell.product(whole, whole)
