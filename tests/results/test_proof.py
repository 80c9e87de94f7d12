"""What every line proves of itself: a residual, power that goes in and not out, reciprocity.

A made-up tyre of damped modes is passive and reciprocal to rounding; every test spoils one of its
lines in one way, by as much as it says.
"""

from __future__ import annotations

from dataclasses import replace

import h5py
import numpy as np
import pytest
import synthetic
import xarray
from hdf5 import seal_again

from tyrefrf.case.axis import Axis
from tyrefrf.results import (
    Results,
    SweepResults,
    load_results,
    load_sweep,
    write_results,
    write_sweep,
)
from tyrefrf.results.certificate import Certificate
from tyrefrf.results.proof import MEASURES, breaches, passivity, power, reciprocity

LINE = 100  # 500 Hz
RADIAL, EDGE = (0, 2), (1, 3)  # a load and its own point among the probes
ROUND_OFF = 1e-12

LOADS = (synthetic.place("radial", 0.5, "r"), synthetic.place("edge", 0.3, "r", angle=40.0))
PROBES = (
    *synthetic.PROBES[:2],
    synthetic.place("radial.drive", 0.5, "r"),
    synthetic.place("edge.drive", 0.3, "r", angle=40.0),
    *synthetic.PROBES[4:],
)


@pytest.fixture
def made() -> Results:
    """Two loads that drive the same modes."""
    return synthetic.results(loads=LOADS, probes=PROBES)


def radial_only(made: Results) -> Results:
    return replace(
        made,
        loads=made.loads[:1],
        receptance=made.receptance[:1].copy(),
        blocked_force=made.blocked_force[:1].copy(),
    )


def spoilt(made: Results, *changes: tuple[int, int, complex], line: int = LINE) -> Results:
    """Responses of (load, probe) times a factor on one line."""
    receptance = made.receptance.copy()
    for load, probe, factor in changes:
        receptance[load, probe, line] *= factor
    return replace(made, receptance=receptance)


def with_residual(made: Results, value: float, *lines: int) -> Results:
    residual = made.residual.copy()
    residual[list(lines)] = value
    return replace(made, residual=residual)


def turned(made: Results, share: float) -> complex:
    """The factor that makes Re Y = share |Y| at the radial load's own point."""
    Y = made.mobility[(*RADIAL, LINE)]
    return np.exp(1j * (np.arccos(share) * np.sign(np.angle(Y)) - np.angle(Y)))


def test_a_sound_tyre_breaches_nothing(made):
    assert breaches(made) == ()


def test_passivity_is_the_share_of_the_mobility_that_takes_power(made):
    shares = passivity(made)
    Y = made.driving_point("edge")
    assert shares.shape == (2, 401)
    assert np.isnan(shares[:, 0]).all()  # 0 Hz: nothing moves
    np.testing.assert_allclose(shares[1, 1:], np.cos(np.angle(Y[1:])))


def test_power_is_the_least_that_any_mix_of_loads_puts_in(made):
    """From all mixes of two forces on a grid of amplitudes and phases, none puts in less."""
    made = spoilt(made, (0, 3, 1.5j))  # not reciprocal: nothing but the power counts
    Y = np.array([[made.mobility[i, j, LINE] for j in (2, 3)] for i in (0, 1)])
    t, phi = np.meshgrid(np.linspace(0.0, np.pi / 2, 400), np.linspace(0.0, 2 * np.pi, 400))
    F = np.array([np.cos(t), np.sin(t) * np.exp(1j * phi)])
    put_in = np.einsum("i...,ij,j...->...", F.conj(), Y, F).real
    assert power(made)[LINE] == pytest.approx(put_in.min() / np.linalg.norm(Y), rel=1e-3)


def test_with_one_load_its_power_is_its_passivity(made):
    alone = radial_only(made)
    np.testing.assert_allclose(power(alone)[1:], passivity(alone)[0, 1:], rtol=ROUND_OFF)
    assert np.isnan(reciprocity(alone)).all()
    assert breaches(alone) == ()


def test_reciprocity_is_what_changes_when_load_and_probe_change_places(made):
    lopsided = spoilt(made, (0, 3, 1.01))
    block = [[lopsided.receptance[i, j, LINE] for j in (2, 3)] for i in (0, 1)]
    expected = 0.01 * abs(made.receptance[0, 3, LINE]) / np.linalg.norm(block)
    assert reciprocity(made).max() < ROUND_OFF
    assert reciprocity(lopsided)[LINE] == pytest.approx(expected)


@pytest.mark.parametrize("share", [-1e-8, -0.3])
def test_power_that_comes_out_is_a_breach_that_names_line_and_load(made, share):
    (breach,) = breaches(spoilt(made, (*RADIAL, turned(made, share))))
    assert breach == f"500 Hz: Re Y is {share:.1e} |Y| at radial: power comes out"


def test_a_real_part_that_is_rounding_is_none(made):
    """1e-11 |Y| on the wrong side, with a residual of 1e-15; and 1e-8 |Y|, with one of 1e-9."""
    alone = radial_only(made)
    assert breaches(spoilt(alone, (*RADIAL, turned(made, -1e-11)))) == ()
    coarse = with_residual(alone, 1e-9, LINE)
    assert breaches(spoilt(coarse, (*RADIAL, turned(made, -1e-8)))) == ()


def test_at_an_antiresonance_the_real_part_may_be_all_rounding(made):
    """The mobility is 1e-6 of what it is elsewhere, its error is not."""
    alone = radial_only(made)
    alone = replace(alone, probes=made.probes[2:3], receptance=made.receptance[:1, 2:3])
    deep = with_residual(spoilt(alone, (0, 0, 1e-6 * turned(made, -0.01))), 1e-9, LINE)
    assert passivity(deep)[0, LINE] == pytest.approx(-0.01)
    assert breaches(deep) == ()
    assert len(breaches(spoilt(deep, (0, 0, 1e5)))) == 1


def test_loads_that_draw_power_out_together_breach(made):
    """Each of them alone puts power in."""
    coupled = spoilt(made, (0, 3, 10.0), (1, 2, 10.0))
    assert np.nanmin(passivity(coupled)) > 0.0
    (breach,) = breaches(coupled)
    assert breach.startswith("500 Hz: loads together can draw power out: smallest eigenvalue -")


def test_responses_that_are_not_reciprocal_breach(made):
    (breach,) = breaches(spoilt(made, (0, 3, 1.0 + 1e-6)))
    assert breach.startswith("500 Hz: responses differ by ")
    assert breaches(spoilt(made, (0, 3, 1.0 + 1e-11))) == ()


def test_a_residual_is_a_breach_above_its_limit(made):
    assert breaches(with_residual(made, 9.9e-9, LINE)) == ()
    assert breaches(with_residual(made, 3.2e-8, LINE)) == (
        "500 Hz: residual 3.2e-08 is above 1e-08",
    )


def test_every_line_is_named_once_with_all_that_is_wrong(made):
    bad = with_residual(spoilt(made, (*RADIAL, turned(made, -0.3))), 3e-8, 7, LINE)
    first, second = breaches(bad)
    assert first == "35 Hz: residual 3.0e-08 is above 1e-08"
    assert second == (
        "500 Hz: residual 3.0e-08 is above 1e-08; Re Y is -3.0e-01 |Y| at radial: power comes out"
    )


def test_a_line_without_an_answer_is_a_failure_and_no_breach(made):
    failed = synthetic.with_failed(made, 7, LINE)
    assert breaches(failed) == ()
    assert np.flatnonzero(np.isnan(power(failed))).tolist() == [0, 7, LINE]
    assert np.flatnonzero(np.isnan(reciprocity(failed))).tolist() == [7, LINE]
    assert MEASURES["passivity"].worst_of(failed) is not None
    everything = synthetic.with_failed(made, *range(401))
    assert breaches(everything) == ()
    assert MEASURES["residual"].worst_of(everything) is None


def test_a_line_that_was_fitted_is_not_judged(made):
    bad = spoilt(made, (*RADIAL, turned(made, -0.3)))
    solved = bad.solved.copy()
    solved[LINE] = False
    assert breaches(replace(bad, solved=solved)) == ()


def test_modal_is_truncated_reports_and_does_not_breach(made):
    bad = with_residual(spoilt(made, (*RADIAL, turned(made, -0.3))), 0.2, LINE)
    modal = replace(bad, provenance=replace(bad.provenance, solver="modal"))
    assert breaches(modal) == ()
    assert MEASURES["residual"].worst_of(modal).value == 0.2
    assert MEASURES["passivity"].worst_of(modal).value == pytest.approx(-0.3)


def test_the_worst_is_named_with_its_line_and_load(made):
    bad = with_residual(spoilt(made, (*RADIAL, turned(made, -0.3))), 3e-8, 7)
    assert MEASURES["passivity"].worst_of(bad).frequency == 500.0
    assert MEASURES["passivity"].worst_of(bad).load == "radial"
    assert MEASURES["residual"].worst_of(bad).frequency == 35.0
    assert MEASURES["residual"].worst_of(bad).load == ""


def test_loads_without_a_driving_point_have_nothing_to_prove(made):
    lonely = replace(made, probes=made.probes[:2], receptance=made.receptance[:, :2])
    assert np.isnan(passivity(lonely)).all()
    assert breaches(lonely) == ()
    assert MEASURES["power"].worst_of(lonely) is None


CERTIFICATE = Certificate(
    solver="cyclic",
    frequency=np.array([0.0, 500.0]),
    residual=np.array([1e-13, 2e-13]),
    difference=np.array([[1e-12, 2e-12], [np.nan, 3e-12]]),
    cell_difference=np.array([[1e-11, 2e-11], [np.nan, 3e-11]]),
    n_cells=90,
    refined_frequency=np.array([0.0, 5.0, 500.0]),
    level_change=np.linspace(-1.0, 1.0, 48).reshape(2, 8, 3),
    left_out="",
)
LEFT_OUT = replace(
    CERTIFICATE,
    n_cells=0,
    refined_frequency=np.empty(0),
    level_change=np.empty((2, 8, 0)),
    left_out="case: cell.sector_angle: too small",
)


@pytest.mark.parametrize("difference", [2e-8, 1e-6])
def test_a_second_solver_that_differs_is_a_breach(made, difference):
    sound = replace(made, certificate=CERTIFICATE)
    off = replace(CERTIFICATE, difference=np.array([[1e-12, difference], [1e-12, 1e-12]]))
    assert breaches(sound) == ()
    assert breaches(replace(made, certificate=off)) == (
        f"500 Hz: cyclic differs by {difference:.1e}",
    )


def test_residuals_may_explain_a_difference(made):
    off = replace(CERTIFICATE, difference=np.full((2, 2), 2e-8), residual=np.array([1e-13, 1e-9]))
    assert breaches(replace(made, certificate=off)) == ("0 Hz: cyclic differs by 2.0e-08",)


@pytest.mark.parametrize("certificate", [CERTIFICATE, LEFT_OUT], ids=["refined", "left out"])
def test_a_certificate_comes_back(made, tmp_path, certificate):
    write_results(tmp_path / "certified.h5", replace(made, certificate=certificate))
    back = load_results(tmp_path / "certified.h5").certificate
    assert (back.solver, back.n_cells, back.left_out) == (
        certificate.solver, certificate.n_cells, certificate.left_out,
    )  # fmt: skip
    for name in (
        "frequency", "residual", "difference", "cell_difference", "refined_frequency",
        "level_change",
    ):  # fmt: skip
        np.testing.assert_array_equal(getattr(back, name), getattr(certificate, name), strict=True)


def test_xarray_opens_a_certificate_beside_the_run(made, tmp_path):
    write_results(tmp_path / "certified.h5", replace(made, certificate=CERTIFICATE))
    with xarray.open_datatree(tmp_path / "certified.h5", engine="h5netcdf") as tree:
        change = tree["certificate"]["level_change"]
        assert change.dims == ("load", "probe", "refined")
        one = change.sel(load="edge", probe="far side", refined=5.0)
        assert one == CERTIFICATE.level_change[1, 4, 1]
        assert change.attrs["units"] == "dB"


def test_a_run_without_a_certificate_has_no_group_of_it(made, tmp_path):
    write_results(tmp_path / "run.h5", made)
    assert load_results(tmp_path / "run.h5").certificate is None
    with h5py.File(tmp_path / "run.h5") as file:
        assert "certificate" not in file


def test_the_file_holds_what_is_derived(made, tmp_path):
    failed = synthetic.with_failed(made, 7)
    write_results(tmp_path / "run.h5", failed)
    with xarray.open_dataset(tmp_path / "run.h5", engine="h5netcdf") as data:
        assert data["passivity"].dims == ("load", "frequency")
        np.testing.assert_array_equal(data["passivity"], passivity(failed))
        np.testing.assert_array_equal(data["power"], power(failed))
        np.testing.assert_array_equal(data["reciprocity"], reciprocity(failed))


def test_a_file_of_before_the_proofs_is_read(made, tmp_path):
    write_results(tmp_path / "old.h5", made)
    with h5py.File(tmp_path / "old.h5", "r+") as file:
        for name in ("passivity", "power", "reciprocity"):
            del file[name]
    seal_again(tmp_path / "old.h5")
    np.testing.assert_array_equal(power(load_results(tmp_path / "old.h5")), power(made))


def test_a_sweep_stores_the_proof_of_every_point(made, tmp_path):
    axis = Axis("E_rubber", "materials.rubber.E", "Pa", "Young's modulus", (14e6, 28e6))
    bad = spoilt(made, (*EDGE, -1.0))
    write_sweep(tmp_path / "sweep.h5", SweepResults((axis,), (made, bad), synthetic.PROVENANCE))
    with xarray.open_dataset(tmp_path / "sweep.h5", engine="h5netcdf") as data:
        assert data["passivity"].dims == ("E_rubber", "load", "frequency")
        np.testing.assert_array_equal(data["passivity"][1], passivity(bad))
        np.testing.assert_array_equal(data["power"][0], power(made))
    back = load_sweep(tmp_path / "sweep.h5")
    assert [len(breaches(point)) for point in back.points] == [0, 1]
