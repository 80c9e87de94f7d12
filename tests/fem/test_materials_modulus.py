"""Complex moduli that depend on frequency, against limits, time domain and causality.

Exact: E(omega) = i omega times the Fourier transform of the relaxation modulus, for a Prony series
E(t) = E_inf + E_0 sum of g exp(-t/tau); a Zener model with alpha = 1 is a series of one term; a
causal E obeys Kramers and Kronig's relation
    E'(omega) - E'(0) = (2 omega^2/pi) P int_0^inf E''(x) / (x (omega^2 - x^2)) dx
(Tschoegl, The Phenomenological Theory of Linear Viscoelastic Behavior (1989), chapter 8).
A slender bar that is pulled at omega answers with E(omega), whatever its bricks.
"""

from __future__ import annotations

import numpy as np
import pytest
from fem.blocks import box
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from tyrefrf.case import FractionalZener, Isotropic, PronySeries, Shift, TabledModulus
from tyrefrf.fem.constitutive import constitutive
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.fem.viscoelastic import Constant, Prony, Shifted, Tabled, Zener

PRONY = Prony(E_0=50e6, g=(0.3, 0.2, 0.1), tau=(1e-4, 1e-3, 3e-2))
ZENER = Zener(E_0=20e6, E_inf=2e9, tau=2e-6, alpha=0.45)
TABLE = Tabled(frequencies=(1.0, 10.0, 1000.0), E=(10e6, 12e6, 40e6), eta=(0.1, 0.15, 0.45))
LAWS = {"constant": Constant(28e6, 0.1), "table": TABLE, "prony": PRONY, "zener": ZENER}

all_laws = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())
omegas = st.floats(-3.0, 12.0).map(lambda x: 10.0**x)


def modulus(law, omega):
    return law.static * law.scale(omega)


def test_a_constant_loss_factor_is_one_plus_i_eta_to_the_last_bit():
    assert LAWS["constant"].scale(0.0) == LAWS["constant"].scale(1e5) == 1.0 + 1j * 0.1


@pytest.mark.parametrize(("law", "E_inf"), [(PRONY, 50e6), (ZENER, 2e9)], ids=["prony", "zener"])
def test_limits_of_low_and_high_frequency(law, E_inf):
    assert modulus(law, 0.0) == law.static
    assert modulus(law, 1e-12) == pytest.approx(law.static, rel=1e-5)
    assert modulus(law, 1e25) == pytest.approx(E_inf, rel=1e-5)
    assert PRONY.static == pytest.approx(20e6)


@pytest.mark.parametrize("omega", [5.0, 300.0, 2e4])
def test_prony_series_is_the_transform_of_the_relaxation_modulus(omega):
    def relaxing(t):
        return PRONY.E_0 * sum(
            g * np.exp(-t / tau) for g, tau in zip(PRONY.g, PRONY.tau, strict=True)
        )

    real = quad(relaxing, 0.0, np.inf, weight="cos", wvar=omega, limlst=500, epsabs=1e-6)[0]
    imag = quad(relaxing, 0.0, np.inf, weight="sin", wvar=omega, limlst=500, epsabs=1e-6)[0]
    expected = PRONY.static + 1j * omega * (real - 1j * imag)
    assert modulus(PRONY, omega) == pytest.approx(expected, rel=1e-6)


@given(omegas)
def test_zener_of_order_one_is_a_prony_series_of_one_term(omega):
    one_term = Prony(E_0=9e7, g=(0.7,), tau=(1e-4,))
    zener = Zener(E_0=2.7e7, E_inf=9e7, tau=1e-4, alpha=1.0)
    assert modulus(zener, omega) == pytest.approx(modulus(one_term, omega), rel=1e-12)


@pytest.mark.parametrize("alpha", [0.3, 0.7, 1.0])
def test_zener_loses_most_where_pritz_says(alpha):
    """The loss factor peaks at omega tau = (E_0/E_inf)^(1/(2 alpha)): Pritz."""
    law = Zener(E_0=1e6, E_inf=1e8, tau=1e-3, alpha=alpha)
    log_omega = np.linspace(-6.0, 12.0, 18001)
    E = np.array([modulus(law, 10.0**x) for x in log_omega])
    peak = 10.0 ** log_omega[np.argmax(E.imag / E.real)]
    assert peak * 1e-3 == pytest.approx(0.01 ** (0.5 / alpha), rel=0.01)


@pytest.mark.parametrize("omega", [10.0, 1e4, 1e6])
@pytest.mark.parametrize("law", [PRONY, ZENER], ids=["prony", "zener"])
def test_storage_follows_from_loss_by_kramers_and_kronig(law, omega):
    def both_sides(u):  # x = omega exp(+-u)
        high, low = modulus(law, omega * np.exp(u)).imag, modulus(law, omega * np.exp(-u)).imag
        return high / (1.0 - np.exp(2.0 * u)) + low / (1.0 - np.exp(-2.0 * u))

    parts = [quad(both_sides, a, b, limit=500)[0] for a, b in [(1e-6, 1), (1, 10), (10, 80)]]
    expected = modulus(law, omega).real - law.static
    assert 2.0 / np.pi * sum(parts) == pytest.approx(expected, rel=1e-4)


@all_laws
@given(omega=omegas)
def test_no_law_gives_energy(law, omega):
    assert modulus(law, omega).real > 0.0
    assert modulus(law, omega).imag >= 0.0


def test_a_table_goes_through_its_rows():
    for f, E, eta in zip(TABLE.frequencies, TABLE.E, TABLE.eta, strict=True):
        assert modulus(TABLE, 2.0 * np.pi * f) == pytest.approx(E * (1.0 + 1j * eta))


def test_between_rows_the_table_is_straight_in_log_log():
    E = modulus(TABLE, 2.0 * np.pi * 100.0)  # half-way from 10 to 1000 Hz
    assert E.real == pytest.approx(np.sqrt(12e6 * 40e6))
    assert E.imag / E.real == pytest.approx(0.3)


def test_beyond_its_ends_a_table_holds():
    assert modulus(TABLE, 0.0) == modulus(TABLE, 3.0) == pytest.approx(10e6 * (1.0 + 0.1j))
    assert modulus(TABLE, 1e9) == pytest.approx(40e6 * (1.0 + 0.45j))


@all_laws
@given(omega=omegas, decades=st.floats(-6.0, 6.0))
def test_a_shift_is_a_shift_of_the_frequency(law, omega, decades):
    a_T = 10.0**decades
    assert Shifted(law, a_T).scale(omega) == law.scale(a_T * omega)
    assert Shifted(law, a_T).static == law.static


def test_shift_of_williams_landel_and_ferry():
    universal = {"C1": 17.44, "C2": 51.6, "T_ref": -60.0}
    assert Shift(**universal, temperature=-60.0).factor == 1.0
    assert Shift(**universal, temperature=-50.0).factor == pytest.approx(10 ** (-174.4 / 61.6))
    warm, cold = (Shift(**universal, temperature=t).factor for t in (40.0, 0.0))
    assert warm < cold < 1.0  # warmth makes a rubber answer as to a lower frequency


def test_case_laws_become_these():
    shift = Shift(C1=8.86, C2=101.6, T_ref=20.0, temperature=40.0)
    cases = [
        (PronySeries(kind="prony", E_0=50e6, g=PRONY.g, tau=PRONY.tau), PRONY),
        (PronySeries(kind="prony", E_inf=20e6, g=PRONY.g, tau=PRONY.tau), PRONY),
        (FractionalZener(kind="zener", E_0=20e6, E_inf=2e9, tau=2e-6, alpha=0.45), ZENER),
        (TabledModulus(kind="table", frequencies=(1, 10, 1000), E=TABLE.E, eta=TABLE.eta), TABLE),
    ]
    for law, expected in cases:
        stuff = Isotropic(nu=0.48, rho=1100.0, modulus=law)
        shifted = Isotropic(nu=0.48, rho=1100.0, modulus=law.model_copy(update={"shift": shift}))
        C = constitutive(stuff).elasticity(500.0)
        shear = modulus(expected, 500.0) / 2.96
        assert C[3, 3] == pytest.approx(shear, rel=1e-12)
        there = constitutive(shifted).elasticity(500.0)[3, 3]
        assert there == pytest.approx(modulus(expected, shift.factor * 500.0) / 2.96, rel=1e-12)


def test_reference_is_at_0_hz_and_inflation_may_have_a_modulus_of_its_own():
    law = FractionalZener(kind="zener", E_0=20e6, E_inf=2e9, tau=2e-6, alpha=0.45)
    plain = constitutive(Isotropic(nu=0.3, rho=1.0, modulus=law))
    assert plain.reference[3, 3] == plain.static[3, 3] == pytest.approx(20e6 / 2.6)
    own = constitutive(Isotropic(nu=0.3, rho=1.0, E=20e6, E_static=5e6))
    assert own.reference[3, 3] == pytest.approx(20e6 / 2.6)
    assert own.static[3, 3] == pytest.approx(5e6 / 2.6)


@pytest.mark.parametrize("omega", [0.0, 30.0, 2e4])
@pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS.keys())
@pytest.mark.parametrize(
    "law",
    [
        FractionalZener(kind="zener", E_0=20e6, E_inf=2e9, tau=2e-6, alpha=0.45),
        PronySeries(kind="prony", E_0=50e6, g=PRONY.g, tau=PRONY.tau),
        TabledModulus(kind="table", frequencies=(1, 10, 1000), E=TABLE.E, eta=TABLE.eta),
    ],
    ids=["zener", "prony", "table"],
)
def test_a_pulled_bar_answers_with_the_modulus(law, element, omega):
    """Dynamic mechanical analysis without inertia: force over area over strain."""
    stuff = constitutive(Isotropic(nu=0.45, rho=1100.0, modulus=law))
    bar = box(3, 1, 1).mapped(lambda x: x * [6.0, 0.5, 0.5]).of(element)
    K = bar.assembled(element.stiffness(bar.X, stuff.elasticity(omega))).toarray()

    known = np.stack([bar.points[:, 0] % 6.0 == 0.0, *(bar.points[:, 1:] == 0.0).T], 1).ravel()
    u = np.zeros(len(K), complex)
    u[::3] = np.where(bar.points[:, 0] == 6.0, 0.06, 0.0)
    free = ~known
    u[free] = np.linalg.solve(K[np.ix_(free, free)], -K[free] @ u)
    force = (K @ u)[::3][bar.points[:, 0] == 6.0].sum()

    expected = modulus({"zener": ZENER, "prony": PRONY, "table": TABLE}[law.kind], omega)
    assert force / 0.25 / 0.01 == pytest.approx(expected, rel=1e-10)
