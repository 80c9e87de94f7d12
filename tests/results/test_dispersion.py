"""Free waves in a results file: what goes in comes out, for this program and xarray alike."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
import synthetic
import xarray
from hdf5 import undescribed

from tyrefrf.errors import ResultsError
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results import Dispersion, StaticState, load_any, load_dispersion, load_results
from tyrefrf.results.dispersion_layout import write_dispersion

ARRAYS = (
    "frequency",
    "order",
    "decay",
    "velocity",
    "share",
    "residual",
    "found",
    "counted",
    "solve_time",
)


@pytest.fixture
def made() -> Dispersion:
    """Two branches on four lines: one cuts on, one runs from the start; one line failed."""
    nan = np.nan
    order = np.array([[nan, 0.1, nan, 2.4], [1.0, 2.0, nan, 21.9]])
    decay = np.array([[nan, 1.7, nan, 0.4], [0.1, 0.2, nan, 0.7]])
    return Dispersion(
        frequency=np.array([25.0, 50.0, 75.0, 100.0]),
        order=order,
        decay=decay,
        velocity=300.0 * order,
        share=np.stack([0.5 + 0.0 * order, 0.3 + 0.0 * order, 0.2 + 0.0 * order], axis=1),
        residual=1e-15 * decay,
        found=np.array([1, 2, -1, 2]),
        counted=np.array([1, 2, -1, 2]),
        solve_time=np.array([0.1, 0.2, 0.3, 0.4]),
        remark=("", "", "75 Hz: one is missing", ""),
        bound=2.0,
        section=synthetic.section(),
        provenance=synthetic.PROVENANCE,
    )


@pytest.fixture
def path(made, tmp_path):
    write_dispersion(tmp_path / "waves.h5", made)
    return tmp_path / "waves.h5"


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_come_back_to_the_bit_with_their_type(made, path, name):
    array = getattr(load_dispersion(path), name)
    np.testing.assert_array_equal(array, getattr(made, name), strict=True)


@pytest.mark.parametrize("name", ["remark", "bound", "provenance", "inflation"])
def test_the_rest_comes_back_equal(made, path, name):
    assert getattr(load_dispersion(path), name) == getattr(made, name)


@pytest.mark.parametrize("name", [field.name for field in fields(SectionMesh)])
def test_the_section_comes_back(made, path, name):
    read, written = getattr(load_dispersion(path).section, name), getattr(made.section, name)
    np.testing.assert_array_equal(read, written, strict=True)


def test_the_state_under_pressure_comes_back(made, tmp_path):
    state = StaticState(
        pressure=2e5,
        displacement=np.ones((58, 2)),
        stress=np.ones((28, 6)),
        resultant=np.array([4.0, 0.0, 0.0]),
        share=np.ones(1),
        iterations=np.ones(1, dtype=np.int64),
        lack=np.zeros(1),
    )
    write_dispersion(tmp_path / "inflated.h5", replace(made, inflation=state))
    read = load_dispersion(tmp_path / "inflated.h5").inflation
    assert read is not None
    assert read.pressure == 2e5
    np.testing.assert_array_equal(read.resultant, state.resultant)


def test_no_wave_at_all_comes_back(made, tmp_path):
    nothing = {name: getattr(made, name)[:0] for name in ("order", "decay", "velocity", "residual")}
    write_dispersion(tmp_path / "none.h5", replace(made, **nothing, share=made.share[:0]))
    assert load_dispersion(tmp_path / "none.h5").order.shape == (0, 4)


def test_any_file_of_waves_is_known_as_such(path):
    assert isinstance(load_any(path), Dispersion)
    with pytest.raises(ResultsError, match="holds a dispersion; read it with load_dispersion"):
        load_results(path)


def test_xarray_opens_it_as_it_is(made, path):
    with xarray.open_dataset(path, engine="h5netcdf") as data:
        assert data["order"].dims == ("branch", "frequency")
        assert data["share"].dims == ("branch", "direction", "frequency")
        assert data["order"].sel(branch=2, frequency=50.0) == 2.0
        assert data["share"].sel(branch=2, direction="y", frequency=50.0) == 0.3
        np.testing.assert_array_equal(data["wavenumber"], made.order / made.radius)
        assert data["decay"].attrs["units"] == "Np/rad"
        assert data.attrs["content"] == "dispersion"


def test_every_dataset_names_its_axes_units_and_meaning(path):
    assert undescribed(path) == []


def test_what_runs_is_told_from_what_dies_away(made):
    """Order 21.9 of 45 cells is near to 22.5, where cells move against each other."""
    expected = [[False, False, False, True], [True, True, False, False]]
    np.testing.assert_array_equal(made.propagating, expected)
    np.testing.assert_array_equal(made.cut_on, [100.0, 25.0])
    np.testing.assert_array_equal(made.waves, [1, 2, 0, 2])


@pytest.mark.parametrize(("found", "counted"), [(-1, -1), (2, 3), (3, 2)])
def test_a_line_fails_without_its_proof(made, found, counted):
    both = (np.array([1, 2, n, 2]) for n in (found, counted))
    changed = replace(made, **dict(zip(("found", "counted"), both, strict=True)))
    np.testing.assert_array_equal(changed.failed, [False, False, True, False])


def test_shapes_that_do_not_agree_are_refused(made):
    with pytest.raises(ResultsError, match=r"decay has shape \(1, 4\); expected \(2, 4\)"):
        replace(made, decay=made.decay[:1])
    with pytest.raises(ResultsError, match="1 remarks for 4 lines"):
        replace(made, remark=("",))


def test_arrays_are_read_only(made):
    with pytest.raises(ValueError, match="read-only"):
        made.order[0, 0] = 1.0
