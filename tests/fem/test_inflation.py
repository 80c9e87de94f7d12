"""Inflation against what holds for any pressurised body, and against closed forms.

1. A closed free cavity (a hollow torus): K + K_G + K_P does no work in a rigid motion. A
   translation changes nothing; a rotation turns body, stress and pressure together. True of the
   linear case on the shape at rest, and of the nonlinear one at equilibrium.
2. The resultant of the pressure on a sector is p times the area that its two ends cut.
3. Thick ring in plane strain (Lame): u = (1 + nu) p a^2/(E (b^2 - a^2)) [(1 - 2 nu) r + b^2/r];
   mean hoop stress p a/(b - a).
4. Thin ring in plane strain, follower load P = p a/R per length of its middle line:
   omega^2 = n^2 (n^2 - 1) [(n^2 - 1) EI/((1 - nu^2) R^4) + P/R] / (rho A (n^2 + 1)).
   It buckles at P = -3 EI/((1 - nu^2) R^3), and at -4 EI/... where the load does not follow.
Reference of 4: Timoshenko & Gere, Theory of Elastic Stability, chapter 7, on rings.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fem.blocks import cell_of, order_matrix, rectangle, section
from scipy.linalg import eigh

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.case import Cord, Damping, FractionalZener, Ply, Viscoelastic
from tyrefrf.errors import SolveError
from tyrefrf.fem.assembly import CellMatrices, assemble_cell
from tyrefrf.fem.constitutive import constitutive
from tyrefrf.fem.elasticity import isotropic
from tyrefrf.fem.elements import ELEMENTS, Element
from tyrefrf.fem.frames import axes
from tyrefrf.fem.inflation import Inflatable, Inflation
from tyrefrf.fem.orientation import in_bricks
from tyrefrf.fem.statics import PeriodicCell
from tyrefrf.mesh.cell import CellMesh, revolve
from tyrefrf.mesh.section import SectionMesh

E, NU, RHO = 28e6, 0.3, 1100.0
ROUND_OFF = 1e-10  # of the geometric stiffness's own forces
N_CELLS = 24
SPINS = {0: np.array([0.0, 1.0, 0.0]), 1: np.array([1.0, 0.0, 1.0j])}
"""Directions of rigid motions by circumferential order: along the axle, and turning with it."""

names = pytest.mark.parametrize("name", ELEMENTS)
orders = pytest.mark.parametrize("order", SPINS)
finite = pytest.mark.parametrize("name", ["hex20", "hex20r"])


def torus(element: Element) -> CellMesh:
    """A cell of a hollow torus of middle radius 0.25 m, the tube's radii 50 and 60 mm."""
    n_around, radii = 12, np.array([0.05, 0.06])
    phi = 2.0 * np.pi * np.arange(n_around) / n_around
    ring = np.stack([np.cos(phi), 0.8 * np.sin(phi)], axis=1)  # not quite round
    points = np.concatenate([np.array([0.25, 0.0]) + r * ring for r in radii])
    k = np.arange(n_around)
    following = (k + 1) % n_around
    quads = np.stack([k, k + n_around, following + n_around, following], axis=1)
    tube = section(points, quads, element)
    inside = [0, 3, 7][: 2 + (element.n_nodes == 20)]
    return revolve(replace(tube, inner=tube.quads[:, inside]), 2.0 * np.pi / N_CELLS, 1)


def inflated(
    mesh: CellMesh, element: Element, kind: str, pressure: float, held: FloatArray | None = None
) -> Inflation:
    """The mesh under pressure, with some dofs (n_nodes, 3) held; its K in full."""
    cell = cell_of(mesh, element, E, NU, RHO)
    if held is not None:
        cell = replace(cell, fixed=held.ravel())
    C = {mesh.materials[0]: isotropic(E, NU)}
    state = getattr(Inflatable(mesh, element, cell, C, C), kind)(pressure)
    return replace(state, K={**cell.K, **state.K})


def free_torus(name: str, kind: str, pressure: float) -> tuple[CellMesh, Inflation]:
    """A torus held only against sliding along and turning about the axle, at one node a section."""
    mesh = torus(ELEMENTS[name])
    held = np.zeros((mesh.n_nodes, 3), dtype=bool)
    held[mesh.planes[[0, -1], 0], 1:] = True
    return mesh, inflated(mesh, ELEMENTS[name], kind, pressure, held)


def forces(mesh: CellMesh, entries: FloatArray, order: int, u: ComplexArray) -> ComplexArray:
    """Forces (n_own,) of a stiffness under motions u (n_own nodes, xyz) of an order."""
    cell = cell_of(mesh, ELEMENTS["hex8" if mesh.bricks.shape[1] == 8 else "hex20"], E, NU, RHO)
    mu = order * mesh.sector_angle
    A = order_matrix(cell.sparse(entries).toarray(), cell.n_face, mu)
    theta = mesh.points[: mesh.n_own, 2]
    return A @ np.einsum("nij,nj->ni", axes(theta), u).ravel()


def rigid_motions(mesh: CellMesh, displacement: FloatArray, order: int) -> list[ComplexArray]:
    """Translation and rotation (n_own, xyz) of the displaced nodes, of an order."""
    R = axes(mesh.points[:, 2])
    x = (mesh.cartesian + np.einsum("nij,ni->nj", R, displacement))[: mesh.n_own]
    direction = SPINS[order]
    return [np.broadcast_to(direction, x.shape), np.cross(direction, x)]


@orders
@names
def test_rigid_motions_of_a_linearly_inflated_torus_cost_nothing(name, order):
    mesh, state = free_torus(name, "linear", 5e4)
    K = state.K[mesh.materials[0]] + state.K_G + state.K_P
    for u in rigid_motions(mesh, np.zeros((mesh.n_nodes, 3)), order):
        scale = np.linalg.norm(abs(state.K_G).max() * u)
        assert np.linalg.norm(forces(mesh, K, order, u)) < ROUND_OFF * scale


@orders
@finite
def test_rigid_motions_of_a_torus_at_equilibrium_cost_nothing(name, order):
    mesh, state = free_torus(name, "nonlinear", 1e5)
    K = state.K[mesh.materials[0]] + state.K_G + state.K_P
    for u in rigid_motions(mesh, state.displacement, order):
        scale = np.linalg.norm(abs(state.K_G).max() * u)
        assert np.linalg.norm(forces(mesh, K, order, u)) < 1e-8 * scale  # Newton's 1e-10


@names
def test_rotation_needs_both_stiffnesses(name):
    """Left alone, K_G and K_P resist a rotation: the test above can fail."""
    mesh, state = free_torus(name, "linear", 5e4)
    _, rotation = rigid_motions(mesh, np.zeros((mesh.n_nodes, 3)), 1)
    each = [np.linalg.norm(forces(mesh, K, 1, rotation)) for K in (state.K_G, state.K_P)]
    assert each[0] == pytest.approx(each[1], rel=1e-6)
    assert each[0] > 0.0


@names
def test_resultant_is_pressure_times_the_area_of_the_ends(name):
    mesh, state = free_torus(name, "linear", 5e4)
    expected = 5e4 * 2.0 * cut_area(mesh.section) * np.sin(mesh.sector_angle / 2.0)
    np.testing.assert_allclose(state.resultant, [expected, 0.0, 0.0], atol=1e-11 * expected)


def cut_area(tube: SectionMesh) -> float:
    """Area [m2] inside the inner line of straight edges, by Green's theorem."""
    r, y = np.moveaxis(tube.points[tube.inner[:, :2]], 2, 0)
    return float(np.sum(r[:, 0] * y[:, 1] - r[:, 1] * y[:, 0]) / 2.0)


def plane_ring(
    element: Element, a: float, b: float, n_cells: int, n_through: int
) -> tuple[CellMesh, FloatArray]:
    """A cell of a ring, and which dofs plane strain holds; order 0 needs no other support."""
    width = 0.02
    flat = rectangle(np.linspace(a, b, n_through + 1), np.array([0.0, width]), element)
    on_a = np.flatnonzero(flat.points[:, 0] == a)
    line = on_a[np.argsort(flat.points[on_a, 1])]
    edge = line if len(line) == 2 else line[[0, 2, 1]]
    mesh = revolve(replace(flat, inner=edge[None]), 2.0 * np.pi / n_cells, 1)
    held = np.zeros((mesh.n_nodes, 3), dtype=bool)
    held[:, 1] = True
    return mesh, held


def without_turning(mesh: CellMesh, held: FloatArray) -> FloatArray:
    """The same, with one node of a section held against turning about the axle."""
    held = held.copy()
    held[mesh.planes[[0, -1], 0], 2] = True
    return held


@names
def test_ring_grows_as_lame_says(name):
    a, b, p = 0.25, 0.30, 1e4
    mesh, held = plane_ring(ELEMENTS[name], a, b, n_cells=120, n_through=8)
    state = inflated(mesh, ELEMENTS[name], "linear", p, without_turning(mesh, held))
    r = mesh.section.points[:, 0]
    u = (1 + NU) * p * a**2 / (E * (b**2 - a**2)) * ((1 - 2 * NU) * r + b**2 / r)
    np.testing.assert_allclose(state.displacement[: mesh.n_face, 0], u, rtol=1.5e-3)
    assert state.stress[:, 2].mean() == pytest.approx(p * a / (b - a), rel=1e-3)


@finite
def test_nonlinear_tends_to_linear_as_the_pressure_falls(name):
    mesh, held = plane_ring(ELEMENTS[name], 0.25, 0.30, n_cells=60, n_through=2)
    held = without_turning(mesh, held)
    departure = []
    for p in (2e3, 1e3):
        u = [inflated(mesh, ELEMENTS[name], kind, p, held).displacement for kind in KINDS]
        departure.append(np.linalg.norm(u[1] - u[0]) / np.linalg.norm(u[0]))
    assert departure[0] < 5e-3
    assert departure[0] / departure[1] == pytest.approx(2.0, rel=0.02)


KINDS = ("linear", "nonlinear")


@finite
def test_newton_converges_quadratically_and_says_so(name):
    _, state = free_torus(name, "nonlinear", 1e5)
    assert state.steps[-1].share == 1.0
    assert state.steps[-1].iterations <= 8
    assert state.steps[-1].residual < 1e-10


THIN = (0.2725, 0.2775)
BENDING = E * (THIN[1] - THIN[0]) ** 3 / 12.0 / (1.0 - NU**2)  # of a unit width [N m]
R = sum(THIN) / 2.0


def pressurised_thin_ring(n: int, P: float) -> float:
    """omega^2 [1/s2] with n nodal diameters under P [N/m2 of the middle line]."""
    stiffness = (n**2 - 1) * BENDING / R**4 + P / R
    return n**2 * (n**2 - 1) * stiffness / (RHO * (THIN[1] - THIN[0]) * (n**2 + 1))


def lowest_squared(n: int, p: float, *, pressure_stiffness: bool = True) -> float:
    """The same by quadratic bricks, lowest eigenvalue of order n."""
    element = ELEMENTS["hex20r"]
    mesh, held = plane_ring(element, *THIN, n_cells=72, n_through=1)
    state = inflated(mesh, element, "linear", p, without_turning(mesh, held))
    cell = state.applied_to(
        cell_of(mesh, element, E, NU, RHO), pressure_stiffness=pressure_stiffness
    )
    free = ~held.ravel()
    n_face = int(free[: cell.n_face].sum())
    K, M = (
        order_matrix(
            cell.sparse(entries).toarray()[np.ix_(free, free)], n_face, n * mesh.sector_angle
        )
        for entries in (sum(cell.K.values()) + cell.K_G + cell.K_P, cell.M)
    )
    return float(eigh(K, M, eigvals_only=True, subset_by_index=[0, 0])[0])


@pytest.mark.parametrize("n", [2, 3, 4, 5, 6])
def test_pressurised_thin_ring(n):
    p = 3.0 * BENDING / R**3  # bending and tension matter alike
    expected = pressurised_thin_ring(n, p * THIN[0] / R)
    where_the_load_stands = 0.3 / 55.0  # a or R in the formula: h/(2 R) of the tension's part
    assert lowest_squared(n, p) == pytest.approx(expected, rel=where_the_load_stands)
    assert lowest_squared(n, 1e-6 * p) < 0.95 * expected


def test_ring_buckles_where_the_load_follows_and_later_where_it_does_not():
    P = 3.0 * BENDING / R**3
    p = P * R / THIN[0]
    assert lowest_squared(2, -0.99 * p) > 0.0
    assert lowest_squared(2, -1.01 * p) < 0.0
    assert lowest_squared(2, -1.01 * p, pressure_stiffness=False) > 0.0
    assert lowest_squared(2, -1.01 * p * 4.0 / 3.0, pressure_stiffness=False) < 0.0


@pytest.mark.parametrize("name", ["hex8i", "hex8"])
def test_bricks_without_finite_strain_refuse(name):
    with pytest.raises(SolveError, match="finite-strain"):
        free_torus(name, "nonlinear", 1e5)


@pytest.mark.parametrize("stiffness", [1.0, 1e6])
@finite
def test_newton_converges_however_small_the_pressure_is_beside_the_stiffness(name, stiffness):
    """Strains of 1e-4 and of 1e-10: what rounds off must round off with the strain."""
    element, p = ELEMENTS[name], 1e3
    mesh, held = plane_ring(element, 0.25, 0.30, n_cells=60, n_through=2)
    cell = replace(
        cell_of(mesh, element, stiffness * E, NU, RHO), fixed=without_turning(mesh, held).ravel()
    )
    C = {"rubber": isotropic(stiffness * E, NU)}
    linear, newton = (getattr(Inflatable(mesh, element, cell, C, C), kind)(p) for kind in KINDS)
    assert [step.share for step in newton.steps] == [1.0]
    departure = np.linalg.norm(newton.displacement - linear.displacement)
    assert departure < 3e-3 / stiffness * np.linalg.norm(linear.displacement) + 1e-15


CORDS = Ply(
    kind="ply",
    cord=Cord(E=2e9, nu=0.3, rho=1400.0),
    rubber=Viscoelastic(
        nu=0.48,
        rho=1100.0,
        modulus=FractionalZener(kind="zener", E_0=6e6, E_inf=1e9, tau=1e-6, alpha=0.5),
    ),
    volume_fraction=0.3,
    angles=(20.0, -20.0),
)


def inflated_cords(pressure: float) -> tuple[CellMatrices, CellMatrices]:
    """A ring of plies at rest, and under pressure by Newton's method."""
    element, law = ELEMENTS["hex20r"], constitutive(CORDS)
    mesh, held = plane_ring(element, 0.25, 0.30, n_cells=60, n_through=2)
    cell = assemble_cell(mesh, {"rubber": CORDS}, element, Damping())
    cell = replace(cell, fixed=without_turning(mesh, held).ravel())
    C = {"rubber": in_bricks(law, law.reference, element, mesh.cartesian[mesh.bricks])}
    state = Inflatable(mesh, element, cell, C, C).nonlinear(pressure)
    return cell, state.applied_to(cell, pressure_stiffness=True)


@pytest.mark.parametrize("hertz", [0.0, 100.0, 2000.0])
def test_under_next_to_no_pressure_plies_relax_as_they_do_at_rest(hertz):
    at_rest, inflated_by_a_breath = inflated_cords(1e-4)
    D, expected = (
        cell.dynamic_stiffness(2.0 * np.pi * hertz) for cell in (inflated_by_a_breath, at_rest)
    )
    assert np.abs(D - expected).max() < 1e-8 * np.abs(expected).max()


def test_at_0_hz_plies_under_pressure_have_the_stiffness_that_they_were_inflated_with():
    at_rest, taut = inflated_cords(1e4)
    K = taut.K["rubber"]
    relaxed = taut.relaxation["rubber"].stiffness(K, 0.0)
    assert np.abs(relaxed - K).max() < 1e-10 * np.abs(K).max()
    assert np.abs(K - at_rest.K["rubber"]).max() > 1e-4 * np.abs(K).max()  # its shape is another


def test_a_stiffness_that_nothing_holds_is_refused():
    mesh = torus(ELEMENTS["hex8"])
    cell = cell_of(mesh, ELEMENTS["hex8"], E, NU, RHO)
    with pytest.raises(SolveError, match="nothing holds the tyre"):
        PeriodicCell(cell).solve(0.0 * cell.M, np.ones(cell.n_own))
