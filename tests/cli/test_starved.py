"""Where the machine has no room left: one message, status 1, and what stood before still stands."""

from __future__ import annotations

import os
import resource
import subprocess

import pytest
from command import tyrefrf_command
from small import TEXT, text_with

from tyrefrf.results import load_results
from tyrefrf.results.left import read_journal

LINES = text_with(("values = [0.0, 40.0, 150.0, 420.0]", "stop = 420.0\ncount = 301"))


@pytest.fixture
def here(tmp_path):
    (tmp_path / "small.toml").write_text(LINES)
    return tmp_path


def limited(what, size):
    """Started so that the process may have so much of something."""
    return {"preexec_fn": lambda: resource.setrlimit(what, (size, size))}


def files_up_to(size):
    """Started so that no file may be larger, which a writer is told as on a full disk."""
    return limited(resource.RLIMIT_FSIZE, size)


def assert_one_message(done, *words):
    assert done.returncode == 1, done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    lines = [line for line in done.stderr.splitlines() if "lines/s" not in line]
    assert len(lines) <= 2, done.stderr
    for word in words:
        assert word in done.stderr


def names(directory):
    return sorted(path.name for path in directory.iterdir())


def test_no_room_for_the_first_line(here):
    done = tyrefrf_command("run", "small.toml", "--output", "o", cwd=here, **files_up_to(10_000))
    assert_one_message(done, "o/small.journal: cannot be written: File too large")
    assert names(here / "o") == [".small.h5.lock"]


def test_no_room_for_the_last_lines(here):
    whole = tyrefrf_command("run", "small.toml", "--output", "whole", cwd=here)
    assert whole.returncode == 0
    expected = load_results(here / "whole/small.h5")
    done = tyrefrf_command(
        "run", "small.toml", "--output", "o", "--jobs", 1, cwd=here, **files_up_to(150_000)
    )
    assert_one_message(done, "o/small.journal: cannot be written: File too large", "of 301 lines")
    left = read_journal(here / "o/small.journal")
    assert 0 < left.n_there < 301
    assert names(here / "o") == [".small.h5.lock", "small.journal"]
    resumed = tyrefrf_command("run", "small.toml", "--output", "o", "--resume", cwd=here)
    assert resumed.returncode == 0
    for name in ("mobility", "residual"):
        found = getattr(load_results(here / "o/small.h5"), name)
        assert (found == getattr(expected, name)).all()


def test_no_room_for_plots_leaves_the_results(here):
    (here / "small.toml").write_text(TEXT)
    done = tyrefrf_command(
        "run", "small.toml", "--output", "o", "--jobs", 1, cwd=here, **files_up_to(130_000)
    )
    assert_one_message(done, "plots/", ".png: cannot be written: File too large")
    assert "o/small.h5 is complete; tyrefrf plot o/small.h5 draws it again" in done.stderr
    assert load_results(here / "o/small.h5").n_missing == 0


def test_what_stood_before_is_not_touched(here):
    (here / "small.toml").write_text(TEXT)
    assert tyrefrf_command("run", "small.toml", "--output", "o", cwd=here).returncode == 0
    before = {path: path.read_bytes() for path in (here / "o").rglob("*.*") if path.is_file()}
    done = tyrefrf_command(
        "run", "small.toml", "--output", "o", "--force", cwd=here, **files_up_to(20_000)
    )
    assert_one_message(done, "cannot be written: File too large")
    lock = here / "o/.small.h5.lock"
    assert {path: path.read_bytes() for path in before if path != lock} == {
        path: content for path, content in before.items() if path != lock
    }


def test_too_few_file_handles_are_told_of_before_anything_starts(here):
    done = tyrefrf_command(
        "run", "small.toml", "--jobs", 2, cwd=here, **limited(resource.RLIMIT_NOFILE, 20)
    )
    assert_one_message(done, "2 processes need", "open files, and 20 are allowed", "ulimit -n")
    one = tyrefrf_command(
        "run", "small.toml", "--jobs", 1, cwd=here, **limited(resource.RLIMIT_NOFILE, 20)
    )
    assert one.returncode == 0


@pytest.fixture
def disk(tmp_path):
    """A function that gives a directory on a disk of its own of so many bytes."""
    mounted = []

    def mount(size):
        directory = tmp_path / f"disk{len(mounted)}"
        directory.mkdir()
        done = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", directory],
            capture_output=True,
            check=False,
        )
        if done.returncode:
            pytest.skip("no permission to mount a disk of a given size")
        mounted.append(directory)
        return directory

    yield mount
    for directory in mounted:
        subprocess.run(["umount", directory], check=True)


@pytest.mark.parametrize(
    ("size", "words"),
    [(20_000, "small.journal"), (120_000, "small.journal"), (230_000, "small.h5")],
)
def test_a_full_disk_is_one_message(here, disk, size, words):
    output = disk(size) / "o"
    done = tyrefrf_command("run", "small.toml", "--output", output, "--jobs", 1, cwd=here)
    assert_one_message(done, f"{output}/{words}: cannot be written: No space left on device")
    assert not (output / "small.h5").exists()


def test_a_full_directory_for_temporary_files_is_named(here, disk):
    full = disk(8192)
    environment = os.environ | {"TMPDIR": str(full)}
    done = tyrefrf_command("run", "small.toml", "--jobs", 2, cwd=here, env=environment)
    assert_one_message(done, f"{full}/tyrefrf-", "TMPDIR names another directory")


def test_a_read_only_disk_is_one_message(here, disk):
    directory = disk(1_000_000)
    subprocess.run(["mount", "-o", "remount,ro", directory], check=True)
    done = tyrefrf_command("run", "small.toml", "--output", directory / "o", cwd=here)
    assert_one_message(done, "cannot be made: Read-only file system", "--output DIR")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_directory_that_may_not_be_written_is_one_message(here):
    (here / "o").mkdir(mode=0o555)
    done = tyrefrf_command("run", "small.toml", "--output", "o", cwd=here)
    assert_one_message(done, "o: cannot be written: Permission denied")
