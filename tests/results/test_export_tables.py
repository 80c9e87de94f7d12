"""CSV read by csv, numpy and pandas; MAT-files by scipy; the HDF5 as xarray and MATLAB do."""

from __future__ import annotations

import csv
from dataclasses import replace

import h5py
import numpy as np
import pandas
import pytest
import synthetic
import xarray
from scipy.io import loadmat

from tyrefrf.case.axis import Axis
from tyrefrf.errors import ResultsError
from tyrefrf.results import write_results
from tyrefrf.results.derived import (
    ISO_1683,
    band_mean_square,
    bands_of,
    level,
    reference_of,
    space_mean_square,
)
from tyrefrf.results.export import export, matlab
from tyrefrf.results.sweep import SweepResults

PROBES = (
    *synthetic.PROBES[:3],
    replace(synthetic.place("tread.1", 0.45, "r"), kind="region"),
    replace(synthetic.place("tread.2", 0.55, "r", angle=20.0), kind="region"),
)
AXES = (
    Axis("E_rubber", "materials.rubber.E", "Pa", "Young's modulus", (28e6, 56e6)),
    Axis("pressure", "inflation.pressure", "Pa", "internal pressure", (0.0, 1e5, 2e5)),
)


@pytest.fixture(scope="module")
def made():
    """Responses, with a region of two points and a line that failed, at 500 Hz."""
    return synthetic.with_failed(synthetic.results(probes=PROBES), 100)


@pytest.fixture(scope="module")
def sweep(made):
    """Six points; at the k-th everything moves 1 + k times as far."""
    points = tuple(replace(made, receptance=(1 + k) * made.receptance) for k in range(6))
    return SweepResults(AXES, points, made.provenance)


@pytest.fixture(scope="module")
def tables(made, tmp_path_factory):
    return export(made, tmp_path_factory.mktemp("csv") / "made", ["csv"])


def read(path):
    return pandas.read_csv(path, comment="#")


def test_pandas_reads_every_response_with_all_its_digits(made, tables):
    table = read(tables[0])
    np.testing.assert_array_equal(table["frequency [Hz]"], made.frequency)
    name, units = "mobility tangential -> sidewall", "[m/(s N)]"
    Y = table[f"{name} real {units}"] + 1j * table[f"{name} imag {units}"]
    expected = made.response("tangential", "sidewall")
    np.testing.assert_array_equal(Y, expected)
    np.testing.assert_array_equal(table[f"{name} magnitude {units}"], np.abs(expected))
    np.testing.assert_array_equal(table[f"{name} phase [deg]"], np.degrees(np.angle(expected)))


def test_numpy_reads_the_same_numbers(made, tables):
    names = [line for line in tables[0].read_text().splitlines() if not line.startswith("#")]
    n_comments = len(tables[0].read_text().splitlines()) - len(names)
    numbers = np.genfromtxt(tables[0], delimiter=",", skip_header=n_comments + 1)
    assert numbers.shape == (401, 1 + 2 * (4 * 3 + 1 + 4 * 6))
    np.testing.assert_array_equal(numbers[:, 1], made.mobility[0, 0].real)


def test_a_line_without_an_answer_has_empty_cells(tables):
    rows = list(csv.reader(tables[0].read_text().splitlines()))
    (failed,) = [row for row in rows if row[0] == "500.0"]
    assert set(failed[1:]) == {""}


def test_a_region_is_its_root_mean_square_and_not_its_points(made, tables):
    table = read(tables[0])
    rms = table["mobility radial -> tread rms [m/(s N)]"]
    np.testing.assert_allclose(rms, np.sqrt(space_mean_square(made, "tread")[0]), rtol=1e-15)
    assert not [name for name in table.columns if "tread.1" in name]


def test_blocked_forces_are_columns_with_units_of_their_own(made, tables):
    table = read(tables[0])
    np.testing.assert_array_equal(
        table["blocked force tangential -> My imag [N m/N]"], made.blocked_force[1, 4].imag
    )
    assert "blocked force radial -> Fx phase [deg]" in table


def test_bands_are_rms_and_level(made, tables):
    table = read(tables[1])
    bands = bands_of(made.frequency)
    np.testing.assert_array_equal(table["centre [Hz]"], bands.centre)
    mean = band_mean_square(made.frequency, np.abs(made.mobility[0, 0]) ** 2, bands)
    name = "mobility radial -> shoulder"
    np.testing.assert_allclose(table[f"{name} rms [m/(s N)]"], np.sqrt(mean), rtol=1e-15)
    np.testing.assert_allclose(
        table[f"{name} level [dB]"], level(mean, reference_of("mobility")), rtol=1e-15
    )
    known = table.set_index("band [Hz]")[f"{name} level [dB]"].notna()
    assert (known[400.0], known[500.0], known[630.0]) == (True, False, True)
    assert "mobility tangential -> tread level [dB]" in table


def test_the_header_names_case_version_units_and_reference(made, tmp_path):
    lines, bands = export(made, tmp_path / "made", ["csv"], "mobility", ISO_1683["mobility"])
    text = lines.read_text()
    for part in ("A made-up tyre", "case made_up", "tyrefrf 0.1.0", "[m/(s N)]", "recursive"):
        assert part in text
    assert "level in dB re 0.001 m/(s N) (ISO 1683: 1 nm/s; 1 uN)" in bands.read_text()


def test_a_sweep_has_its_parameters_as_columns(made, sweep, tmp_path):
    lines, bands = export(sweep, tmp_path / "made_sweep", ["csv"])
    table = read(lines)
    assert len(table) == 6 * 401
    here = table[(table["E_rubber [Pa]"] == 56e6) & (table["pressure [Pa]"] == 1e5)]
    Y = here["mobility radial -> shoulder imag [m/(s N)]"]
    np.testing.assert_allclose(Y, 5 * made.mobility[0, 0].imag)
    assert len(read(bands)) == 6 * len(bands_of(made.frequency))


AWKWARD = [
    'tread, "left"',
    "# one; two",
    "=1+1",
    "Lauffläche µ",
    "タイヤ",
    "x" * 100,
    " spaced ",
    "50 %",
]


@pytest.mark.parametrize("name", AWKWARD)
def test_awkward_names_are_columns_as_they_are(name, tmp_path):
    probes = (replace(PROBES[0], name=name), *PROBES[1:])
    made = synthetic.results(np.array([10.0, 20.0, 30.0]), probes=probes)
    provenance = replace(made.provenance, title=f'A {name}, or "so')
    lines, bands = export(replace(made, provenance=provenance), tmp_path / "made", ["csv"])
    column = read(lines)[f"mobility radial -> {name} real [m/(s N)]"]
    np.testing.assert_array_equal(column, made.mobility[0, 0].real)
    assert f"mobility radial -> {name} level [dB]" in read(bands)
    rows = list(csv.reader(lines.read_text("utf-8-sig").splitlines()))
    assert {len(row) for row in rows if row[0].startswith("# ")} == {1}  # as spreadsheets see them


def test_the_text_is_plain_ascii_unless_a_name_is_not(tables, tmp_path):
    """A byte order mark, by which Excel knows UTF-8, only where there is anything to know."""
    assert tables[0].read_bytes().isascii()
    probes = (replace(PROBES[0], name="Seitenwandhöhe"), *PROBES[1:])
    lines, _ = export(synthetic.results(probes=probes), tmp_path / "made", ["csv"])
    assert lines.read_bytes().startswith(b"\xef\xbb\xbf#")


def load(path):
    return loadmat(path, simplify_cells=True)


def test_a_mat_file_holds_the_responses_to_the_bit(made, tmp_path):
    (path,) = export(made, tmp_path / "made", ["mat"])
    m = load(path)
    np.testing.assert_array_equal(m["mobility"], made.mobility)
    np.testing.assert_array_equal(m["blocked_force"], made.blocked_force)
    np.testing.assert_array_equal(m["frequency"], made.frequency)
    assert loadmat(path)["frequency"].shape == (401, 1)
    assert np.isnan(m["mobility"][0, 0, 100])
    assert list(m["probe"]) == [probe.name for probe in made.probes]
    assert list(m["hub"]) == list(made.hub)
    assert (m["units"], m["case_name"], m["quantity"]) == ("m/(s N)", "made_up", "mobility")
    assert list(m["place"]["probe"]["direction"]) == [probe.direction for probe in made.probes]
    np.testing.assert_array_equal(m["place"]["load"]["s"], [load.s for load in made.loads])


def test_a_mat_file_holds_bands_and_regions(made, tmp_path):
    (path,) = export(made, tmp_path / "made", ["mat"], "receptance", ISO_1683["receptance"])
    m = load(path)
    bands = bands_of(made.frequency)
    mean = band_mean_square(made.frequency, np.abs(made.receptance) ** 2, bands)
    np.testing.assert_array_equal(m["bands"]["mean_square"], mean)
    np.testing.assert_array_equal(m["bands"]["level"], level(mean, ISO_1683["receptance"]))
    assert m["bands"]["reference_name"] == ISO_1683["receptance"].name
    tread = space_mean_square(made, "tread", "receptance")
    np.testing.assert_array_equal(loadmat(path)["regions"]["mean_square"][0, 0][:, 0], tread)
    assert path.name == "made_receptance.mat"


def test_a_sweep_leads_with_its_parameters(sweep, tmp_path):
    (path,) = export(sweep, tmp_path / "made_sweep", ["mat"])
    m = load(path)
    assert m["mobility"].shape == (2, 3, 2, 5, 401)
    np.testing.assert_array_equal(m["mobility"], sweep.mobility)
    assert list(m["parameter"]["name"]) == ["E_rubber", "pressure"]
    np.testing.assert_array_equal(m["parameter"]["values"][1], [0.0, 1e5, 2e5])
    assert m["bands"]["mean_square"].shape == (2, 3, 2, 5, len(bands_of(sweep.frequency)))
    assert m["regions"]["mean_square"].shape == (2, 3, 2, 401)  # one region


@pytest.mark.parametrize("name", AWKWARD)
def test_awkward_names_are_cells_as_they_are(name, tmp_path):
    probes = (replace(PROBES[0], name=name), *PROBES[1:])
    made = synthetic.results(np.array([10.0, 20.0]), probes=probes)
    (path,) = export(made, tmp_path / "made", ["mat"])
    assert load(path)["probe"][0] == name


def test_names_of_variables_are_short_enough_for_matlab(sweep, tmp_path):
    (path,) = export(sweep, tmp_path / "made_sweep", ["mat"])
    names = [name for name in loadmat(path) if not name.startswith("__")]
    assert max(map(len, names)) <= 63
    assert all(name.isidentifier() for name in names)


def test_what_a_mat_file_cannot_hold_is_refused(made, tmp_path, monkeypatch):
    monkeypatch.setattr(matlab, "LARGEST", 1000)
    with pytest.raises(ResultsError, match="h5read"):
        export(made, tmp_path / "made", ["mat"])
    assert list(tmp_path.iterdir()) == []


def test_other_results_and_formats_are_refused(made, tmp_path):
    with pytest.raises(ResultsError, match=r"no format 'csw'.*did you mean 'csv'"):
        export(made, tmp_path / "made", ["csw"])
    with pytest.raises(ResultsError, match="give results of a run or a sweep"):
        export(object(), tmp_path / "made", ["csv"])
    with pytest.raises(ResultsError, match="no quantity"):
        export(made, tmp_path / "made", ["csv"], "impedance")


def test_where_nothing_can_be_written_it_says_so(made, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ResultsError, match="cannot be written"):
        export(made, tmp_path / "file" / "made", ["csv"])


def test_xarray_opens_the_results_file_as_it_is(made, tmp_path):
    write_results(tmp_path / "made.h5", made)
    with xarray.open_dataset(tmp_path / "made.h5", engine="h5netcdf") as data:
        Y = data.mobility.sel(load="tangential", probe="sidewall")
        np.testing.assert_array_equal(Y, made.response("tangential", "sidewall"))
        np.testing.assert_array_equal(Y.frequency, made.frequency)
        assert (Y.attrs["units"], Y.frequency.attrs["units"]) == ("m/(s N)", "Hz")


def test_matlab_finds_doubles_r_and_i_in_the_results_file(made, tmp_path):
    """h5read gives a struct of the members of a compound, dimensions reversed, and texts."""
    write_results(tmp_path / "made.h5", made)
    with h5py.File(tmp_path / "made.h5") as file:
        stored = file["mobility"].id.get_type()
        assert [stored.get_member_name(k) for k in range(2)] == [b"r", b"i"]
        assert all(stored.get_member_type(k) == h5py.h5t.IEEE_F64LE for k in range(2))
        part = np.dtype([("r", "<f8"), ("i", "<f8")])
        raw = np.empty(file["mobility"].shape, part)
        file["mobility"].id.read(h5py.h5s.ALL, h5py.h5s.ALL, raw)
        np.testing.assert_array_equal(raw["r"] + 1j * raw["i"], made.mobility)
        assert file["probe"].id.get_type().is_variable_str()
