"""Measured files and sensors in a case: what is accepted, what is said, and what is hashed."""

from __future__ import annotations

import pickle

import pytest
from small import TEXT, text_with

from tyrefrf.case import (
    MeasuredFile,
    build_case,
    case_hash,
    load_case,
    make_grid,
    parse_case,
    resolved,
    resolved_toml,
)
from tyrefrf.errors import CaseError

CSV = """
[[measured]]
file = "lab.csv"
load = "radial"
probe = "sidewall"
quantity = "mobility"
"""
TWO_FILES = """
[[measured]]
file = "bench/tread.uff"
response = { node = 12, direction = "-z" }
load = "radial"
probe = "sidewall"
scale = -1.0

[[measured]]
file = "bench/drive.csv"
columns = { frequency = 1, level = 2, phase = 3 }
quantity = "accelerance"
load = "radial"
probe = "radial.drive"
"""
FIRST = TEXT.count("\n") + 2  # the line of [[measured]]


def messages(text):
    with pytest.raises(CaseError) as caught:
        parse_case(text, "t.toml", "small")
    return [line.removeprefix("t.toml:") for line in str(caught.value).splitlines()]


CHANGES = {
    "unknown load": (
        'load = "radial"',
        'load = "radiall"',
        f"{FIRST + 2}: measured[0].load: no load 'radiall' in this case; did you mean 'radial'?",
    ),
    "unknown probe": (
        'probe = "sidewall"',
        'probe = "x"',
        f"{FIRST + 3}: measured[0].probe: no probe 'x' in this case; there are radial.drive, "
        "patch.drive, sidewall",
    ),
    "the hub": (
        'probe = "sidewall"',
        'probe = "hub"',
        f"{FIRST + 3}: measured[0].probe: no probe 'hub' in this case; there are radial.drive, "
        "patch.drive, sidewall",
    ),
    "no quantity": (
        'quantity = "mobility"\n',
        "",
        f"{FIRST}: measured[0]: has no quantity, which a CSV file does not say; give receptance, "
        "mobility or accelerance",
    ),
    "unknown quantity": (
        '"mobility"',
        '"accelerence"',
        f"{FIRST + 4}: measured[0].quantity: 'accelerence' is not one of receptance, mobility, "
        "accelerance; did you mean 'accelerance'?",
    ),
    "a record of a CSV": (
        'quantity = "mobility"',
        'quantity = "mobility"\nrecord = 2',
        f"{FIRST + 5}: measured[0].record: belongs to UFF files; this one is a CSV",
    ),
    "columns of a UFF": (
        '"lab.csv"',
        '"lab.unv"\ncolumns = { real = 2, imag = 3 }',
        f"{FIRST + 2}: measured[0].columns: belongs to CSV files; this one is a UFF",
    ),
    "two choices of a UFF": (
        '"lab.csv"',
        '"lab.uff"\nrecord = 1\nresponse = { node = 1, direction = "x" }',
        f"{FIRST + 2}: measured[0].record: not together with response or reference",
    ),
    "half a response": (
        '"lab.csv"',
        '"lab.csv"\ncolumns = { real = 2, phase = 3 }',
        f"{FIRST + 2}: measured[0].columns: has phase, real; give real and imag, magnitude and "
        "phase, or level and phase",
    ),
    "a column twice": (
        '"lab.csv"',
        '"lab.csv"\ncolumns = { real = 2, imag = 2 }',
        f"{FIRST + 2}: measured[0].columns: names a column twice; each part of a response has its "
        "own",
    ),
    "column 0": (
        '"lab.csv"',
        '"lab.csv"\ncolumns = { real = 0, imag = 2 }',
        f"{FIRST + 2}: measured[0].columns.real: 0 is out of range; must be from 1 to 10000",
    ),
    "no column": (
        '"lab.csv"',
        '"lab.csv"\ncolumns = { real = 1.5, imag = 2 }',
        f"{FIRST + 2}: measured[0].columns.real: 1.5 is not a column's number or name",
    ),
    "no scale": (
        'quantity = "mobility"',
        'quantity = "mobility"\nscale = 0.0',
        f"{FIRST + 5}: measured[0].scale: 0 leaves nothing of the response",
    ),
}


@pytest.mark.parametrize(("old", "new", "expected"), CHANGES.values(), ids=CHANGES)
def test_what_is_wrong_is_said(old, new, expected):
    assert CSV.count(old) == 1
    assert messages(TEXT + CSV.replace(old, new)) == [expected]


@pytest.mark.parametrize(
    ("mass", "words"),
    [
        ('"5 gr"', "unknown unit 'gr'; use one of kg, g, mg; did you mean 'g'?"),
        ("0.0", "0.0 kg is out of range; must be at least 1e-12 kg"),
    ],
)
def test_a_wrong_mass_is_said(mass, words):
    text = text_with(('name = "sidewall"\n', f'name = "sidewall"\nsensor_mass = {mass}\n'))
    assert messages(text) == [f"35: probes[0].sensor_mass: {words}"]


def test_a_mass_is_in_kilograms():
    text = text_with(('name = "sidewall"\n', 'name = "sidewall"\nsensor_mass = "5 g"\n'))
    assert parse_case(text, "t.toml", "t").probes[0].sensor_mass == 0.005


@pytest.mark.parametrize(
    ("keys", "label"),
    [
        ({"file": "bench/run 7.uff"}, "run 7"),
        ({"file": "run.unv", "record": 3}, "run #3"),
        ({"file": "run.uff", "response": {"node": 7, "direction": "-y"}}, "run 7 -y"),
        ({"file": "run.csv", "quantity": "mobility", "name": "tread"}, "tread"),
    ],
)
def test_a_curve_has_a_name(keys, label):
    assert MeasuredFile.model_validate({"load": "a", "probe": "b"} | keys).label == label


def test_what_the_files_are_follows_from_their_names_and_keys():
    uff, csv = parse_case(TEXT + TWO_FILES, "t.toml", "small").measured
    assert (uff.is_uff, uff.response.code, uff.scale) == (True, -3, -1.0)
    assert csv.columns.parts == ("level", "phase")


# files that a case names


@pytest.fixture
def path(tmp_path):
    (tmp_path / "lab.csv").write_text("1,2,3\n")
    (tmp_path / "small.toml").write_text(TEXT + CSV)
    return tmp_path / "small.toml"


def test_the_directory_of_a_case_is_that_of_its_file_and_no_data(path):
    case = load_case(path)
    assert case.directory == path.parent
    assert "directory" not in resolved_toml(case)
    assert build_case(resolved(case), "small").directory.as_posix() == "."


def test_copies_points_of_a_sweep_and_other_processes_know_the_directory(path):
    case = load_case(path)
    grid = make_grid(case, {"E_rubber": (1e6, 2e6)})
    copies = [case.model_copy(update={"title": "x"}), *grid.cases, pickle.loads(pickle.dumps(case))]
    assert {copy.directory for copy in copies} == {path.parent}


def test_a_hash_depends_on_the_content_of_files_and_not_on_where_they_are(path, tmp_path):
    first = case_hash(load_case(path))
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    for file in (path, path.parent / "lab.csv"):
        (elsewhere / file.name).write_bytes(file.read_bytes())
    assert case_hash(load_case(elsewhere / path.name)) == first
    (path.parent / "lab.csv").write_text("1,2,4\n")
    assert case_hash(load_case(path)) != first


def test_a_file_that_is_missing_has_no_hash(path):
    (path.parent / "lab.csv").unlink()
    with pytest.raises(CaseError, match=r"measured\[0\]\.file: .*lab\.csv cannot be read: No such"):
        case_hash(load_case(path))
