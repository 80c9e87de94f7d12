"""Natural modes by circumferential order, against dense eigenvalues of the whole ring.

The referee assembles the whole ring in Cartesian coordinates (tests/rings.py) and takes all its
eigenvalues by LAPACK: it knows nothing of orders, pairs, ARPACK or inertia. Closed form: the thick
ring of Gazis and the loss factors of one lossy material.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from fem.blocks import cell_of, rectangle, revolve
from fem.test_analytical import INNER, NU, OUTER, RHO, E, exact_ring
from hypothesis import given, settings
from hypothesis import strategies as st
from rings import Ring, lopsided, lossless, ring_frequencies, tyre, with_steel_belt
from scipy.linalg import eigh, eigvals
from scipy.optimize import brentq
from scipy.sparse import csc_array
from scipy.sparse.linalg import ArpackNoConvergence

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.case import Cord, FractionalZener, Ply, Viscoelastic
from tyrefrf.errors import SolveError
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.fem.relaxation import Scaling
from tyrefrf.fem.viscoelastic import Modulus, Prony, Tabled, Zener
from tyrefrf.solvers import modes as modes_module
from tyrefrf.solvers import own_moduli
from tyrefrf.solvers.inertia import negative_eigenvalues, unstable_orders
from tyrefrf.solvers.modal_loss import modal_loss
from tyrefrf.solvers.modes import OrderModes, Pencil, Pencils, modes_below, ring_modes
from tyrefrf.solvers.orders import Orders
from tyrefrf.solvers.own_moduli import beside, crossing, orthonormal, own_ring_modes

ROUND_OFF = 1e-9  # relative: omega_max^2 / omega_1^2 is 1e6 here, x eps, with margin
RIGID = 1e-5  # rad/s over the highest omega: the square root of rounding, with margin
HZ = 2.0 * np.pi

RINGS = [(1, True), (2, True), (3, True), (7, True), (8, True), (2, False), (3, False), (7, False)]
rings = pytest.mark.parametrize(
    ("n_cells", "mirrored"), RINGS, ids=[f"{n}-{'mirrored' if m else 'lopsided'}" for n, m in RINGS]
)


@cache
def coarse(n_cells: int, mirrored: bool, held: bool = True, element: str = "hex8i") -> Ring:
    least = -(-3 // n_cells)  # elements around, for the ring to have a volume
    around = least if mirrored else max(2, 2 * least - 1)
    ring = tyre(element, n_cells, elements_along=4, elements_around=around)
    ring = ring if mirrored else lopsided(ring)
    return lossless(ring if held else ring.with_free_rim())


@cache
def truth(n_cells: int, mirrored: bool, held: bool = True) -> FloatArray:
    return ring_frequencies(coarse(n_cells, mirrored, held))


def all_omegas(modes: tuple[OrderModes, ...]) -> FloatArray:
    """Of the whole ring, both members of pairs, ascending."""
    return np.sort(np.concatenate([np.repeat(m.omega, m.n_members) for m in modes]))


@rings
def test_all_modes_are_those_of_the_whole_ring(n_cells, mirrored):
    modes = ring_modes(coarse(n_cells, mirrored).cell, n_cells, count=10**6)
    np.testing.assert_allclose(all_omegas(modes), truth(n_cells, mirrored), rtol=ROUND_OFF)


@rings
def test_the_lowest_modes_are_those_of_the_whole_ring(n_cells, mirrored):
    found = all_omegas(ring_modes(coarse(n_cells, mirrored).cell, n_cells, count=21))
    assert len(found) in (21, 22)  # a pair is not split
    np.testing.assert_allclose(found, truth(n_cells, mirrored)[: len(found)], rtol=ROUND_OFF)


@settings(max_examples=60, deadline=None)
@given(
    case=st.sampled_from([(3, True), (7, False), (8, True)]),
    hertz=st.floats(5.0, 20e3),
)
def test_no_mode_below_any_cutoff_is_missed(case, hertz):
    n_cells, mirrored = case
    found = all_omegas(ring_modes(coarse(n_cells, mirrored).cell, n_cells, below=HZ * hertz))
    expected = truth(n_cells, mirrored)
    assert len(found) == np.sum(expected < HZ * hertz)


@settings(max_examples=30, deadline=None)
@given(case=st.sampled_from([(3, True), (7, False), (8, True)]), count=st.integers(1, 120))
def test_any_number_of_modes_is_found_and_no_pair_split(case, count):
    n_cells, mirrored = case
    modes = ring_modes(coarse(n_cells, mirrored).cell, n_cells, count=count)
    found, expected = all_omegas(modes), truth(n_cells, mirrored)
    assert min(count, len(expected)) <= len(found) <= min(count + 1, len(expected))
    np.testing.assert_allclose(found, expected[: len(found)], rtol=ROUND_OFF)


@pytest.mark.parametrize("rank", [0, 1, 4])
def test_a_cutoff_on_a_mode_leaves_none_out(rank):
    pencil = Pencils(coarse(7, True).cell, 7).of(1)
    omega = modes_below(pencil, np.inf).omega
    found = modes_below(pencil, omega[rank] * (1.0 + 1e-13)).omega
    assert len(found) in (rank, rank + 1)  # which one is rounding's
    np.testing.assert_allclose(found, omega[: len(found)], rtol=ROUND_OFF)


@rings
def test_free_tyre_has_six_rigid_motions(n_cells, mirrored):
    modes = ring_modes(coarse(n_cells, mirrored, False).cell, n_cells, count=30)
    zeros = {m.order: m.n_members * int(np.sum(m.omega == 0.0)) for m in modes}
    expected = {1: {0: 6}, 2: {0: 2, 1: 4}}.get(n_cells, {0: 2, 1: 4})
    assert {h: n for h, n in zeros.items() if n} == expected
    found, whole = all_omegas(modes), truth(n_cells, mirrored, False)[:30]
    np.testing.assert_allclose(found[6:30], whole[6:], rtol=10 * ROUND_OFF)
    assert max(whole[:6]) < RIGID * truth(n_cells, mirrored, False)[-1]


def layered(n_cells: int = 30) -> Ring:
    """Soft rubber under a belt of steel, large enough for ARPACK: 162 dofs."""
    return lossless(with_steel_belt(tyre("hex8i", n_cells)))


def test_many_modes_of_a_stiff_belt_are_as_many_as_lapack_finds():
    modes = ring_modes(layered().cell, 30, below=HZ * 2500.0)
    expected = [lapack(pencil) for pencil in Pencils(layered().cell, 30)]
    for found, omega in zip(modes, expected, strict=True):
        assert len(found.omega) == np.sum(omega < HZ * 2500.0)
        np.testing.assert_allclose(found.omega, omega[: len(found.omega)], rtol=1e-7)  # of LAPACK's


@pytest.mark.parametrize("lost", [0, 2])
def test_modes_that_arpack_misses_are_found_all_the_same(lost, monkeypatch):
    honest = modes_module._by_lanczos

    def forgetful(pencil: Pencil, cutoff: float, counted: int) -> ComplexArray:
        return np.delete(honest(pencil, cutoff, counted), lost, axis=1)

    expected = ring_modes(layered().cell, 30, count=100)
    monkeypatch.setattr(modes_module, "_by_lanczos", forgetful)
    found = ring_modes(layered().cell, 30, count=100)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one.omega, other.omega, rtol=1e-7)  # steel's rounding


def doubled(shapes: ComplexArray) -> ComplexArray:
    return shapes[:, np.zeros(shapes.shape[1], int)]


def blurred(shapes: ComplexArray) -> ComplexArray:
    return shapes + 1e-3 * np.random.default_rng(0).standard_normal(shapes.shape)


@pytest.mark.parametrize("spoil", [doubled, blurred, lambda _: None])
def test_what_arpack_finds_is_believed_only_where_it_solves_the_equations(spoil, monkeypatch):
    honest = modes_module._by_lanczos
    expected = ring_modes(layered().cell, 30, count=100)
    monkeypatch.setattr(modes_module, "_by_lanczos", lambda *a: spoil(honest(*a)))
    found = ring_modes(layered().cell, 30, count=100)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one.omega, other.omega, rtol=1e-7)  # steel's rounding
        assert np.all(one.residual < 1e-6)


def gives_up(*_args: object, **_options: object) -> None:
    raise ArpackNoConvergence("no convergence", np.empty(0), np.empty(0))


@pytest.mark.parametrize(
    ("name", "answer"), [("eigsh", gives_up), ("symmetric_factor", lambda _: None)]
)
def test_where_arpack_gives_up_lapack_finds_the_modes(name, answer, monkeypatch):
    expected = ring_modes(layered().cell, 30, count=100)
    monkeypatch.setattr(modes_module, name, answer)
    found = ring_modes(layered().cell, 30, count=100)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one.omega, other.omega, rtol=1e-7)  # steel's rounding


def test_modes_that_no_method_finds_are_an_error(monkeypatch):
    for name in ("_by_lanczos", "_by_dense"):
        honest = getattr(modes_module, name)
        monkeypatch.setattr(modes_module, name, lambda *a, f=honest: f(*a)[:, 1:-1])
    with pytest.raises(SolveError, match="not come to as many as the inertia"):
        ring_modes(layered().cell, 30, count=100)


def lapack(pencil: Pencil) -> FloatArray:
    """All omegas [rad/s] of one order."""
    return np.sqrt(eigh(pencil.K.toarray(), pencil.M.toarray(), eigvals_only=True))


def test_shapes_are_mass_normal_and_satisfy_their_equations():
    for m, pencil in zip(ring_modes(layered().cell, 30, count=150), Pencils(layered().cell, 30)):  # noqa: B905  as many as there are orders
        gram = m.shapes.conj().T @ (pencil.M @ m.shapes)
        np.testing.assert_allclose(gram, np.eye(len(m.omega)), atol=1e-11)
        forces = m.shapes.conj().T @ (pencil.K @ m.shapes)
        scale = np.outer(m.omega, m.omega)
        np.testing.assert_allclose(forces / scale, np.eye(len(m.omega)), atol=1e-8)
        assert np.all(m.residual < 1e-8)


def test_the_answer_is_the_same_every_time():
    first, second = (ring_modes(layered().cell, 30, count=100) for _ in range(2))
    for one, other in zip(first, second, strict=True):
        np.testing.assert_array_equal(one.omega, other.omega)
        np.testing.assert_array_equal(one.shapes, other.shapes)


def test_a_shape_turned_around_the_ring_is_a_mode_of_the_whole_ring():
    ring = coarse(7, False)
    referee, N = ring.cartesian, 7
    m = ring_modes(ring.cell, N, count=20)[2]
    free = ~ring.cell.fixed[: ring.cell.n_own]
    q = np.zeros((N, ring.cell.n_own), complex)
    q[:, free] = np.exp(2j * np.pi * 2 * np.arange(N) / N)[:, None] * m.shapes[:, 0]
    x = ring.to_cartesian @ q.ravel()
    lack = (referee.K @ x - m.omega[0] ** 2 * (referee.M @ x))[referee.free]
    assert np.linalg.norm(lack) < 1e-9 * np.linalg.norm(referee.K @ x)
    assert (x.conj() @ (referee.M @ x)).real == pytest.approx(N)  # unit mass of every cell


@pytest.mark.parametrize("n", [2, 3, 6])
def test_frequency_of_the_thick_ring_is_that_of_gazis(n):
    element, n_cells = ELEMENTS["hex20"], 60
    r = np.linspace(INNER, OUTER, 5)
    mesh = revolve(rectangle(r, np.array([0.0, 0.02]), element), 2.0 * np.pi / n_cells, 1)
    cell = cell_of(mesh, element, E, NU, RHO)
    plane_strain = np.tile([False, True, False], mesh.n_nodes)
    modes = ring_modes(replace(cell, fixed=plane_strain), n_cells, count=40)
    flexible = modes[n].omega[modes[n].omega > 0.0]
    assert flexible[0] == pytest.approx(exact_ring(n), rel=1e-3)  # tests/fem/test_analytical.py


@pytest.mark.parametrize("excess", [1e-4, 0.1, 10.0])
def test_a_buckled_tyre_is_refused(excess):
    cell = coarse(7, True).cell
    lowest = truth(7, True)[0]
    squeezed = replace(cell, K_G=-(lowest**2) * (1.0 + excess) * cell.M)
    assert sum(unstable_orders(squeezed, 7).values()) > 0
    with pytest.raises(SolveError, match="has buckled"):
        ring_modes(squeezed, 7, count=10)
    with pytest.raises(SolveError, match="has buckled"):
        ring_modes(squeezed, 7, below=HZ * 1e4)


@pytest.mark.parametrize(("n_cells", "mirrored"), [(7, True), (8, True), (7, False)])
def test_a_buckled_tyre_is_unstable_at_the_orders_of_the_modes_that_lose_their_stiffness(
    n_cells, mirrored
):
    """K - omega^2 M loses as many eigenvalues as there are modes below omega, order by order."""
    cell, squeeze = coarse(n_cells, mirrored).cell, truth(n_cells, mirrored)[14] * (1.0 + 1e-6)
    modes = ring_modes(cell, n_cells, below=squeeze)
    lost = squeeze**2 * cell.M
    assert unstable_orders(replace(cell, K_G=-0.25 * lost, K_P=-0.75 * lost), n_cells) == {
        m.order: len(m.omega) for m in modes if len(m.omega)
    }
    assert len({len(m.omega) for m in modes}) > 1  # not the same at every order
    assert unstable_orders(cell, n_cells) == {}


def test_moduli_are_those_of_the_frequency_asked_for():
    """Of one material: all modes stiffen as it does."""
    law, ring = LAWS["zener"], lossless(tyre("hex8i", 7, elements_along=4))
    cell, omega = relaxing(ring, law), HZ * 3000.0
    stiffer = np.sqrt(law.scale(omega).real)
    assert stiffer > 1.1
    both = (ring_modes(cell, 7, count=20, at=w) for w in (0.0, omega))
    for at_rest, there in zip(*both, strict=True):
        np.testing.assert_allclose(there.omega, stiffer * at_rest.omega, rtol=ROUND_OFF)


def test_a_residual_is_what_its_own_mode_lacks():
    pencil, cutoff = Pencils(layered().cell, 30).of(4), HZ * 2500.0
    shapes = modes_below(pencil, cutoff).shapes
    near = shapes * (1.0 + 1e-11 * np.random.default_rng(0).standard_normal(shapes.shape))
    m = modes_module._ordered(pencil, near, cutoff)
    inertia = pencil.M @ m.shapes
    lack = np.linalg.norm(pencil.K @ m.shapes - inertia * m.omega**2, axis=0)
    size = (m.omega**2 + pencil.shift(cutoff)) * np.linalg.norm(inertia, axis=0)
    assert len(m.omega) > 5
    np.testing.assert_allclose(m.residual, lack / size, rtol=1e-2)


def test_stress_and_pressure_stiffen_the_modes_alike():
    """Where both are in proportion to the mass, omega^2 grows by what they add up to."""
    cell, squared = coarse(7, False).cell, truth(7, False)[0] ** 2
    taut = replace(cell, K_G=2.0 * squared * cell.M, K_P=-0.5 * squared * cell.M)
    for at_rest, stressed in zip(*(ring_modes(c, 7, count=20) for c in (cell, taut)), strict=True):
        expected = np.sqrt(at_rest.omega**2 + 1.5 * squared)
        np.testing.assert_allclose(stressed.omega, expected, rtol=ROUND_OFF)


@pytest.mark.parametrize("share", [0.1, 1.0, 10.0])
def test_inertia_counts_negative_eigenvalues(share):
    pencil = Pencils(layered().cell, 30).of(4)
    omega = lapack(pencil)
    shift = share * omega[60]
    assert negative_eigenvalues(pencil.minus(shift**2)) == np.sum(omega < shift)


def test_inertia_survives_a_pivot_of_zero():
    A = Pencils(coarse(3, True).cell, 3).of(0).K
    hollow = A - np.diag(A.diagonal())  # the first pivot is zero, and others
    expected = int(np.sum(np.linalg.eigvalsh(hollow) < 0.0))
    assert negative_eigenvalues(csc_array(hollow)) == expected


def test_inertia_survives_a_matrix_without_an_inverse():
    assert negative_eigenvalues(csc_array(np.diag([-1.0, 0.0, 2.0, -3.0]))) == 2


@pytest.mark.parametrize("size", [1e-12, 1.0, 1e12])
def test_inertia_does_not_depend_on_the_units(size):
    assert negative_eigenvalues(csc_array(size * np.diag([-0.5, 0.5, 2.0]))) == 1


@pytest.mark.parametrize("phase", [1.0, -1.0, 1j])
def test_pivots_off_the_diagonal_tell_nothing_of_the_inertia(phase):
    """Eigenvalues 1 and -1, but pivots of one sign, or of none."""
    assert negative_eigenvalues(csc_array([[0.0, phase], [np.conj(phase), 0.0]])) == 1


@pytest.mark.parametrize("modes_of", [ring_modes, own_ring_modes])
@pytest.mark.parametrize("wanted", [{}, {"below": 1.0, "count": 1}])
def test_cutoff_or_number_must_be_given(wanted, modes_of):
    with pytest.raises(ValueError, match="either"):
        modes_of(coarse(3, True).cell, 3, **wanted)


def test_loss_of_one_material_is_its_loss_factor():
    ring = tyre("hex8i", 9, elements_along=6)
    modes = ring_modes(ring.cell, 9, count=30)
    for loss in modal_loss(ring.cell, 9, modes, 0.0):
        np.testing.assert_allclose(loss.loss_factor, 0.1, rtol=1e-9)
        np.testing.assert_allclose(loss.loss_share, 1.0, rtol=1e-9)


@pytest.mark.parametrize("eta", [0.04, 0.01])
def test_loss_is_that_of_the_complex_eigenvalues_to_second_order(eta):
    """(K' + i K'') phi = omega^2 (1 + i eta) M phi; measured: off by 4.7 eta^2 at most."""
    ring = with_steel_belt(tyre("hex8i", 9, elements_along=8), eta=eta)
    modes = ring_modes(ring.cell, 9, count=12)
    orders = Orders(ring.cell)
    D = orders.folded(ring.cell.dynamic_stiffness(0.0))
    for m, loss in zip(modes, modal_loss(ring.cell, 9, modes, 0.0), strict=True):
        pencil = Pencils(ring.cell, 9).of(m.order)
        A = orders.matrix(D.at(2.0 * np.pi * m.order / 9)).toarray()
        squared = np.sort_complex(eigvals(A, pencil.M.toarray()))[: len(m.omega)]
        np.testing.assert_allclose(loss.loss_factor, squared.imag / squared.real, rtol=6.0 * eta**2)
        shares = loss.loss_share.sum(axis=1)
        np.testing.assert_allclose(shares, 1.0, rtol=1e-9)
        assert np.all(loss.loss_share[:, 1] == 0.0)  # steel without loss stores, and loses nothing
        assert np.all(loss.energy_share[:, 1] > 0.0)


def test_a_rigid_motion_has_no_loss_factor_and_all_others_have():
    cell = tyre("hex8i", 7, elements_along=4).with_free_rim().cell
    modes = ring_modes(cell, 7, count=20)
    for m, loss in zip(modes, modal_loss(cell, 7, modes, 0.0), strict=True):
        rigid = m.omega == 0.0
        for of_mode in (loss.loss_factor, loss.energy_share[:, 0], loss.loss_share[:, 0]):
            np.testing.assert_array_equal(np.isnan(of_mode), rigid)
    assert sum(m.n_members * np.sum(m.omega == 0.0) for m in modes) == 6


def test_without_loss_there_is_none_to_share():
    modes = ring_modes(coarse(7, True).cell, 7, count=20)
    for loss in modal_loss(coarse(7, True).cell, 7, modes, 0.0):
        np.testing.assert_array_equal(loss.loss_factor, 0.0)
        assert np.all(np.isnan(loss.loss_share))
        np.testing.assert_allclose(loss.energy_share, 1.0, rtol=1e-9)


def test_viscous_loss_is_that_of_the_damping_ratio():
    ring = lopsided(tyre("hex8i", 5, elements_along=4, elements_around=2))
    alpha = 3.0  # of the mass: 2 zeta = alpha / omega
    stuff = {k: m.model_copy(update={"eta": 0.0}) for k, m in ring.materials.items()}
    damping = ring.damping.model_copy(update={"alpha": alpha, "beta": 0.0})
    cell = replace(ring, materials=stuff, damping=damping).cell
    modes = ring_modes(cell, 5, count=20)
    for m, loss in zip(modes, modal_loss(cell, 5, modes, 0.0), strict=True):
        np.testing.assert_allclose(loss.loss_factor, alpha / m.omega, rtol=1e-9)
        np.testing.assert_array_equal(loss.loss_share, 0.0 * loss.loss_share)


def relaxing(ring: Ring, law: Modulus) -> CellMatrices:
    """The ring's cell with another law for its rubber."""
    cell = ring.cell
    return replace(cell, relaxation={**cell.relaxation, "rubber": Scaling(law)})


LAWS = {
    "prony": Prony(400e6, (0.5, 0.3), (1e-3, 1e-4)),
    "zener": Zener(80e6, 2e9, 1e-5, 0.5),
    "table": Tabled((20.0, 200.0, 800.0), (50e6, 80e6, 300e6), (0.1, 0.2, 0.3)),
    "softening": Tabled((20.0, 800.0), (300e6, 100e6), (0.1, 0.1)),
}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("n_cells", [1, 4, 7])
def test_modes_at_their_own_moduli_are_those_of_a_scan(law, n_cells):
    """Every rank's eigenvalue of K'(omega), dense, followed until it crosses omega^2."""
    around = -(-3 // n_cells)
    ring = with_steel_belt(tyre("hex8i", n_cells, elements_along=6, elements_around=around), 0.0)
    cell = relaxing(ring, LAWS[law])
    cutoff = HZ * {1: 800.0, 4: 1500.0, 7: 2500.0}[n_cells]
    pencils = Pencils(cell, n_cells)

    def rank_of(h: int, j: int, omega: float) -> float:
        pencil = pencils.at(omega).of(h)
        return float(
            eigh(
                pencil.K.toarray(),
                pencil.M.toarray(),
                eigvals_only=True,
                subset_by_index=(j, j),
            )[0]
            - omega**2
        )

    modes = own_ring_modes(cell, n_cells, below=cutoff)

    assert len(all_omegas(modes)) > 5
    for h, m in enumerate(modes):
        counted = pencils.at(cutoff).of(h).count_below(cutoff)
        assert len(m.omega) == counted
        expected = [brentq(lambda w, j=j: rank_of(h, j, w), 1.0, cutoff) for j in range(counted)]  # noqa: B023
        np.testing.assert_allclose(m.omega, expected, rtol=1e-8)
        mass = pencils.of(h).M
        np.testing.assert_allclose(
            np.einsum("nm,nm->m", m.shapes.conj(), mass @ m.shapes), 1.0, rtol=1e-10
        )


def test_the_subspace_takes_in_what_is_small_beside_it():
    V, near = np.eye(5, 3, dtype=complex), np.eye(5, 1) + 1e-12 * np.eye(5)[:, [3]]
    grown = orthonormal(np.hstack([V, beside(V, near)]))
    np.testing.assert_allclose(np.abs(grown.conj().T @ np.eye(5)[:, 3]).max(), 1.0)


def test_own_moduli_that_do_not_depend_on_frequency_change_nothing():
    fixed = ring_modes(layered().cell, 30, count=80)
    own = own_ring_modes(layered().cell, 30, count=80)
    for one, other in zip(fixed, own, strict=True):
        np.testing.assert_allclose(one.omega, other.omega, rtol=1e-9)


def test_free_relaxing_tyre_has_six_rigid_motions():
    ring = lossless(with_steel_belt(tyre("hex8i", 7, elements_along=6).with_free_rim()))
    modes = own_ring_modes(relaxing(ring, LAWS["zener"]), 7, count=20)
    assert [int(np.sum(m.omega == 0.0)) for m in modes] == [2, 2, 0, 0]


def test_loss_at_own_moduli_is_the_material_s_own():
    ring = lossless(tyre("hex8i", 9, elements_along=6))
    law = LAWS["prony"]
    cell = relaxing(ring, law)
    modes = own_ring_modes(cell, 9, count=20)
    for m, loss in zip(modes, modal_loss(cell, 9, modes, None), strict=True):
        scale = np.array([law.scale(w) for w in m.omega])
        np.testing.assert_allclose(loss.loss_factor, scale.imag / scale.real, rtol=1e-8)


CORDS = Ply(
    kind="ply",
    cord=Cord(E=2e9, nu=0.3, rho=1400.0),
    rubber=Viscoelastic(
        nu=0.48,
        rho=1100.0,
        modulus=FractionalZener(kind="zener", E_0=6e6, E_inf=1e9, tau=1e-6, alpha=0.5),
    ),
    volume_fraction=0.3,
    angles=(20.0, -15.0),
)
"""Rubber alone relaxes, so frequency changes the form of the elasticity, not only its size."""


@pytest.mark.parametrize("at", [None, HZ * 100.0])
def test_loss_of_plies_is_that_of_the_stiffness_of_the_line(at):
    cell = tyre("hex8i", 9, elements_along=6, stuff=CORDS).cell
    modes, orders = ring_modes(cell, 9, count=12), Orders(cell)
    for m, loss in zip(modes, modal_loss(cell, 9, modes, at), strict=True):
        for k, omega in enumerate(m.omega):
            D = cell.dynamic_stiffness(omega if at is None else at)  # Im D is K'' alone
            lossy = orders.matrix(orders.folded(D.imag).at(2.0 * np.pi * m.order / 9))
            lost = (m.shapes[:, k].conj() @ (lossy @ m.shapes[:, k])).real
            assert loss.loss_factor[k] == pytest.approx(lost / omega**2, rel=1e-9)
        np.testing.assert_allclose(loss.loss_share, 1.0, rtol=1e-12)


def test_modes_of_plies_satisfy_the_equations_at_their_own_frequencies():
    cell = tyre("hex8i", 9, elements_along=6, stuff=CORDS).cell
    orders = Orders(cell)
    modes = own_ring_modes(cell, 9, count=20)
    assert len(all_omegas(modes)) in (20, 21)
    for m in modes:
        for k, omega in enumerate(m.omega):
            D = orders.folded(cell.dynamic_stiffness(omega).real).at(2.0 * np.pi * m.order / 9)
            mass = orders.folded(cell.M).at(2.0 * np.pi * m.order / 9)
            lack, inertia = (orders.matrix(A) @ m.shapes[:, k] for A in (D, omega**2 * mass))
            assert np.linalg.norm(lack) < 1e-7 * np.linalg.norm(inertia)


def test_a_residual_does_not_depend_on_how_large_a_shape_is_drawn():
    pencil = Pencils(coarse(7, True).cell, 7).of(1)
    m = modes_below(pencil, HZ * 1e4)
    wrong = m.omega[:2] * 1.01
    once, tenfold = (
        own_moduli._residuals([pencil] * 2, wrong, size * m.shapes[:, :2], HZ * 1e4)
        for size in (1.0, 10.0)
    )
    np.testing.assert_allclose(tenfold, once, rtol=1e-12)
    lift = wrong**2 + pencil.shift(HZ * 1e4)
    np.testing.assert_allclose(once, (wrong**2 - m.omega[:2] ** 2) / lift, rtol=1e-6)


def test_modes_that_do_not_settle_on_their_own_moduli_are_refused(monkeypatch):
    monkeypatch.setattr(own_moduli, "ROUNDS", 1)
    cell = relaxing(with_steel_belt(tyre("hex8i", 7, elements_along=6), 0.0), LAWS["prony"])
    with pytest.raises(SolveError, match=r"order 0: .*do not settle"):
        own_ring_modes(cell, 7, below=HZ * 2500.0)


@pytest.mark.parametrize(
    ("root", "crosses"),
    [
        (lambda omega: 600.0 - 500.0 * np.tanh((omega - 600.0) / 1e-3), 600.0),  # nearly jumps
        (lambda omega: min(omega + 100.0, 600.0), 600.0),  # secants see no slope
        (lambda omega: 1400.0 - 1e-3 * omega, 1400.0 / 1.001),
        (lambda _: 0.0, 0.0),
    ],
)
def test_a_crossing_is_found_where_the_modulus_throws_out_the_secants(root, crosses):
    assert crossing(root, 100.0, 1500.0) == pytest.approx(crosses, abs=1e-7)
