"""Cells and rings of materials that depend on frequency, or lie at an angle.

Exact: at every line the cell is that of a constant material with the line's own modulus; a cell of
plies is that assembled from the line's complex elasticity; all solvers agree; the power put in is
omega/2 Im(q^H K q); a section mirrored about y = 0 has its cords at the opposite angle.
"""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from fem.blocks import crooked_section, revolve
from rings import THETA, R, Y, omegas, section_error, tyre
from small import case_with

from tyrefrf.case import (
    Cord,
    Damping,
    FractionalZener,
    Isotropic,
    Orthotropic,
    Ply,
    PronySeries,
    TabledModulus,
    Viscoelastic,
)
from tyrefrf.fem.assembly import CellAssembly, Pattern, assemble_cell, dofs_of
from tyrefrf.fem.constitutive import constitutive
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.fem.frames import rotations, turned
from tyrefrf.fem.orientation import in_bricks
from tyrefrf.solvers import SOLVERS, solve_line
from tyrefrf.study.run import run_case

ROUND_OFF = 1e-12  # of the largest entry
SOLVED = 1e-9  # of a section's displacement
LINES = omegas(1.0, 90.0, 1500.0)

ZENER = FractionalZener(kind="zener", E_0=6e6, E_inf=1e9, tau=1e-6, alpha=0.5)
LAWS = {
    "zener": ZENER,
    "prony": PronySeries(kind="prony", E_inf=6e6, g=(0.3, 0.4), tau=(1e-5, 1e-3)),
    "table": TabledModulus(kind="table", frequencies=(1, 2000), E=(5e6, 2e7), eta=(0.1, 0.3)),
}
RUBBER = Viscoelastic(nu=0.48, rho=1100.0, modulus=ZENER)
NYLON = Cord(E=2e9, nu=0.3, rho=1400.0)


def plies(*angles: float) -> Ply:
    return Ply(kind="ply", cord=NYLON, rubber=RUBBER, volume_fraction=0.3, angles=angles)


ANGLED = plies(20.0)
LAMINATES = {"one": ANGLED, "pair": plies(20.0, -20.0), "three": plies(90.0, 22.0, -25.0)}

WOOD = Orthotropic(
    kind="orthotropic",
    **{"E_1": 9e8, "E_2": 2e8, "E_3": 3e7, "nu_12": 0.4, "nu_13": 0.5, "nu_23": 0.6},
    **{"G_12": 6e7, "G_13": 4e7, "G_23": 1e7, "rho": 800.0, "eta": 0.1, "angle": 35.0},
)
STUFF = {**LAMINATES, "wood": WOOD, "rubber": Isotropic(nu=0.48, rho=1100.0, modulus=ZENER)}

all_elements = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS.keys())
all_names = pytest.mark.parametrize("element", ELEMENTS)
all_lines = pytest.mark.parametrize("omega", LINES)


def close(A, B, tolerance=ROUND_OFF):
    return np.abs(A - B).max() <= tolerance * np.abs(B).max()


def cell(element, stuff, theta: float = 0.0):
    """Of six crooked bricks, the outer two of steel."""
    section = crooked_section(element)
    section = replace(section, material=np.array([0, 0, 0, 0, 1, 1]), materials=("rubber", "steel"))
    mesh = revolve(section, np.deg2rad(8.0), 1)
    mesh = replace(mesh, points=mesh.points + np.array([0.0, 0.0, theta]))
    steel = Isotropic(E=2e11, nu=0.3, rho=7800.0)
    return assemble_cell(mesh, {"rubber": stuff, "steel": steel}, element, Damping(alpha=2.0))


@all_lines
@all_elements
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())
def test_every_line_is_that_of_a_constant_material_with_its_modulus(law, element, omega):
    stuff = Isotropic(nu=0.48, rho=1100.0, modulus=law)
    E = 2.96 * constitutive(stuff).elasticity(omega)[3, 3]
    constant = Isotropic(nu=0.48, rho=1100.0, E=E.real, eta=E.imag / E.real)
    found, expected = cell(element, stuff), cell(element, constant)
    assert close(found.dynamic_stiffness(omega), expected.dynamic_stiffness(omega))


def by_hand(element, stuff, omega):
    """Entries of D of one material, its bricks assembled from the line's own elasticity."""
    mesh = revolve(crooked_section(element), np.deg2rad(8.0), 1)
    X, T, dofs = (
        mesh.cartesian[mesh.bricks],
        rotations(mesh.points[mesh.bricks, 2]),
        dofs_of(mesh.bricks),
    )
    law = constitutive(stuff)
    K = turned(T, element.stiffness(X, in_bricks(law, law.elasticity(omega), element, X)))
    M = turned(T, element.mass(X, law.rho))
    pattern = Pattern.of(dofs, 3 * mesh.n_nodes)
    real, imag, mass = (pattern.add(dofs, A) for A in (K.real.copy(), K.imag.copy(), M))
    made = assemble_cell(mesh, {"rubber": stuff}, element, Damping())
    return made, real + 1j * imag - omega**2 * mass


@all_lines
@all_elements
@pytest.mark.parametrize("stuff", STUFF.values(), ids=STUFF.keys())
def test_every_line_is_that_of_bricks_of_the_lines_own_elasticity(stuff, element, omega):
    made, expected = by_hand(element, stuff, omega)
    assert close(made.dynamic_stiffness(omega), expected)


def test_scaling_is_not_enough_for_plies():
    made, expected = by_hand(ELEMENTS["hex8i"], ANGLED, 9000.0)
    E = ZENER.E_0 * constitutive(Isotropic(nu=0.3, rho=1.0, modulus=ZENER)).modulus.scale(9000.0)
    scaled = made.K["rubber"] * E / ZENER.E_0 - 9000.0**2 * made.M
    assert not close(scaled, expected, 0.1)


@all_elements
def test_the_stored_stiffness_is_that_at_0_hz(element):
    made = cell(element, ANGLED)
    K = made.K["rubber"]
    assert close(made.relaxation["rubber"].stiffness(K, 0.0), K)


@all_elements
def test_a_cell_of_plies_is_the_same_wherever_it_stands_around_the_axle(element):
    here, there = (cell(element, ANGLED, theta) for theta in (0.0, 2.1))
    assert close(there.dynamic_stiffness(900.0), here.dynamic_stiffness(900.0))


@pytest.mark.parametrize("element", ["hex8i", "hex20"])
def test_matrices_of_plies_are_small_and_travel_to_other_processes(element):
    plain = tyre(element=element, n_cells=60).cell
    made = tyre(element=element, n_cells=60, stuff=LAMINATES["pair"]).cell
    data = pickle.dumps(made)
    assert len(data) < 7 * len(pickle.dumps(plain))  # measured: 4.9 (hex8i: modes) and 3.3
    again = pickle.loads(data)
    np.testing.assert_array_equal(again.dynamic_stiffness(700.0), made.dynamic_stiffness(700.0))


def mirrored(ring, axis: int) -> np.ndarray:
    """The cell's dofs as its mirror image about y = 0 (axis 1) or its middle (axis 2) has them."""
    points = ring.mesh.points * [1.0, 1.0, 1e3]
    image = points.copy()
    image[:, axis] = (points[:, 2].max() if axis == 2 else 0.0) - points[:, axis]
    nodes = np.argmin(np.linalg.norm(points[:, None] - image, axis=2), axis=1)
    sign = np.ones(3)
    sign[axis] = -1.0
    S = np.zeros((3 * len(points), 3 * len(points)))
    rows = 3 * np.arange(len(points))[:, None] + np.arange(3)
    S[rows.ravel(), (3 * nodes[:, None] + np.arange(3)).ravel()] = np.tile(sign, len(points))
    return S


@pytest.mark.parametrize("axis", [1, 2], ids=["about y = 0", "about the cell's middle"])
@all_names
def test_the_mirror_image_has_its_cords_at_the_opposite_angle(element, axis):
    rings = [
        tyre(element=element, n_cells=20, elements_along=4, stuff=plies(*angles))
        for angles in ((20.0,), (-20.0,), (20.0, -20.0))
    ]
    left, right, both = (
        ring.cell.sparse(ring.cell.dynamic_stiffness(900.0)).toarray() for ring in rings
    )
    S = mirrored(rings[0], axis)
    assert close(S @ left @ S.T, right)
    assert not close(S @ left @ S.T, left, 1e-3)
    assert close(S @ both @ S.T, both)


def loaded(ring):
    return ring.point_loads((0, 4, R), (ring.n_cells // 2, 3, THETA), (0, 5, Y))


@all_lines
@all_names
@pytest.mark.parametrize("stuff", LAMINATES.values(), ids=LAMINATES.keys())
def test_solvers_agree_on_cords_at_an_angle(stuff, element, omega):
    ring = tyre(element=element, n_cells=7, elements_along=4, elements_around=1, stuff=stuff)
    problem = ring.problem(loaded(ring))
    q = {name: solver(problem).field(omega).q for name, solver in SOLVERS.items()}
    assert section_error(q["recursive"], q["direct"], ring.mesh.n_face) < SOLVED
    assert section_error(q["cyclic"], q["direct"], ring.mesh.n_face) < SOLVED


@all_lines
@all_names
def test_solvers_agree_on_an_orthotropic_tyre(element, omega):
    ring = tyre(element=element, n_cells=7, elements_along=4, stuff=WOOD)
    problem = ring.problem(loaded(ring))
    q = {name: solver(problem).field(omega).q for name, solver in SOLVERS.items()}
    assert section_error(q["recursive"], q["direct"], ring.mesh.n_face) < SOLVED
    assert section_error(q["cyclic"], q["direct"], ring.mesh.n_face) < SOLVED


@pytest.mark.parametrize("name", LAMINATES)
def test_a_radial_force_on_mid_tread_moves_the_tyre_as_its_cords_lie(name):
    """A half-turn about the force brings all cords back, a mirror only those of a balanced pair."""
    ring = tyre(n_cells=9, elements_along=4, stuff=LAMINATES[name])
    ahead, behind, behind_mirrored = (2, 2, R), (-2, 2, R), (-2, 6, R)
    problem = ring.problem(
        ring.point_loads((0, 4, R)), ring.point_loads(ahead, behind, behind_mirrored, (0, 4, Y))
    )
    H = solve_line(problem, SOLVERS["direct"](problem), 2.0 * np.pi * 90.0).receptance[:, 0]
    assert ring.mesh.section.points[2] == pytest.approx(ring.mesh.section.points[6] * [1, -1])
    assert H[2] == pytest.approx(H[0], rel=SOLVED)
    assert abs(H[3]) < SOLVED * abs(H[0])
    assert (abs(H[1] / H[0] - 1.0) < SOLVED) == (name == "pair")
    assert (abs(H[1] / H[0] - 1.0) > 1e-3) == (name != "pair")


@all_lines
@pytest.mark.parametrize("stuff", LAMINATES.values(), ids=LAMINATES.keys())
def test_power_put_in_is_lost_in_the_rubber(stuff, omega):
    ring = tyre(n_cells=7, elements_along=4, elements_around=2, stuff=stuff)
    loads = loaded(ring)
    q = SOLVERS["direct"](ring.problem(loads)).field(omega).q
    f = loads.toarray().reshape(q.shape)
    P = -0.5 * omega * np.einsum("cal,cal->l", f, q).imag
    made = ring.cell
    loss = made.sparse(made.relaxation["rubber"].stiffness(made.K["rubber"], omega).imag)
    q = np.concatenate([q, np.roll(q[:, : made.n_face], -1, axis=0)], axis=1)
    lost = 0.5 * omega * sum(np.einsum("al,al->l", x.conj(), loss @ x) for x in q)
    assert np.all(P > 0.0)
    np.testing.assert_allclose(lost, P, rtol=SOLVED)


def test_a_second_laminate_on_the_same_bricks_is_as_if_assembled_anew():
    """The parts of its stiffness are kept, what they are multiplied by is its own."""
    element = ELEMENTS["hex8i"]
    mesh = revolve(crooked_section(element), np.deg2rad(8.0), 1)
    bricks = CellAssembly(mesh, element)
    for stuff in (LAMINATES["one"], LAMINATES["three"], STUFF["wood"], LAMINATES["one"]):
        again = bricks.cell({"rubber": stuff}, Damping())
        anew = assemble_cell(mesh, {"rubber": stuff}, element, Damping())
        np.testing.assert_array_equal(again.K["rubber"], anew.K["rubber"])
        D, expected = (cell.dynamic_stiffness(900.0) for cell in (again, anew))
        np.testing.assert_array_equal(D, expected)


PLY_TEXT = """\
kind = "ply"
cord = { E = "2 GPa", nu = 0.3, rho = 1400 }
volume_fraction = 0.3
angles = [20, -20]
[materials.rubber.rubber]
nu = 0.48
rho = 1100
[materials.rubber.rubber.modulus]
kind = "zener"
E_0 = "6 MPa"
E_inf = "1 GPa"
tau = "1 us"
alpha = 0.5
"""
PAPER_TEXT = 'E = "80 MPa"\nnu = 0.42\nrho = 1200.0\neta = 0.1\n'


def test_a_case_of_plies_runs_and_does_not_depend_on_the_number_of_jobs():
    case = case_with((PAPER_TEXT, PLY_TEXT))
    one, two = (run_case(case, jobs=jobs) for jobs in (1, 2))
    np.testing.assert_array_equal(two.receptance, one.receptance)
    assert one.solved.all()
    for load in one.loads:
        Y_drive = one.driving_point(load.name)
        assert (Y_drive.real >= -1e-10 * abs(Y_drive)).all()
