"""Natural modes of a case: counted, described, and the same when read back from their file."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
import xarray
from hdf5 import undescribed
from small import case_with

from tyrefrf.arrays import ComplexArray
from tyrefrf.errors import ResultsError
from tyrefrf.mesh.cell import revolve
from tyrefrf.mesh.profile import tyre_section
from tyrefrf.results import Modes, load_any, load_modes, load_results, write_modes
from tyrefrf.study.modes import modes, nodal_diameters

HEX20 = ('element = "hex8i"', 'element = "hex20"')
PRESSURE = ("[cell]", '[inflation]\npressure = "0.5 bar"\n\n[cell]')
RELAXING = (
    'E = "80 MPa"\nnu = 0.42\nrho = 1200.0\neta = 0.1',
    "nu = 0.42\nrho = 1200.0\n"
    "modulus = { kind = 'zener', E_0 = 80e6, E_inf = 800e6, tau = 1e-4, alpha = 0.5 }",
)


@pytest.fixture(scope="module")
def found() -> Modes:
    return modes(case_with(), count=40)


@pytest.fixture(scope="module")
def inflated() -> Modes:
    return modes(case_with(PRESSURE), count=12)


def test_modes_ascend_and_are_as_many_as_counted(found):
    assert found.n_modes in (40, 41)
    assert np.all(np.diff(found.frequency) >= 0.0)
    assert found.frequency[-1] < found.cutoff
    np.testing.assert_array_equal(np.bincount(found.order, minlength=8), found.counted)
    np.testing.assert_array_equal(found.members, np.where(found.order == 0, 1, 2))


def test_all_below_a_frequency_are_found(found):
    top = found.frequency[20] + 1e-3
    below = modes(case_with(), below=top)
    np.testing.assert_allclose(below.frequency, found.frequency[:21], rtol=1e-9)
    assert below.cutoff == pytest.approx(top)


def test_one_material_s_loss_is_every_mode_s(found):
    np.testing.assert_allclose(found.loss_factor, 0.1, rtol=1e-9)
    np.testing.assert_allclose(found.loss_share, 1.0, rtol=1e-9)
    np.testing.assert_allclose(found.energy_share, 1.0, rtol=1e-9)


def test_shares_of_motion_add_up_and_name_the_kind(found):
    np.testing.assert_allclose(found.motion.sum(axis=1), 1.0, rtol=1e-12)
    torsion = np.flatnonzero(found.motion[:, 2] > 0.999)[0]  # all around the axle: order 0
    assert found.order[torsion] == 0
    assert found.kind[torsion] == "circumferential"
    assert found.kind[0] == "lateral"


def test_the_rim_does_not_move(found):
    np.testing.assert_array_equal(found.section_shape[:, found.section.rim], 0.0)


def test_orders_are_labelled_with_what_they_stand_for():
    many = modes(case_with(), count=80)
    assert dict(zip(many.order.tolist(), many.aliases, strict=True)) == {
        0: "0, 15, 30, ...",
        1: "1, 14, 16, ...",
        2: "2, 13, 17, ...",
        3: "3, 12, 18, ...",
        4: "4, 11, 19, ...",
        5: "5, 10, 20, ...",
        6: "6, 9, 21, ...",
        7: "7, 8, 22, ...",
    }


@pytest.mark.parametrize("pressure", ["0.5 bar", "1 bar"])
def test_pressure_raises_the_lowest_frequency_and_lowers_its_loss(pressure, found):
    state = modes(case_with(("[cell]", f'[inflation]\npressure = "{pressure}"\n\n[cell]')), count=3)
    assert state.inflation is not None
    assert state.frequency[0] > found.frequency[0]
    assert state.loss_factor[0] < 0.1  # the inflation's stiffness has none
    assert state.energy_share[0].sum() == pytest.approx(state.loss_factor[0] / 0.1)


def test_at_rest_leaves_the_inflation_away(found):
    resting = modes(case_with(PRESSURE), count=40, at_rest=True)
    assert resting.inflation is None
    np.testing.assert_array_equal(resting.frequency, found.frequency)


def test_moduli_are_each_mode_s_own_or_of_a_stated_frequency():
    own = modes(case_with(RELAXING), count=10)
    assert np.isnan(own.moduli_at)
    stated = modes(case_with(RELAXING), count=10, at=float(own.frequency[4]))
    assert stated.moduli_at == own.frequency[4]
    assert stated.frequency[4] == pytest.approx(own.frequency[4], rel=1e-9)
    assert np.all(stated.frequency[:4] > own.frequency[:4])
    assert np.ptp(stated.loss_factor) < 1e-9 < np.ptp(own.loss_factor)


def wave(n: int, planes: int, quadratic: bool) -> tuple[int, ComplexArray]:
    """What a mesh of 15 cells tells of a wave with n nodal diameters, and its order."""
    section = tyre_section(case_with().geometry, quadratic)
    mesh = revolve(section, 2.0 * np.pi / 15, planes)
    shape = np.exp(1j * n * mesh.points[: mesh.n_own, 2])[None, :, None] * np.ones((1, 1, 3))
    order = min(n % 15, -n % 15)
    shape = shape if order == n % 15 else shape.conj()
    return int(nodal_diameters(mesh, 15, order, shape)[0]), order


@pytest.mark.parametrize(
    ("planes", "quadratic", "told"), [(1, False, 7), (2, False, 15), (3, False, 22), (2, True, 30)]
)
def test_aliases_are_told_apart_up_to_half_a_wave_per_plane(planes, quadratic, told):
    assert [wave(n, planes, quadratic)[0] for n in range(told + 1)] == list(range(told + 1))
    folded, order = wave(8, 1, False)
    assert folded == order == 7  # one plane of nodes tells nothing


def test_what_goes_in_comes_out(found, inflated, tmp_path):
    for made in (found, inflated):
        write_modes(tmp_path / "m.h5", made)
        back = load_modes(tmp_path / "m.h5")
        for field in fields(Modes):
            value, read = getattr(made, field.name), getattr(back, field.name)
            if isinstance(value, np.ndarray):
                np.testing.assert_array_equal(read, value)
            elif field.name in ("cutoff", "moduli_at", "provenance"):
                assert read == value
        np.testing.assert_array_equal(back.section.quads, made.section.quads)
        assert (back.inflation is None) == (made.inflation is None)


def test_xarray_opens_it_as_it_is(inflated, tmp_path):
    path = tmp_path / "m.h5"
    write_modes(path, inflated)
    with xarray.open_dataset(path, engine="h5netcdf") as data:
        assert data["shape"].dims == ("mode", "direction", "cell_node")
        radial = data["shape"].sel(mode=3, direction="r")
        np.testing.assert_array_equal(radial, inflated.shape[2, :, 0])
        assert data["frequency"].attrs["units"] == "Hz"
        assert data["loss_share"].sel(made_of="rubber").dims == ("mode",)
        np.testing.assert_array_equal(data["counted"].sel(all_orders=0), inflated.counted[0])
        assert data.attrs["content"] == "modes"
    with xarray.open_datatree(path, engine="h5netcdf") as tree:
        assert tree["section"]["points"].sizes["node"] == inflated.section.n_nodes
        assert tree["inflation"]["pressure"].item() == 0.5e5


def test_every_dataset_names_its_axes_units_and_meaning(inflated, tmp_path):
    write_modes(tmp_path / "modes.h5", inflated)
    assert undescribed(tmp_path / "modes.h5") == []


def test_a_file_of_modes_is_not_a_run(found, tmp_path):
    write_modes(tmp_path / "m.h5", found)
    with pytest.raises(ResultsError, match="load_modes"):
        load_results(tmp_path / "m.h5")
    assert isinstance(load_any(tmp_path / "m.h5"), Modes)


def test_a_missing_mode_is_refused(found):
    counted = found.counted.copy()
    counted[3] += 1
    with pytest.raises(ResultsError, match="not as many as counted"):
        replace(found, counted=counted)


def test_wrong_shapes_are_refused(found):
    with pytest.raises(ResultsError, match="loss_factor has shape"):
        replace(found, loss_factor=found.loss_factor[1:].copy())
