"""Plies of cords in rubber, and stacks of plies, against bounds and closed forms.

Halpin & Tsai: P_m as v_f -> 0, P_f as v_f -> 1, between Reuss's and Voigt's bounds. Stacks: the
energy of a stack at a given mean strain is the least that its plies' out-of-plane strains can
reach; isotropic layers give Backus's closed form (Long-wave elastic anisotropy produced by
horizontal layering, J. Geophys. Res. 67 (1962), 4427-4440); in plane stress a stack has classical
laminate theory's stiffness (Jones, Mechanics of Composite Materials, 2nd ed. (1999), chapters 2
and 4). Cylinders in cylinders: k, G_12 and the lower bound of G_23 in closed form (Hashin,
Analysis of composite materials, J. Appl. Mech. 50 (1983), 481-505, section 3).
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tyrefrf.case import Cord, FractionalZener, Ply, Viscoelastic
from tyrefrf.fem.constitutive import constitutive
from tyrefrf.fem.elasticity import isotropic
from tyrefrf.fem.plies import Solid, halpin_tsai, homogenised, in_layer, ply_elasticity

ROUND_OFF = 1e-12  # of the largest entry
NYLON, STEEL, RUBBER = Solid(2e9, 0.3), Solid(2e11, 0.3), Solid(6e6, 0.48)
COUPLING = [(0, 3), (1, 3), (2, 3), (4, 5)]
ZENER = FractionalZener(kind="zener", E_0=6e6, E_inf=1e9, tau=1e-6, alpha=0.6)

solids = st.builds(Solid, st.floats(6.0, 11.5).map(lambda x: 10.0**x), st.floats(-0.3, 0.495))
fractions = st.floats(0.01, 0.99)


def material(**changes: object) -> Ply:
    of = {
        "kind": "ply",
        "cord": Cord(E=2e9, nu=0.3, rho=1400.0),
        "rubber": Viscoelastic(nu=0.48, rho=1100.0, modulus=ZENER),
        "volume_fraction": 0.3,
        "angles": (20.0, -20.0),
    }
    return Ply(**{**of, **changes})


def close(A, B, tolerance=ROUND_OFF):
    return np.abs(A - B).max() <= tolerance * np.abs(B).max()


def hooke(solid: Solid) -> np.ndarray:
    return isotropic(solid.E.real, solid.nu)


def ply(cord: Solid, rubber: Solid, v_f: float) -> np.ndarray:
    return ply_elasticity(cord, rubber, v_f).real


@given(solids, solids, st.floats(0.0, 100.0))
def test_halpin_tsai_begins_at_the_rubber_and_ends_at_the_cord(cord, rubber, zeta):
    assert halpin_tsai(cord.G, rubber.G, 0.0, zeta) == rubber.G
    assert halpin_tsai(cord.G, rubber.G, 1.0, zeta) == pytest.approx(cord.G, rel=1e-9)


@given(solids, solids, fractions, st.floats(1e-6, 1e6))
def test_halpin_tsai_lies_between_reuss_and_voigt(cord, rubber, v_f, zeta):
    reuss = 1.0 / (v_f / cord.G + (1.0 - v_f) / rubber.G)
    voigt = v_f * cord.G + (1.0 - v_f) * rubber.G
    assert reuss * (1 - 1e-9) <= halpin_tsai(cord.G, rubber.G, v_f, zeta) <= voigt * (1 + 1e-9)
    assert halpin_tsai(cord.G, rubber.G, v_f, 0.0) == pytest.approx(reuss, rel=1e-9)
    assert halpin_tsai(cord.G, rubber.G, v_f, 1e12) == pytest.approx(voigt, rel=1e-5)


@given(solids, solids, fractions)
def test_bulk_and_shear_moduli_are_those_of_cylinders_in_cylinders(cord, rubber, v_f):
    (k_f, G_f), (k, G) = ((x.k.real, x.G.real) for x in (cord, rubber))
    C = ply(cord, rubber, v_f)
    bulk = (k * (k_f + G) * (1 - v_f) + k_f * (k + G) * v_f) / (
        (k_f + G) * (1 - v_f) + (k + G) * v_f
    )
    shear_12 = G * (G_f * (1 + v_f) + G * (1 - v_f)) / (G_f * (1 - v_f) + G * (1 + v_f))
    slack = (1 - v_f) * (k + 2 * G) / (2 * G * (k + G))
    shear_23 = G + v_f * (G_f - G) / (1.0 + (G_f - G) * slack)
    assert (C[1, 1] + C[1, 2]) / 2.0 == pytest.approx(bulk, rel=1e-9)
    assert C[3, 3] == pytest.approx(shear_12, rel=1e-9)
    assert C[4, 4] == pytest.approx(shear_23, rel=1e-9)


@given(solids, solids)
def test_a_ply_of_no_cords_is_rubber_and_one_of_nothing_else_is_cord(cord, rubber):
    assert close(ply(cord, rubber, 0.0), hooke(rubber))
    assert close(ply(cord, rubber, 1.0), hooke(cord), 1e-9)


@given(solids, fractions)
def test_cords_of_rubber_leave_rubber(rubber, v_f):
    assert close(ply(rubber, rubber, v_f), hooke(rubber))


@given(solids, solids, fractions)
def test_a_ply_stores_positive_energy(cord, rubber, v_f):
    C = ply(cord, rubber, v_f)
    scale = np.sqrt(np.diag(C))
    assert np.linalg.eigvalsh(C / np.outer(scale, scale)).min() > 0.0


@given(
    st.floats(6.0, 11.5).map(lambda x: 10.0**x),
    st.floats(6.0, 11.5).map(lambda x: 10.0**x),
    st.floats(0.0, 0.49),
    fractions,
)
def test_a_ply_lies_between_reuss_and_voigt_as_a_tensor(E_f, E_m, nu, v_f):
    """For constituents of one Poisson's ratio: the mixture rule for nu_12 is then their own."""
    cord, rubber = Solid(E_f, nu), Solid(E_m, nu)
    C = ply(cord, rubber, v_f)
    voigt = v_f * hooke(cord) + (1.0 - v_f) * hooke(rubber)
    reuss = np.linalg.inv(
        v_f * np.linalg.inv(hooke(cord)) + (1.0 - v_f) * np.linalg.inv(hooke(rubber))
    )
    assert np.linalg.eigvalsh(voigt - C).min() >= -1e-9 * voigt.max()
    assert np.linalg.eigvalsh(C - reuss).min() >= -1e-9 * voigt.max()


def test_constants_of_a_steel_belt_ply():
    """By hand: rigid cords in rubber of nu = 0.48: k/G = 25, zeta_k = 1/25, zeta_23 = 25/27."""
    v_f, G = 0.3, RUBBER.G.real
    C = ply(STEEL, RUBBER, v_f)
    assert C[0, 0] == pytest.approx(0.3 * 2e11 + 0.7 * 6e6, rel=0.01)
    assert C[3, 3] == C[5, 5] == pytest.approx(G * 1.3 / 0.7, rel=1e-3)
    assert (C[1, 1] + C[1, 2]) / 2.0 == pytest.approx(25 * G * (1 + 0.3 / 25) / 0.7, rel=1e-3)
    assert C[4, 4] == pytest.approx(G * (1 + 25 / 27 * 0.3) / 0.7, rel=1e-3)


@given(st.floats(0.0, 90.0), st.floats(-1.0, 6.0).map(lambda x: 10.0**x))
def test_a_balanced_laminate_is_orthotropic_at_every_frequency(angle, omega):
    C = constitutive(material(angles=(angle, -angle))).elasticity(omega)
    assert all(abs(C[i, j]) <= ROUND_OFF * abs(C).max() for i, j in COUPLING)


def test_a_single_ply_at_an_angle_is_not_orthotropic():
    C = constitutive(material(angles=(20.0,))).elasticity(100.0)
    assert all(abs(C[i, j]) > 1e-4 * abs(C).max() for i, j in COUPLING[:2])


@pytest.mark.parametrize("angle", [20.0, -35.0])
def test_a_ply_is_stiffest_along_its_cords(angle):
    C = constitutive(material(angles=(angle,))).reference
    a = np.deg2rad(np.arange(-89.0, 91.0))
    c, s, o = np.cos(a), np.sin(a), np.zeros_like(a)
    stretch = np.array([c**2, s**2, o, 2.0 * c * s, o, o])
    along = np.einsum("va,vw,wa->a", stretch, C, stretch)
    assert np.rad2deg(a[np.argmax(along)]) == pytest.approx(angle)


def random_plies(seed: int, n: int) -> tuple[list[np.ndarray], np.ndarray]:
    rng = np.random.default_rng(seed)
    plies = [
        in_layer(ply(Solid(10.0 ** rng.uniform(7, 11), 0.3), RUBBER, rng.uniform(0.1, 0.5)), a)
        for a in rng.uniform(-1.5, 1.5, n)
    ]
    shares = rng.uniform(0.1, 1.0, n)
    return plies, shares / shares.sum()


def test_a_stack_of_one_kind_of_ply_is_that_ply():
    (C,), _ = random_plies(1, 1)
    assert close(homogenised([C, C, C], [0.2, 0.5, 0.3]), C)


@pytest.mark.parametrize("seed", range(4))
def test_a_stack_has_the_least_energy_of_its_plies(seed):
    """Minimise sum of s_k e_k^T C_k e_k over the plies' e_33, g_23, g_31 with their mean given."""
    plies, shares = random_plies(seed, 3)
    a, b = [0, 1, 3], [2, 4, 5]
    strain = np.random.default_rng(seed).normal(size=6)
    n = len(plies)
    KKT, rhs = np.zeros((3 * n + 3, 3 * n + 3)), np.zeros(3 * n + 3)
    rhs[3 * n :] = strain[b]
    for k, (C, s) in enumerate(zip(plies, shares, strict=True)):
        here = slice(3 * k, 3 * k + 3)
        KKT[here, here] = s * C[np.ix_(b, b)]
        KKT[here, 3 * n :] = KKT[3 * n :, here] = s * np.eye(3)
        rhs[here] = -s * C[np.ix_(b, a)] @ strain[a]
    scale = np.concatenate([np.full(3 * n, 1e-3), np.full(3, 1e3)])  # Pa and 1 in one system
    x = scale * np.linalg.solve(scale[:, None] * KKT * scale, scale * rhs)
    energy = 0.0
    for k, (C, s) in enumerate(zip(plies, shares, strict=True)):
        e = strain.copy()
        e[b] = x[3 * k : 3 * k + 3]
        energy += s * e @ C @ e
    assert strain @ homogenised(plies, shares) @ strain == pytest.approx(energy, rel=1e-10)


def test_isotropic_layers_give_backus_closed_form():
    layers, s = [Solid(1e9, 0.3), Solid(2e7, 0.45)], np.array([0.3, 0.7])
    mu = np.array([x.G.real for x in layers])
    lam = np.array([x.k.real for x in layers]) - mu
    P = lam + 2.0 * mu
    C = 1.0 / (s @ (1.0 / P))
    A = s @ (4.0 * mu * (lam + mu) / P) + C * (s @ (lam / P)) ** 2
    B = s @ (2.0 * mu * lam / P) + C * (s @ (lam / P)) ** 2
    F, L, M = C * (s @ (lam / P)), 1.0 / (s @ (1.0 / mu)), s @ mu
    expected = np.diag([A, A, C, M, L, L])
    expected[0, 1] = expected[1, 0] = B
    expected[:2, 2] = expected[2, :2] = F
    assert close(homogenised([hooke(x) for x in layers], s), expected)


@given(st.floats(0.0, 90.0))
def test_in_plane_stress_is_classical_laminate_theorys(angle):
    C = ply(NYLON, RUBBER, 0.3)
    S = np.linalg.inv(C)
    E_1, E_2, nu_12, G_12 = 1 / S[0, 0], 1 / S[1, 1], -S[0, 1] / S[0, 0], 1 / S[3, 3]
    nu_21 = nu_12 * E_2 / E_1
    Q_11, Q_22 = E_1 / (1 - nu_12 * nu_21), E_2 / (1 - nu_12 * nu_21)
    Q_12, Q_66 = nu_12 * Q_22, G_12
    c, s = np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))
    mixed = Q_12 + 2.0 * Q_66
    A_11 = Q_11 * c**4 + 2.0 * mixed * s**2 * c**2 + Q_22 * s**4
    A_22 = Q_11 * s**4 + 2.0 * mixed * s**2 * c**2 + Q_22 * c**4
    A_12 = (Q_11 + Q_22 - 4.0 * Q_66) * s**2 * c**2 + Q_12 * (s**4 + c**4)
    A_66 = (Q_11 + Q_22 - 2.0 * Q_12 - 2.0 * Q_66) * s**2 * c**2 + Q_66 * (s**4 + c**4)

    a = np.deg2rad(angle)
    stack = homogenised([in_layer(C, a), in_layer(C, -a)], [0.5, 0.5])
    found = np.linalg.inv(np.linalg.inv(stack)[np.ix_([0, 1, 3], [0, 1, 3])])
    expected = np.array([[A_11, A_12, 0.0], [A_12, A_22, 0.0], [0.0, 0.0, A_66]])
    assert close(found, expected, 1e-10)


@given(
    st.floats(-1.0, 7.0).map(lambda x: 10.0**x),
    st.lists(st.floats(-90.0, 90.0), min_size=1, max_size=4),
    fractions,
)
def test_plies_are_passive(omega, angles, v_f):
    C = constitutive(material(angles=tuple(angles), volume_fraction=v_f)).elasticity(omega)
    loss = np.linalg.eigvalsh(C.imag)
    assert close(C, C.T)
    assert loss.min() >= -1e-13 * abs(C).max()
    assert loss.max() > 0.0


def test_loss_of_a_ply_is_the_rubbers_across_the_cords_and_nearly_none_along_them():
    C = constitutive(
        material(angles=(0.0,), rubber=Viscoelastic(E=6e6, nu=0.48, rho=1100.0, eta=0.2))
    ).elasticity(0.0)
    loss = C.imag.diagonal() / C.real.diagonal()
    assert loss[3] == pytest.approx(0.2, rel=0.01)  # 12: rigid cords
    assert loss[4] == pytest.approx(0.2, rel=0.01)
    compliance = np.linalg.inv(C)
    along = 1.0 / compliance[0, 0]
    assert along.imag / along.real == pytest.approx(0.2 * 0.7 * 6e6 / (0.3 * 2e9), rel=0.1)


def test_density_and_shares_of_plies():
    stuff = constitutive(material(angles=(0.0, 90.0), shares=(1.0, 3.0)))
    assert stuff.rho == pytest.approx(0.3 * 1400.0 + 0.7 * 1100.0)
    assert stuff.shares == (0.25, 0.75)
    thick, thin = constitutive(material(angles=(0.0, 90.0, 90.0, 90.0))), stuff
    assert close(thin.elasticity(50.0), thick.elasticity(50.0))


def test_reference_is_the_lossless_limit_and_static_may_have_a_modulus_of_its_own():
    stuff = constitutive(material())
    assert close(stuff.elasticity(0.0), stuff.reference)
    assert close(stuff.static, stuff.reference)
    rubber = Viscoelastic(nu=0.48, rho=1100.0, modulus=ZENER, E_static=4e6)
    softer = Viscoelastic(nu=0.48, rho=1100.0, E=4e6)
    own = constitutive(material(rubber=rubber))
    assert close(own.reference, stuff.reference)
    assert close(own.static, constitutive(material(rubber=softer)).reference)
