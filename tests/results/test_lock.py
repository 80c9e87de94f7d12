"""One run at a time writes a results file; the lock ends with its process, however that ends."""

from __future__ import annotations

import os
import platform
import subprocess
import sys

import pytest

from tyrefrf.errors import ResultsError
from tyrefrf.results.lock import InUseError, only_writer

HOLDING = """
import sys, time
from pathlib import Path
from tyrefrf.results.lock import only_writer
with only_writer(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60.0)
"""


@pytest.fixture
def target(tmp_path):
    return tmp_path / "tyre.h5"


@pytest.fixture
def holder(target):
    command = [sys.executable, "-c", HOLDING, str(target)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


def test_the_second_writer_is_told_who_the_first_is(target, holder):
    words = rf"tyre\.h5 is being written by process {holder.pid} on {platform.node()}, since 20"
    with pytest.raises(InUseError, match=words), only_writer(target):
        pytest.fail("two at once")


def test_a_killed_writer_holds_nothing(target, holder):
    holder.kill()
    holder.wait()
    with only_writer(target):
        pass


def test_the_lock_is_free_when_the_work_is_done(target):
    for _ in range(2):
        with only_writer(target):
            pass


def test_another_file_in_the_same_directory_is_another_matter(target, holder):
    with only_writer(target.with_name("other.h5")):
        pass


def test_where_nothing_can_be_written_it_says_so(tmp_path):
    (tmp_path / "taken").write_text("no directory")
    with (
        pytest.raises(
            ResultsError, match=r"taken: cannot be written: (Not a directory|File exists)"
        ),
        only_writer(tmp_path / "taken" / "tyre.h5"),
    ):
        pytest.fail("locked")


def test_a_lock_that_says_nothing_is_held_by_another_process(target, holder):
    lock = target.with_name(f".{target.name}.lock")
    os.truncate(lock, 0)
    with pytest.raises(InUseError, match="by another process"), only_writer(target):
        pytest.fail("two at once")
