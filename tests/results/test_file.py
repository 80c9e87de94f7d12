"""The results file: what goes in comes out, for this program, h5py and xarray alike."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import synthetic
import xarray
from hdf5 import undescribed

from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results import Results, load_results, write_results

ARRAYS = ("frequency", "receptance", "blocked_force", "solved", "residual", "solve_time")


@pytest.fixture
def made() -> Results:
    return synthetic.with_failed(synthetic.results(), 7, 200)


@pytest.fixture
def path(made: Results, tmp_path: Path) -> Path:
    write_results(tmp_path / "made_up.h5", made)
    return tmp_path / "made_up.h5"


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_come_back_to_the_bit_with_their_type(made, path, name):
    array = getattr(load_results(path), name)
    np.testing.assert_array_equal(array, getattr(made, name), strict=True)


@pytest.mark.parametrize("name", ["loads", "probes", "remark", "provenance", "hub"])
def test_the_rest_comes_back_equal(made, path, name):
    assert getattr(load_results(path), name) == getattr(made, name)


@pytest.mark.parametrize("name", [field.name for field in fields(SectionMesh)])
def test_the_section_comes_back(made, path, name):
    read, written = getattr(load_results(path).section, name), getattr(made.section, name)
    np.testing.assert_array_equal(read, written, strict=True)


def test_numbers_keep_their_python_types(path):
    provenance = load_results(path).provenance
    assert [type(value) for value in provenance.numbers.values()] == [int, float]
    assert type(provenance.n_cells) is int


def test_a_place_off_the_surfaces_comes_back(made, tmp_path):
    node = replace(made.probes[0], kind="node", surface="", s=float("nan"))
    write_results(tmp_path / "node.h5", replace(made, probes=(node, *made.probes[1:])))
    assert np.isnan(load_results(tmp_path / "node.h5").probes[0].s)


def test_without_a_hub_the_file_has_none(made, tmp_path):
    without = replace(made, blocked_force=made.blocked_force[:, :0])
    write_results(tmp_path / "no_hub.h5", without)
    assert load_results(tmp_path / "no_hub.h5").blocked_force.shape == (2, 0, 401)
    assert "hub" not in xarray.open_dataset(tmp_path / "no_hub.h5", engine="h5netcdf")


def test_a_tyre_without_a_rim_comes_back(made, tmp_path):
    free = replace(made, section=replace(made.section, rim=np.empty(0, dtype=np.int64)))
    write_results(tmp_path / "free.h5", free)
    assert load_results(tmp_path / "free.h5").section.rim.shape == (0,)


def test_a_case_text_larger_than_an_hdf5_attribute_comes_back(made, tmp_path):
    text = "# η\n" * 50_000
    provenance = replace(made.provenance, case_text=text)
    write_results(tmp_path / "long.h5", replace(made, provenance=provenance))
    assert load_results(tmp_path / "long.h5").provenance.case_text == text


def test_xarray_opens_it_as_it_is(made, path):
    with xarray.open_dataset(path, engine="h5netcdf") as data:
        assert data["mobility"].dims == ("load", "probe", "frequency")
        assert data["mobility"].dtype == np.complex128
        np.testing.assert_array_equal(data["mobility"], made.mobility)
        one = data["mobility"].sel(load="radial", probe="shoulder", frequency=500.0)
        assert one == made.response("radial", "shoulder")[100]
        force = data["blocked_force"].sel(load="tangential", hub="My")
        np.testing.assert_array_equal(force, made.blocked_force[1, 4])
        assert data["solved"].dtype == bool
        assert data["solve_time"].dtype == float  # its units, s, make no timedelta of it
        assert data["probe_direction"].sel(probe="sidewall") == "y"
        assert data.attrs["case_text"] == made.provenance.case_text


def test_xarray_opens_its_groups(made, path):
    with xarray.open_datatree(path, engine="h5netcdf") as tree:
        r = tree["section"]["points"].sel(coordinate="r")
        np.testing.assert_array_equal(r, made.section.points[:, 0])
        assert tree["numbers"].attrs == made.provenance.numbers


def test_every_dataset_names_its_axes_units_and_meaning(path):
    with h5py.File(path) as file:
        assert file["mobility"].attrs["units"] == "m/(s N)"
        assert file["mobility"].dims[2][0] == file["frequency"]
    assert undescribed(path) == []


def test_responses_are_stored_as_the_layout_says(path):
    with h5py.File(path) as file:
        mobility = file["mobility"]
        members = mobility.id.get_type()
        assert [members.get_member_name(i) for i in range(2)] == [b"r", b"i"]
        assert mobility.chunks == (1, 1, 401)
        assert (mobility.compression, mobility.fletcher32) == ("gzip", True)
        assert np.isnan(mobility.fillvalue.real)
        assert np.isnan(mobility.fillvalue.imag)
        assert file.attrs["program"] == "tyrefrf"
        assert file.attrs["layout"] == 1
        assert "accelerance" not in file


def test_two_loads_eight_probes_401_lines_stay_small(path):
    assert path.stat().st_size < 500_000
