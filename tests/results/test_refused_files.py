"""What is no results file, or a damaged one, is refused with a reason."""

from __future__ import annotations

from pathlib import Path

import h5py
import pytest
import synthetic

from tyrefrf.errors import ResultsError
from tyrefrf.results import load_results, write_results


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
    with h5py.File(path, "r+") as file:
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
    with h5py.File(path, "r+") as file:
        file.attrs["layout"] = 2
        file.attrs["version"] = "3.0"
    with pytest.raises(ResultsError, match=r"layout 2.*tyrefrf 3\.0.*upgrade"):
        load_results(path)
