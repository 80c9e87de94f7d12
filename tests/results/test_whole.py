"""A results file appears whole or not at all, and never silently replaces a good one."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import synthetic

from tyrefrf.errors import ResultsError
from tyrefrf.results import load_results, write_results
from tyrefrf.results.whole import whole_file

KILLED_WHILE_WRITING = """
import os, signal, sys
from pathlib import Path
from tyrefrf.results.whole import whole_file
with whole_file(Path(sys.argv[1])) as temporary:
    temporary.write_bytes(b"half a file")
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_killed_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "made_up.h5"
    path.write_bytes(b"the old file")
    command = [sys.executable, "-c", KILLED_WHILE_WRITING, str(path)]
    killed = subprocess.run(command, check=False, cwd=Path(__file__).parents[2])
    assert killed.returncode == -9
    assert path.read_bytes() == b"the old file"


def test_an_exception_leaves_nothing(tmp_path):
    def interrupted():
        with whole_file(tmp_path / "made_up.h5") as temporary:
            temporary.write_bytes(b"half a file")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == []


def test_what_hdf5_cannot_hold_leaves_nothing(tmp_path):
    made = synthetic.results()
    bad = replace(made, provenance=replace(made.provenance, numbers={"dofs": object()}))
    with pytest.raises(TypeError):
        write_results(tmp_path / "made_up.h5", bad)
    assert list(tmp_path.iterdir()) == []


def test_writing_again_replaces(tmp_path):
    path = tmp_path / "made_up.h5"
    write_results(path, synthetic.results())
    write_results(path, synthetic.with_failed(synthetic.results(), 3))
    assert load_results(path).n_failed == 1
    assert list(tmp_path.iterdir()) == [path]


def test_who_reads_the_old_file_is_not_disturbed(tmp_path):
    path = tmp_path / "made_up.h5"
    path.write_bytes(b"the old file")
    with path.open("rb") as reader:
        write_results(path, synthetic.results())
        assert reader.read() == b"the old file"


def test_a_missing_directory_is_a_clear_error(tmp_path):
    with pytest.raises(ResultsError, match=r"made_up\.h5: cannot be written"):
        write_results(tmp_path / "nowhere" / "made_up.h5", synthetic.results())
