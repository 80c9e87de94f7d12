"""Elasticity in any axes: Bond's matrices against the tensor, and where a layer's axes point.

Exact: C'_mnpq = Q_mi Q_nj Q_pk Q_ql C_ijkl; an orthotropic material's strains under one stress
are 1/E_i and -nu_ij/E_i; three equal E, nu and G = E/(2 (1 + nu)) are Hooke's isotropic law.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fem.blocks import box, crooked_section, on_surface, revolve, solve
from fem.test_patch import PATCH, STRAINS, pull_of_constant_stress, tensor
from hypothesis import given
from hypothesis import strategies as st

from tyrefrf.case import Damping, Geometry, Isotropic, Orthotropic, Transverse
from tyrefrf.fem.assembly import assemble_cell
from tyrefrf.fem.constitutive import constitutive
from tyrefrf.fem.elasticity import VOIGT, isotropic, orthotropic, rotated, strain_rotation
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.fem.orientation import in_bricks, layer_axes
from tyrefrf.fem.plies import in_layer
from tyrefrf.mesh.profile import tyre_section

ROUND_OFF = 1e-12  # of the largest entry
PAIRS = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
CORD = Transverse(
    kind="transverse", E_1=9e8, E_2=2e7, nu_12=0.4, nu_23=0.5, G_12=6e6, rho=1200.0, angle=0.0
)
WOOD = {"E_1": 9e8, "E_2": 2e8, "E_3": 3e7, "nu_12": 0.4, "nu_13": 0.5, "nu_23": 0.6}
WOOD |= {"G_12": 6e7, "G_13": 4e7, "G_23": 1e7, "rho": 800.0}

all_elements = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS.keys())


def wood(**changes: float) -> Orthotropic:
    return Orthotropic(kind="orthotropic", **{**WOOD, **changes})


def turn(seed: int) -> np.ndarray:
    """Three orthonormal axes, left-handed for odd seeds."""
    Q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return Q * np.sign(np.linalg.det(Q)) * (-1.0) ** seed


def general(seed: int) -> np.ndarray:
    """A positive definite elasticity without any symmetry."""
    A = np.random.default_rng(seed).normal(size=(6, 6))
    return 1e6 * (A @ A.T + np.eye(6))


def as_tensor(C: np.ndarray) -> np.ndarray:
    """C_ijkl from C_vw."""
    place = np.empty((3, 3), int)
    for v, (i, j) in enumerate(PAIRS):
        place[i, j] = place[j, i] = v
    return C[place[:, :, None, None], place]


def close(A, B, tolerance=ROUND_OFF):
    return np.abs(A - B).max() <= tolerance * np.abs(B).max()


@pytest.mark.parametrize("seed", range(6))
def test_bonds_matrix_turns_elasticity_as_a_tensor(seed):
    C, Q = general(seed), turn(seed)
    expected = np.einsum("im,jn,kp,lq,ijkl->mnpq", Q, Q, Q, Q, as_tensor(C))
    assert close(as_tensor(rotated(C, Q)), expected)


@pytest.mark.parametrize("seed", range(4))
def test_bonds_matrix_turns_strains_as_a_tensor(seed):
    Q, grad = turn(seed), np.random.default_rng(seed).normal(size=(3, 3))
    strain = np.einsum("vij,ij->v", VOIGT, grad)
    turned = np.einsum("vij,ij->v", VOIGT, Q @ grad @ Q.T)
    assert close(strain_rotation(Q) @ strain, turned)


def test_bonds_matrices_come_in_any_number():
    Q = np.array([[turn(1), turn(2)], [turn(3), turn(4)], [turn(5), turn(6)]])
    T = strain_rotation(Q)
    assert T.shape == (3, 2, 6, 6)
    assert close(T[2, 1], strain_rotation(turn(6)))


def test_orthotropic_strains_under_one_stress_at_a_time():
    S = np.linalg.inv(constitutive(wood()).reference)
    E_1, E_2, E_3 = WOOD["E_1"], WOOD["E_2"], WOOD["E_3"]
    first = [1 / E_1, -0.4 / E_1, -0.5 / E_1]
    second = [-0.4 / E_1, 1 / E_2, -0.6 / E_2]
    third = [-0.5 / E_1, -0.6 / E_2, 1 / E_3]
    expected = np.zeros((6, 6))
    expected[:3, :3] = [first, second, third]
    expected[3:, 3:] = np.diag([1 / 6e7, 1 / 1e7, 1 / 4e7])  # 12, 23, 31
    assert close(S, expected)


def test_isotropic_is_a_special_case_of_orthotropic():
    E, nu, G = 28e6, 0.48, 28e6 / 2.96
    assert close(orthotropic((E,) * 3, (nu,) * 3, (G,) * 3), isotropic(E, nu))


@given(st.floats(-180.0, 180.0))
def test_transverse_is_the_same_all_around_its_fibres(angle):
    a = np.deg2rad(angle)
    about_1 = np.array([[1.0, 0, 0], [0, np.cos(a), np.sin(a)], [0, -np.sin(a), np.cos(a)]])
    C = constitutive(CORD).reference
    assert close(rotated(C, about_1), C)


def test_a_quarter_turn_swaps_the_axes_of_the_layer():
    swapped = wood(
        E_1=2e8, E_2=9e8, nu_12=0.4 * 2 / 9, nu_13=0.6, nu_23=0.5, G_13=1e7, G_23=4e7, angle=90.0
    )
    assert close(constitutive(swapped).reference, constitutive(wood()).reference)


def stiffness_along(C: np.ndarray, direction: np.ndarray) -> float:
    """Stress over strain along a direction, all other strains held."""
    d = np.outer(direction, direction)
    return float(np.einsum("ij,ijkl,kl->", d, as_tensor(C), d))


@pytest.mark.parametrize("angle", [20.0, -35.0, 90.0])
def test_cords_are_stiffest_at_their_angle_from_axis_1_towards_axis_2(angle):
    C = constitutive(CORD.model_copy(update={"angle": angle})).reference
    tried = np.deg2rad(np.arange(-89.0, 91.0))
    along = [stiffness_along(C, np.array([np.cos(a), np.sin(a), 0.0])) for a in tried]
    assert np.rad2deg(tried[np.argmax(along)]) == pytest.approx(angle)


def tyre_bricks(element):
    """A tyre's cell away from theta = 0, and the r, y and theta directions of its Gauss points."""
    section = tyre_section(Geometry(elements_along=8, material="rubber"), element.n_nodes == 20)
    mesh = revolve(section, np.deg2rad(6.0), 1)
    mesh = replace(mesh, points=mesh.points + np.array([0.0, 0.0, np.deg2rad(50.0)]))
    X = mesh.cartesian[mesh.bricks]
    t = np.deg2rad(53.0)
    e = np.array([[np.cos(t), 0, np.sin(t)], [0, 1, 0], [-np.sin(t), 0, np.cos(t)]])
    return mesh, X, np.einsum("egai,ji->egaj", layer_axes(element.tangents(X)), e)


@all_elements
def test_axes_of_a_layer_point_around_along_and_out(element):
    mesh, _, axes = tyre_bricks(element)
    y = mesh.points[mesh.bricks[:, :8], 1].mean(axis=1)
    crown, left, right = abs(y) < 0.03, y < -0.07, y > 0.07
    assert np.allclose(axes @ axes.swapaxes(-1, -2), np.eye(3), atol=1e-14)
    assert np.all(axes[:, :, 0, 2] > 0.998)  # axis 1 within 3 degrees of the middle's theta
    assert np.all(axes[crown][:, :, 1, 1] > 0.9)  # axis 2 to y > 0 at mid-tread
    assert np.all(axes[crown][:, :, 2, 0] > 0.9)  # axis 3 outwards there
    assert np.all(axes[left][:, :, 1, 0] > 0.5)  # axis 2 up the sidewall at y < 0
    assert np.all(axes[left][:, :, 2, 1] < -0.5)
    assert np.all(axes[right][:, :, 1, 0] < -0.5)  # and down that at y > 0
    assert np.all(axes[right][:, :, 2, 1] > 0.5)


@all_elements
def test_cords_in_the_tread_lie_at_their_angle_from_theta_towards_y(element):
    mesh, X, _ = tyre_bricks(element)
    crown = abs(mesh.points[mesh.bricks[:, :8], 1].mean(axis=1)) < 0.03
    stuff = constitutive(CORD.model_copy(update={"angle": 25.0}))
    C = in_bricks(stuff, stuff.reference, element, X[crown]).mean(axis=(0, 1))
    t = np.deg2rad(53.0)
    e_theta, e_y = np.array([-np.sin(t), 0.0, np.cos(t)]), np.array([0.0, 1.0, 0.0])
    tried = np.deg2rad(np.arange(-89.0, 91.0))
    along = [stiffness_along(C, np.cos(a) * e_theta + np.sin(a) * e_y) for a in tried]
    assert np.rad2deg(tried[np.argmax(along)]) == pytest.approx(25.0)


def cell(element, stuff, theta: float = 0.0):
    mesh = revolve(crooked_section(element), np.deg2rad(8.0), 1)
    mesh = replace(mesh, points=mesh.points + np.array([0.0, 0.0, theta]))
    return assemble_cell(mesh, {"rubber": stuff}, element, Damping())


@all_elements
def test_isotropic_constants_give_the_isotropic_stiffness_at_any_angle(element):
    E, nu = 28e6, 0.45
    G = E / (2.0 * (1.0 + nu))
    same = {"E_1": E, "E_2": E, "E_3": E, "nu_12": nu, "nu_13": nu, "nu_23": nu}
    same |= {"G_12": G, "G_13": G, "G_23": G, "rho": 1100.0, "eta": 0.1, "angle": 33.0}
    found = cell(element, Orthotropic(kind="orthotropic", **same))
    plain = cell(element, Isotropic(E=E, nu=nu, rho=1100.0, eta=0.1))
    assert close(found.K["rubber"], plain.K["rubber"])
    assert close(found.dynamic_stiffness(900.0), plain.dynamic_stiffness(900.0))


@all_elements
def test_a_cell_is_the_same_wherever_it_stands_around_the_axle(element):
    here, there = (cell(element, wood(angle=30.0, eta=0.1), theta) for theta in (0.0, 2.1))
    assert close(there.dynamic_stiffness(900.0), here.dynamic_stiffness(900.0))


@all_elements
def test_the_angle_matters(element):
    straight, turned = (cell(element, wood(angle=a)).K["rubber"] for a in (0.0, 30.0))
    assert not close(turned, straight, 0.05)


@all_elements
@pytest.mark.parametrize("strain", STRAINS.values(), ids=STRAINS.keys())
def test_patch_of_any_elasticity_carries_constant_strain(element, strain):
    C, patch = general(7), PATCH.of(element)
    exact = patch.points @ tensor(strain)
    K = patch.assembled(element.stiffness(patch.X, C))
    known = np.repeat(on_surface(patch.points), 3)
    u = solve(K, np.zeros(len(known)), known, exact.ravel())
    assert close(u.reshape(-1, 3), exact)
    stress = np.einsum("v,vij->ij", C @ np.einsum("vij,ij->v", VOIGT, tensor(strain)), VOIGT)
    expected = pull_of_constant_stress(patch, stress, element.n_nodes == 20)
    assert close((K @ u).reshape(-1, 3), expected)


@all_elements
@pytest.mark.parametrize("strain", STRAINS.values(), ids=STRAINS.keys())
def test_patch_of_cords_in_straight_layers_carries_constant_strain(element, strain):
    """The layers' axes are found at every Gauss point of sheared bricks: one flat stack."""
    patch = box(2, 2, 2).mapped(lambda x: x + [[0.0, 0.0, 0.3]] * x[:, :1]).of(element)
    patch = patch.mapped(lambda x: x - [[0.0, 0.2, 0.0]] * x[:, 2:])  # eta, zeta stay in planes
    stuff = constitutive(CORD.model_copy(update={"angle": 20.0}))
    C = in_bricks(stuff, stuff.reference, element, patch.X)
    assert close(C, np.broadcast_to(C[0, 0], C.shape))
    exact = patch.points @ tensor(strain)
    K = patch.assembled(element.stiffness(patch.X, C))
    known = np.repeat(on_surface(box(2, 2, 2).of(element).points), 3)
    assert close(solve(K, np.zeros(len(known)), known, exact.ravel()).reshape(-1, 3), exact)


def test_two_turns_in_the_layer_add_up():
    C = constitutive(wood()).reference
    assert close(in_layer(in_layer(C, 0.3), 0.4), in_layer(C, 0.7))
