"""Free waves of small cells, against all eigenvalues by QZ and against the ring's natural modes.

The quadratic eigenproblem (lambda^2 A_on + lambda A_0 + A_back) q = 0 is put to LAPACK's QZ as a
companion pencil that shares nothing with the package but the cell's entries.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from rings import Ring, lopsided, lossless, tyre, with_steel_belt
from scipy.linalg import eig, eigh
from scipy.sparse.linalg import ArpackNoConvergence

from tyrefrf.errors import SolveError
from tyrefrf.solvers import palindrome
from tyrefrf.solvers import waves as free
from tyrefrf.solvers.palindrome import Pair
from tyrefrf.solvers.waves import FreeWaves, missed

N_CELLS = 24
DECAY = 2.5  # Np/rad
TYPICAL = 2.0 * np.pi * 900.0
LINES = [40.0, 400.0, 1500.0, 2900.0]  # Hz
QZ_DIGITS = 1e-7  # QZ's own error in phase or decay of these companions; measured 1e-10 to 1e-9
ROUNDING = 1e-10


@cache
def ring(kind: str) -> Ring:
    """Coarse tyres: mirrored cells or lopsided ones, with and without interior or loss."""
    plain = tyre(n_cells=N_CELLS, elements_along=6)
    return {
        "damped": plain,
        "undamped": lossless(plain),
        "steel belt": with_steel_belt(plain),
        "lopsided": lopsided(tyre(n_cells=N_CELLS, elements_along=6, elements_around=2)),
        "lopsided undamped": lossless(
            lopsided(tyre(n_cells=N_CELLS, elements_along=4, elements_around=3))
        ),
        "quadratic": tyre("hex20", n_cells=N_CELLS, elements_along=4),
    }[kind]


KINDS = ["damped", "undamped", "steel belt", "lopsided", "lopsided undamped", "quadratic"]


@cache
def free_waves(kind: str) -> FreeWaves:
    return FreeWaves(ring(kind).cell, N_CELLS, TYPICAL)


def blocks(kind: str, omega: float, entries=None):
    """A_0, A_on, A_back, dense, from the cell's own matrix: no folding by the package."""
    cell = ring(kind).cell
    D = cell.sparse(cell.dynamic_stiffness(omega) if entries is None else entries).toarray()
    own, right = np.arange(cell.n_own), np.arange(cell.n_own, cell.n_dofs)
    free, left = np.flatnonzero(~cell.fixed[: cell.n_own]), np.arange(cell.n_face)
    A_0, A_on = D[np.ix_(own, own)], np.zeros((cell.n_own,) * 2, D.dtype)
    A_0[np.ix_(left, left)] += D[np.ix_(right, right)]
    A_on[:, left] = D[np.ix_(own, right)]
    return tuple(A[np.ix_(free, free)] for A in (A_0, A_on, A_on.T))


def exponents_by_qz(kind: str, omega: float):
    """(decay + i order) of every wave of the companion pencil with |lambda| <= 1 (about)."""
    A_0, A_on, A_back = blocks(kind, omega)
    scale = 1.0 / np.sqrt(np.abs(blocks(kind, 0.0)[0].diagonal()))
    A_0, A_on, A_back = (scale[:, None] * A * scale for A in (A_0, A_on, A_back))
    n = len(A_0)
    eye, zero = np.eye(n), np.zeros((n, n))
    a, b = eig(
        np.block([[zero, eye], [-A_back, -A_0]]),
        np.block([[eye, zero], [zero, A_on]]),
        right=False,
        homogeneous_eigvals=True,
    )
    usable = (np.abs(a) > 1e-12) & (np.abs(b) > 1e-12)
    return -np.log(a[usable] / b[usable]) / (2.0 * np.pi / N_CELLS)


def distance(exponent, others):
    """To the nearest of others or of their partners, in order modulo N."""
    both = np.concatenate([others, -others])
    apart = exponent - both
    order = np.remainder(apart.imag + N_CELLS / 2, N_CELLS) - N_CELLS / 2
    return np.min(np.abs(apart.real + 1j * order))


@pytest.mark.parametrize("hertz", LINES)
@pytest.mark.parametrize("kind", KINDS)
def test_all_waves_within_the_bound_are_found_and_none_else(kind, hertz):
    omega = 2.0 * np.pi * hertz
    waves = free_waves(kind).at(omega, DECAY)
    exponent = waves.decay + 1j * waves.order
    expected = exponents_by_qz(kind, omega)
    within = expected[np.abs(expected.real) < DECAY]

    assert 2 * len(exponent) == len(within)
    assert max(distance(x, expected) for x in exponent) < QZ_DIGITS
    assert max(distance(x, exponent) for x in within) < QZ_DIGITS


@pytest.mark.parametrize("hertz", LINES)
@pytest.mark.parametrize("kind", ["damped", "undamped", "steel belt", "lopsided", "quadratic"])
def test_a_few_at_a_time_find_what_all_at_once_do(kind, hertz, monkeypatch):
    omega = 2.0 * np.pi * hertz
    at_once = free_waves(kind).at(omega, DECAY)
    monkeypatch.setattr(palindrome, "SMALL", 0)
    monkeypatch.setattr(palindrome, "NEAREST", 12)
    monkeypatch.setattr(free, "search_dense", lambda *_: np.empty(0))  # shifts alone

    few = free_waves(kind).at(omega, DECAY)

    assert few.counted == at_once.counted
    assert len(few.order) == len(at_once.order)
    exponents = at_once.decay + 1j * at_once.order
    assert max(distance(x, exponents) for x in few.decay + 1j * few.order) < ROUNDING


@pytest.mark.parametrize("kind", KINDS)
def test_a_wave_needs_no_load(kind):
    omega = 2.0 * np.pi * 1500.0
    waves = free_waves(kind).at(omega, DECAY)
    A_0, A_on, A_back = blocks(kind, omega)
    ratio = np.exp(-(waves.decay + 1j * waves.order) * 2.0 * np.pi / N_CELLS)
    q = waves.q[~ring(kind).cell.fixed[: len(waves.q)]]

    lack = A_0 @ q + ratio * (A_on @ q) + (A_back @ q) / ratio

    size = np.abs(A_0) @ np.abs(q)
    assert np.max(np.linalg.norm(lack, axis=0) / np.linalg.norm(size, axis=0)) < ROUNDING
    assert np.all(waves.residual < 1e-12)
    assert np.all(waves.q[ring(kind).cell.fixed[: len(waves.q)]] == 0.0)


@pytest.mark.parametrize("kind", ["damped", "steel belt"])
def test_in_a_mirrored_cell_the_mirror_image_runs_the_other_way(kind):
    omega = 2.0 * np.pi * 1500.0
    waves = free_waves(kind).at(omega, DECAY)
    A_0, A_on, A_back = blocks(kind, omega)
    back = np.exp((waves.decay + 1j * waves.order) * 2.0 * np.pi / N_CELLS)
    mirrored = waves.q * np.tile([1.0, 1.0, -1.0], len(waves.q) // 3)[:, None]
    q = mirrored[~ring(kind).cell.fixed[: len(waves.q)]]

    lack = A_0 @ q + back * (A_on @ q) + (A_back @ q) / back

    size = np.abs(A_0) @ np.abs(q)
    assert np.max(np.linalg.norm(lack, axis=0) / np.linalg.norm(size, axis=0)) < ROUNDING


def matrices_of_order(kind: str, order: float):
    """K and M of an undamped cell at a circumferential order, Hermitian."""
    cell = ring(kind).cell
    turn = np.exp(-2j * np.pi * order / N_CELLS)
    return tuple(
        A_0 + turn * A_on + A_back / turn
        for A_0, A_on, A_back in (
            blocks(kind, 0.0, entries) for entries in (sum(cell.K.values()), cell.M)
        )
    )


@pytest.mark.parametrize("mode", [0, 1, 5])
@pytest.mark.parametrize("order", [1, 4, 9])
@pytest.mark.parametrize("kind", ["undamped", "lopsided undamped"])
def test_at_a_natural_frequency_a_free_wave_closes_on_itself(kind, order, mode):
    omega = np.sqrt(eigh(*matrices_of_order(kind, order), eigvals_only=True)[mode])

    waves = free_waves(kind).at(omega, DECAY)

    assert distance(1j * order, waves.decay + 1j * waves.order) < 1e-8


@pytest.mark.parametrize("mode", [0, 1, 5])
@pytest.mark.parametrize("order", [0.7, 3.3, 8.6])
@pytest.mark.parametrize("kind", ["undamped", "lopsided undamped"])
def test_without_loss_energy_travels_at_the_group_velocity(kind, order, mode):
    step = 1e-4
    omega, *beside = (
        np.sqrt(eigh(*matrices_of_order(kind, n), eigvals_only=True)[mode])
        for n in (order, order - step, order + step)
    )
    slope = (beside[1] - beside[0]) / (2.0 * step)

    waves = free_waves(kind).at(omega, DECAY)

    here = np.argmin(np.abs(np.abs(waves.order) - order) + waves.decay)
    assert waves.velocity[here] == pytest.approx(
        abs(slope), rel=1e-5
    )  # near a crossing the slope bends
    assert waves.order[here] == pytest.approx(np.copysign(order, slope), abs=1e-8)


@pytest.mark.parametrize("hertz", LINES)
@pytest.mark.parametrize("kind", ["damped", "steel belt", "lopsided", "quadratic"])
def test_what_a_wave_loses_on_its_way_is_dissipated(kind, hertz):
    omega, cell = 2.0 * np.pi * hertz, ring(kind).cell
    waves = free_waves(kind).at(omega, DECAY)
    ratio = np.exp(-(waves.decay + 1j * waves.order) * 2.0 * np.pi / N_CELLS)
    Q = np.concatenate([waves.q, ratio * waves.q[: cell.n_face]])
    D = cell.dynamic_stiffness(omega)

    dissipated = omega / 2.0 * np.sum(Q.conj() * (cell.sparse(D.imag) @ Q), axis=0).real
    stored = np.sum(Q.conj() * (cell.sparse(D.real + 2 * omega**2 * cell.M) @ Q), axis=0).real / 4.0

    # d power / d theta = -dissipation per angle, and power = energy per angle times velocity
    np.testing.assert_allclose(2.0 * waves.decay * waves.velocity * stored, dissipated, rtol=1e-9)
    assert np.all(waves.decay > 0.0)
    assert np.all(waves.velocity > 0.0)


@pytest.mark.parametrize("without", [1, 2, 5])
@pytest.mark.parametrize("kind", KINDS)
def test_the_count_tells_how_many_waves_are_missing(kind, without):
    omega = 2.0 * np.pi * 2900.0
    problem, angle = free_waves(kind).problem(omega), 2.0 * np.pi / N_CELLS
    waves = free_waves(kind).at(omega, DECAY)
    nu = 2.0 * np.cosh((waves.decay + 1j * waves.order) * angle)
    near = (waves.decay[-1] + 1e-3) * angle

    assert missed(problem, nu, np.empty(0), near) == 0
    assert missed(problem, nu[without:], np.empty(0), near) == without


def less_one(search):
    """The same search, had it overlooked the least decaying wave."""

    def overlooks(problem, bound):
        nu = search(problem, bound)
        return np.delete(nu, np.argmin(free.decay_of_sum(nu)))

    return overlooks


def test_what_the_shifts_overlook_is_found_all_at_once(monkeypatch):
    omega = 2.0 * np.pi * 1500.0
    complete = free_waves("damped").at(omega, DECAY)
    monkeypatch.setattr(free, "search_by_shifts", less_one(free.search_by_shifts))
    waves = free_waves("damped").at(omega, DECAY)
    np.testing.assert_allclose(waves.order, complete.order, rtol=1e-9)


def test_waves_that_are_not_all_are_refused(monkeypatch):
    found = free_waves("damped").at(2.0 * np.pi * 1500.0, DECAY).counted
    overlooks = less_one(free.search_by_shifts)
    monkeypatch.setattr(free, "search_by_shifts", overlooks)
    monkeypatch.setattr(free, "search_dense", overlooks)
    with pytest.raises(SolveError, match=f"1500 Hz: {found - 1} free waves found of the {found}"):
        free_waves("damped").at(2.0 * np.pi * 1500.0, DECAY)


def gives_up(*_args: object, **_options: object) -> None:
    raise ArpackNoConvergence("no convergence", np.empty(0), np.empty(0))


def test_where_arpack_gives_up_the_waves_are_found_all_at_once(monkeypatch):
    omega = 2.0 * np.pi * 1500.0
    complete = free_waves("damped").at(omega, DECAY)
    monkeypatch.setattr(palindrome, "SMALL", 0)
    monkeypatch.setattr(palindrome, "eigs", gives_up)
    waves = free_waves("damped").at(omega, DECAY)
    np.testing.assert_allclose(waves.order, complete.order, rtol=1e-9)


def test_where_nothing_finds_the_waves_the_line_is_refused_with_its_reason(monkeypatch):
    monkeypatch.setattr(palindrome, "SMALL", 0)
    monkeypatch.setattr(palindrome, "eigs", gives_up)
    monkeypatch.setattr(free, "search_dense", free.search_by_shifts)
    with pytest.raises(SolveError, match=r"1500 Hz: free waves near lambda = .*no convergence"):
        free_waves("damped").at(2.0 * np.pi * 1500.0, DECAY)


def test_no_number_is_proved_by_a_circle_through_a_wave():
    problem = free_waves("undamped").problem(2.0 * np.pi * 1500.0)
    with pytest.raises(SolveError, match="lies on the circle"):
        missed(problem, np.empty(0), np.empty(0), 0.0)  # what propagates does not decay


@pytest.mark.parametrize("bound", [0.5, 2.0])
@pytest.mark.parametrize(
    ("waves", "circle"),  # shares of the way from the bound to its margin
    [
        ([], 0.5),
        ([-3.0, -0.1, 1.1, 9.0], 0.5),  # waves that do not lie between change nothing
        ([-0.7, 0.2, 9.0], 0.6),
        ([0.8, 0.7, -0.1], 0.35),
        ([0.1, 0.9, 0.3], 0.6),
    ],
)
def test_the_circle_that_counts_keeps_farthest_from_all_waves(waves, circle, bound):
    q, width = np.ones(1, complex), (free.MARGIN - 1.0) * bound
    pairs = [Pair(np.exp(-(bound + share * width) + 0.7j), q, q, 0.0) for share in waves]
    assert free.widest_gap(pairs, bound) == pytest.approx(bound + circle * width)
