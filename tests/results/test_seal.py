"""A damaged file gives the results that were written, or is refused: never others, never a crash.

Every truncation and every byte that changes shows in the digest that stands in front of HDF5's
own content. Files without one, of older versions, are at least refused in words.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import synthetic

from tyrefrf.errors import ResultsError
from tyrefrf.results import Results, load_any, write_results
from tyrefrf.results.seal import BLOCK, WORDS

LINES = np.linspace(0.0, 100.0, 11)
ARRAYS = ("frequency", "receptance", "blocked_force", "solved", "residual", "solve_time")


@pytest.fixture(scope="module")
def made() -> Results:
    return synthetic.results(LINES)


@pytest.fixture(scope="module")
def whole(made: Results, tmp_path_factory) -> bytes:
    path = tmp_path_factory.mktemp("whole") / "made_up.h5"
    write_results(path, made)
    return path.read_bytes()


def is_refused(path: Path, content: bytes) -> bool:
    path.write_bytes(content)
    try:
        load_any(path)
    except ResultsError:
        return True
    return False


def equal(found: Results, made: Results) -> bool:
    arrays = (
        np.array_equal(getattr(found, name), getattr(made, name), equal_nan=True) for name in ARRAYS
    )
    rest = ("loads", "probes", "remark", "provenance")
    return all(arrays) and all(getattr(found, name) == getattr(made, name) for name in rest)


def test_it_says_in_front_what_it_is(whole):
    assert whole.startswith(WORDS.encode())
    assert whole[BLOCK : BLOCK + 8] == b"\x89HDF\r\n\x1a\n"


def test_truncated_anywhere_it_is_refused(whole, tmp_path):
    for size in np.linspace(0, len(whole) - 1, 200).astype(int):
        assert is_refused(tmp_path / "cut.h5", whole[:size]), size


def test_longer_than_it_was_it_is_refused(whole, tmp_path):
    assert is_refused(tmp_path / "long.h5", whole + b"\0")


def test_with_any_one_byte_changed_it_is_refused_or_as_it_was(whole, made, tmp_path):
    rng = np.random.default_rng(0)
    for at in [*range(0, 200, 10), *rng.integers(len(whole), size=300)]:
        damaged = bytearray(whole)
        damaged[at] ^= 1 << rng.integers(8)
        if not is_refused(tmp_path / "damaged.h5", bytes(damaged)):
            assert equal(load_any(tmp_path / "damaged.h5"), made), at


DAMAGE = """\
import sys, numpy as np
from pathlib import Path
from tyrefrf.errors import ResultsError
from tyrefrf.results import load_any
whole, rng, path = Path(sys.argv[1]).read_bytes(), np.random.default_rng(1), Path(sys.argv[2])
refused = 0
for at in rng.integers(512, len(whole), size=300):
    damaged = bytearray(whole)
    damaged[at] = rng.integers(256)
    path.write_bytes(damaged)
    try:
        load_any(path)
    except ResultsError:
        refused += 1
print(refused)
"""


def test_without_a_seal_damage_raises_nothing_else(whole, tmp_path):
    """In a process of its own, as HDF5 itself may crash."""
    (tmp_path / "old.h5").write_bytes(bytes(BLOCK) + whole[BLOCK:])
    files = [str(tmp_path / name) for name in ("old.h5", "damaged.h5")]
    done = subprocess.run(
        [sys.executable, "-c", DAMAGE, *files], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 10


def test_a_file_of_before_the_seal_is_read(whole, made, tmp_path):
    (tmp_path / "old.h5").write_bytes(whole[BLOCK:])
    with h5py.File(tmp_path / "old.h5", "r") as file:
        assert file.attrs["program"] == "tyrefrf"
    assert equal(load_any(tmp_path / "old.h5"), made)


def test_what_another_program_changed_is_refused(whole, tmp_path):
    path = tmp_path / "changed.h5"
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        file.attrs["case_name"] = "another"
    with pytest.raises(ResultsError, match=r"changed by another program.*run the case again"):
        load_any(path)


def test_an_attribute_of_megabytes_in_a_file_without_a_seal_is_read_or_refused(whole, tmp_path):
    path = tmp_path / "huge.h5"
    path.write_bytes(bytes(BLOCK) + whole[BLOCK:])
    with h5py.File(path, "r+") as file:
        file.attrs["title"] = "x" * 30_000_000
    assert len(load_any(path).provenance.title) == 30_000_000
    with h5py.File(path, "r+") as file:
        file.attrs["layout"] = "one"
    with pytest.raises(ResultsError, match="damaged, or changed"):
        load_any(path)
