"""What is no results file, or a damaged one, is refused with a reason."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
import synthetic
from hdf5 import changed

from tyrefrf.errors import ResultsError
from tyrefrf.results import Results, load_any, load_results, write_results
from tyrefrf.results.origin import LAYOUT


def number(file, name):
    file[name] = 1.0


def nothing(file, name):
    file[name] = np.zeros(0)


def words(file, name):
    file[name] = ["some", "words"]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    write_results(tmp_path / "made_up.h5", synthetic.results())
    return tmp_path / "made_up.h5"


def test_no_file(tmp_path):
    with pytest.raises(ResultsError, match=r"made_up\.h5: no such file"):
        load_results(tmp_path / "made_up.h5")


def test_not_hdf5(tmp_path):
    (tmp_path / "case.toml").write_text("title = 'tyre'\n", encoding="utf-8")
    with pytest.raises(ResultsError, match="not an HDF5 file"):
        load_results(tmp_path / "case.toml")


@pytest.mark.parametrize("share", [0.001, 0.1, 0.5, 0.99])
def test_truncated(path, share):
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(ResultsError, match="truncated or damaged"):
        load_results(path)


def test_a_flipped_bit_in_a_response(path):
    with h5py.File(path) as file:
        offset = file["receptance"].id.get_chunk_info(3).byte_offset
    damaged = bytearray(path.read_bytes())
    damaged[offset + 50] ^= 1
    path.write_bytes(damaged)
    with pytest.raises(ResultsError, match="truncated or damaged"):
        load_results(path)


def test_a_missing_dataset_is_named(path):
    with changed(path) as file:
        del file["residual"]
    with pytest.raises(ResultsError, match=r"damaged.*residual"):
        load_results(path)


def test_a_label_that_is_no_text(path):
    damaged = path.read_bytes().replace(b"sidewall", b"side\xff\xffll")
    path.write_bytes(damaged)
    with pytest.raises(ResultsError, match="truncated or damaged"):
        load_results(path)


@pytest.mark.parametrize("attributes", [{}, {"program": "another"}], ids=["none", "another"])
def test_hdf5_of_another_program(tmp_path, attributes):
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file.attrs.update(attributes)
    with pytest.raises(ResultsError, match=r"HDF5 of an.*expected results of tyrefrf"):
        load_results(tmp_path / "other.h5")


def test_a_newer_layout_says_what_to_do(path):
    with changed(path) as file:
        file.attrs["layout"] = LAYOUT + 1
        file.attrs["version"] = "3.0"
    with pytest.raises(
        ResultsError, match=rf"layout {LAYOUT + 1}.*tyrefrf 3\.0.*upgrade it with `pip"
    ):
        load_results(path)


def test_a_newer_layout_of_an_unknown_version_says_what_to_do(path):
    with changed(path) as file:
        file.attrs["layout"] = LAYOUT + 1
        del file.attrs["version"]
    with pytest.raises(ResultsError, match=r"unknown version.*upgrade it with `pip"):
        load_results(path)


@pytest.mark.parametrize(
    "layout",
    [None, "one", 1.0, 0, -1, [1, 1], h5py.Empty("i")],
    ids=["none", "text", "fraction", "zero", "negative", "several", "empty"],
)
def test_a_layout_that_is_none_is_named(path, layout):
    with changed(path) as file:
        del file.attrs["layout"]
        if layout is not None:
            file.attrs["layout"] = layout
    with pytest.raises(ResultsError, match=r"layout.*expected one from 1 to.*run the case again"):
        load_results(path)


@pytest.mark.parametrize(
    "content",
    ["dream", 1, [1.0, 2.0], h5py.Empty("f")],
    ids=["other", "number", "several", "empty"],
)
def test_an_unknown_content_says_what_to_do(path, content):
    with changed(path) as file:
        file.attrs["content"] = content
    with pytest.raises(ResultsError, match=r"holds .*, which this tyrefrf does not know: upgrade"):
        load_any(path)


def test_without_a_content_it_is_a_run(path):
    with changed(path) as file:
        del file.attrs["content"]
    assert load_results(path).provenance.case_name == "made_up"


@pytest.mark.parametrize("attribute", ["version", "created", "case_hash", "n_cells"])
def test_a_missing_attribute_is_named(path, attribute):
    with changed(path) as file:
        del file.attrs[attribute]
    with pytest.raises(ResultsError, match=rf"damaged.*{attribute}"):
        load_results(path)


@pytest.mark.parametrize(
    "damage",
    [lambda file, name: None, h5py.File.create_group, number, nothing, words],
    ids=["gone", "a group", "a number", "nothing", "words"],
)
def test_whatever_is_damaged_is_refused_or_not_needed(path, damage):
    with h5py.File(path) as file:
        names = list(file)
    whole = path.read_bytes()
    outcomes = {outcome(path, whole, name, damage) for name in names}
    assert ResultsError in outcomes
    assert outcomes <= {ResultsError, Results}


def outcome(path, whole, name, damage):
    """What comes of a file whose `name` is something else: results, or which error."""
    path.write_bytes(whole)
    with changed(path) as file:
        del file[name]
        damage(file, name)
    try:
        return type(load_any(path))
    except Exception as error:
        return type(error)
