"""Free waves over frequency: the branches they form, and the case's lines."""

from __future__ import annotations

import numpy as np
import pytest
import small

from tyrefrf.errors import CaseError, SolveError
from tyrefrf.results.dispersion import NEPER
from tyrefrf.solvers.waves import FreeWaves
from tyrefrf.study.branches import Frame, branches
from tyrefrf.study.dispersion import dispersion, dispersion_of, spread

N_CELLS = 24
SHAPES = np.linalg.qr(np.random.default_rng(3).standard_normal((9, 3)))[0] + 0j


def frames(*waves, shapes=SHAPES, velocity=100.0):
    """Lines 1 rad/s apart; waves: for each the exponents on all lines, NaN where it is not."""
    made = []
    for line, exponents in enumerate(zip(*waves, strict=True)):
        here = [k for k, x in enumerate(exponents) if not np.isnan(x)]
        made.append(
            Frame(
                omega=1.0 + line,
                exponent=np.array([exponents[k] for k in here], complex),
                velocity=np.full(len(here), velocity),
                shape=shapes[:, here],
            )
        )
    return made


def turned(lines, seed=5):
    """The same lines, the waves of each in an order drawn by lot, and these orders."""
    rng = np.random.default_rng(seed)
    lots = [rng.permutation(len(line.exponent)) for line in lines]
    return [
        Frame(line.omega, line.exponent[lot], line.velocity[lot], line.shape[:, lot])
        for line, lot in zip(lines, lots, strict=True)
    ], lots


LINES = np.arange(9.0)
RISING, FALLING = 0.1 + 1j * (2.0 + 0.25 * LINES), 0.1 + 1j * (4.0 - 0.25 * LINES)


def test_waves_that_cross_keep_their_branches():
    numbers = branches(frames(RISING, FALLING), N_CELLS)
    np.testing.assert_array_equal(numbers, [[0, 1]] * len(LINES))


def test_the_order_of_waves_in_a_line_makes_no_branch():
    lines, lots = turned(frames(RISING, FALLING, 0.4 + 1j * LINES / 3.0))
    numbers = branches(lines, N_CELLS)
    first = lots[0]
    sorted_ = [number[np.argsort(lot)] for number, lot in zip(numbers, lots, strict=True)]
    np.testing.assert_array_equal(sorted_, [np.argsort(first)] * len(LINES))


def test_waves_of_one_shape_keep_their_branches_while_apart():
    alike = np.repeat(SHAPES[:, :1], 2, axis=1)
    numbers = branches(frames(RISING, RISING + 1.5j, shapes=alike), N_CELLS)
    np.testing.assert_array_equal(numbers, [[0, 1]] * len(LINES))


def test_a_fast_step_in_order_is_expected_from_the_velocity():
    """Three alike, an order apart: each comes to where its neighbour was before."""
    steep = 0.1 + 1j * (2.0 + 0.9 * LINES)
    alike = np.repeat(SHAPES[:, :1], 3, axis=1)
    waves = steep, steep + 1.0j, steep + 2.0j
    numbers = branches(frames(*waves, shapes=alike, velocity=1.0 / 0.9), N_CELLS)
    np.testing.assert_array_equal(numbers, [[0, 1, 2]] * len(LINES))


def test_a_branch_ends_and_another_begins():
    gone = np.where(LINES < 4, RISING, np.nan)
    new = np.where(LINES > 5, 0.3 + 9.0j, np.nan)
    numbers = branches(frames(FALLING, gone, new), N_CELLS)
    assert [list(number) for number in numbers] == [[0, 1]] * 4 + [[0]] * 2 + [[0, 2]] * 3


def test_a_wave_of_another_shape_is_no_continuation():
    before = np.where(LINES < 4, RISING, np.nan)
    after = np.where(LINES < 4, np.nan, RISING)
    numbers = branches(frames(before, after), N_CELLS)
    assert [list(number) for number in numbers] == [[0]] * 4 + [[1]] * 5


def test_an_order_beyond_half_the_cells_goes_on_folded():
    order = np.remainder(11.0 + 0.25 * LINES + N_CELLS / 2, N_CELLS) - N_CELLS / 2
    alike = np.repeat(SHAPES[:, :1], 2, axis=1)
    waves = 0.1 + 1j * order, 0.1 + 1j * np.where(order > 0.0, -8.0, 8.0)
    numbers = branches(frames(*waves, shapes=alike), N_CELLS)
    assert {number[0] for number in numbers} == {0}


def test_no_line_has_a_branch_twice_and_all_waves_are_kept():
    found = dispersion_of(small.case_with(), lines=12, jobs=1)
    assert not found.failed.any()
    assert np.all(found.waves <= found.counted)
    assert np.all(found.waves >= 1)
    np.testing.assert_array_equal(np.isnan(found.order), np.isnan(found.decay))
    assert np.nanmax(found.decay) <= found.bound
    assert np.nanmin(found.decay) > 0.0
    assert np.nanmin(found.velocity) > 0.0
    assert np.nanmax(np.abs(found.order)) <= 7.5 + 1e-9
    assert np.nanmax(found.residual) < 1e-12
    shares = found.share.sum(axis=1)
    np.testing.assert_allclose(shares[~np.isnan(shares)], 1.0, rtol=1e-12)


ARRAYS = ("frequency", "order", "decay", "velocity", "share", "residual", "found", "counted")


def test_results_do_not_depend_on_the_number_of_jobs():
    one, two = (dispersion_of(small.case_with(), lines=7, jobs=jobs) for jobs in (1, 2))
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(one, name), getattr(two, name), strict=True)


def test_a_wider_bound_adds_waves_and_changes_none():
    narrow, wide = (dispersion_of(small.case_with(), lines=3, decay=d, jobs=1) for d in (6.0, 25.0))
    np.testing.assert_allclose(narrow.bound * NEPER, 6.0)
    kept = np.where(wide.decay <= narrow.bound, wide.decay, np.nan)
    for line in range(3):
        few, all_ = narrow.decay[:, line], kept[:, line]
        np.testing.assert_allclose(
            np.sort(few[~np.isnan(few)]), np.sort(all_[~np.isnan(all_)]), rtol=1e-9
        )
    assert np.all(wide.waves > narrow.waves)


PRESSURE = ('title = "Small tyre"', 'title = "Small tyre"\ninflation.pressure = "2 bar"')


def test_pressure_changes_the_waves_and_can_be_left_away():
    inflated = dispersion(small.case_with(PRESSURE), lines=3, jobs=1)
    resting = dispersion(small.case_with(PRESSURE), lines=3, jobs=1, at_rest=True)
    without = dispersion(small.case_with(), lines=3, jobs=1)

    assert inflated.inflation is not None
    assert inflated.inflation.pressure == 2e5
    assert resting.inflation is None
    np.testing.assert_array_equal(resting.order, without.order)
    assert np.nanmin(inflated.decay[:, 0]) != np.nanmin(without.decay[:, 0])


@pytest.mark.parametrize(
    ("values", "lines", "expected"),
    [
        ("[0.0, 40.0, 420.0]", 4, [105.0, 210.0, 315.0, 420.0]),
        ("[40.0, 420.0]", 3, [40.0, 230.0, 420.0]),
        ("[40.0]", 5, [40.0]),
    ],
)
def test_lines_spread_over_the_range_without_zero(values, lines, expected):
    case = small.case_with(("[0.0, 40.0, 150.0, 420.0]", values))
    np.testing.assert_allclose(spread(case, lines), expected)


def test_zero_hertz_alone_is_refused():
    with pytest.raises(CaseError, match=r"frequency: .*0 Hz alone"):
        spread(small.case_with(("[0.0, 40.0, 150.0, 420.0]", "[0.0]")), 10)


def test_a_line_without_proof_is_data(monkeypatch):
    whole = dispersion_of(small.case_with(), lines=5, jobs=1)
    at = FreeWaves.at

    def fails(self, omega, decay):
        if abs(omega - 2.0 * np.pi * 252.0) < 1.0:
            raise SolveError("252 Hz: too few")
        return at(self, omega, decay)

    monkeypatch.setattr(FreeWaves, "at", fails)
    found = dispersion_of(small.case_with(), lines=5, jobs=1)

    np.testing.assert_array_equal(found.failed, [False, False, True, False, False])
    assert found.remark[2] == "252 Hz: too few"
    assert np.isnan(found.order[:, 2]).all()
    assert (found.found[2], found.counted[2]) == (-1, -1)
    np.testing.assert_array_equal(np.delete(whole.waves, 2), np.delete(found.waves, 2))


def test_a_line_on_which_no_wave_is_within_the_bound_has_none():
    found = dispersion(small.case_with(), lines=1, decay=0.01, jobs=1)
    assert found.waves.tolist() == [0]
    assert not found.failed.any()
