"""A run that is ended, by whatever signal, loses no line, and can be gone on with."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress

import numpy as np
import pytest
from command import tyrefrf_command
from killed import PATIENCE, ended, heeding, started, wait_for_lines, workers_of
from small import TEXT, text_with

import tyrefrf
from tyrefrf.results import load_results, load_sweep
from tyrefrf.results.left import read_journal

fcntl, pty, termios = (pytest.importorskip(name) for name in ("fcntl", "pty", "termios"))

N_LINES = 1201
LONG = text_with(("values = [0.0, 40.0, 150.0, 420.0]", f"stop = 420.0\ncount = {N_LINES}"))
SWEEP = ("--param", "E_rubber", "--values", "40,80 MPa")
SAME = ("frequency", "mobility", "residual")


@pytest.fixture
def here(tmp_path):
    (tmp_path / "long.toml").write_text(LONG)
    return tmp_path


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The results of a run that nobody ended."""
    path = tmp_path_factory.mktemp("whole") / "long.toml"
    path.write_text(LONG)
    return tyrefrf.run(path)


def assert_same_digits(path, expected):
    results = load_results(path)
    for name in SAME:
        np.testing.assert_array_equal(getattr(results, name), getattr(expected, name))
    assert not results.n_missing


def test_a_run_killed_twice_is_shown_and_gone_on_with(here, whole):
    target, journal = here / "results/long/long.h5", here / "results/long/long.journal"
    with started("run", "long.toml", cwd=here) as process:
        wait_for_lines(journal, 100, process)
        status, _, _ = ended(process, signal.SIGKILL)
    assert status == -signal.SIGKILL
    assert not target.exists()
    n_there = len(read_journal(journal).lines)
    told = tyrefrf_command("info", target, cwd=here)
    assert told.returncode == 0
    assert f"MISSING   {N_LINES - n_there} lines, not solved yet" in told.stdout
    drawn = tyrefrf_command("plot", target, cwd=here)
    assert drawn.returncode == 0, drawn.stderr
    assert (here / "results/long/plots/mobility_radial.png").exists()

    refused = tyrefrf_command("run", "long.toml", cwd=here)
    assert refused.returncode == 2
    assert f"long.journal holds {n_there} of {N_LINES} lines of a run that" in refused.stderr

    with started("run", "long.toml", "--resume", cwd=here) as process:
        wait_for_lines(journal, n_there + 100, process)
        ended(process, signal.SIGKILL)
    n_there = len(read_journal(journal).lines)
    done = tyrefrf_command("run", "long.toml", "--resume", "--json", cwd=here)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["resumed_lines"] == n_there
    assert_same_digits(target, whole)
    assert not journal.exists()

    again = tyrefrf_command("run", "long.toml", "--resume", cwd=here)
    assert again.returncode == 0
    assert "lines/s" not in again.stderr  # nothing was solved


@pytest.mark.parametrize(("number", "status"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_an_orderly_end_writes_what_there_is(here, whole, number, status):
    target, journal = here / "out/long.h5", here / "out/long.journal"
    with started("run", "long.toml", "--output", "out", cwd=here) as process:
        wait_for_lines(journal, 50, process)
        found, out, err = ended(process, number)
    assert found == status
    assert out == ""
    said = re.search(r"interrupted by (\w+): out/long.h5 holds (\d+) of 1201 lines; --resume", err)
    assert said[1] == number.name
    results = load_results(target)
    assert (~results.missing).sum() == int(said[2]) >= 50
    there = ~results.missing
    np.testing.assert_array_equal(results.mobility[..., there], whole.mobility[..., there])
    exported = tyrefrf_command("export", "out/long.h5", "--to", "csv", cwd=here)
    assert exported.returncode == 0
    assert "lines are not solved yet: they are NaN" in exported.stderr
    refused = tyrefrf_command("run", "long.toml", "--output", "out", cwd=here)
    assert refused.returncode == 2
    assert "out/long.h5 exists; --resume computes what it lacks" in refused.stderr
    assert (
        tyrefrf_command("run", "long.toml", "--output", "out", "--resume", cwd=here).returncode == 0
    )
    assert_same_digits(target, whole)


def test_a_complete_file_survives_the_end_of_its_replacement(here):
    (here / "long.toml").write_text(TEXT)
    assert tyrefrf_command("run", "long.toml", cwd=here).returncode == 0
    target, journal = here / "results/long/long.h5", here / "results/long/long.journal"
    before = target.read_bytes()
    (here / "long.toml").write_text(LONG)
    with started("run", "long.toml", "--force", cwd=here) as process:
        wait_for_lines(journal, 20, process)
        status, _, err = ended(process, signal.SIGTERM)
    assert status == 143
    assert re.search(r"long.journal holds \d+ of 1201 lines; --resume computes the rest", err)
    assert target.read_bytes() == before


def test_before_the_first_line_nothing_is_left_but_the_lock(here):
    with started("run", "long.toml", cwd=here) as process:
        while not (here / "results/long/.long.h5.lock").exists():
            assert process.poll() is None
        status, _, err = ended(process, signal.SIGTERM)
    assert status == 143
    assert err.startswith("interrupted by SIGTERM")
    assert [path.name for path in (here / "results/long").iterdir()] == [".long.h5.lock"]


def test_what_was_told_to_ignore_hangups_goes_on(here):
    (here / "long.toml").write_text(TEXT)
    ignoring = {"preexec_fn": lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)}
    with started("run", "long.toml", cwd=here, **ignoring) as process:
        while not (here / "results/long/.long.h5.lock").exists():
            assert process.poll() is None
        status, _, err = ended(process, signal.SIGHUP)
    assert status == 0, err


def test_a_second_run_to_the_same_output_is_refused(here):
    with started("run", "long.toml", cwd=here) as process:
        wait_for_lines(here / "results/long/long.journal", 1, process)
        for more in ("--resume", "--force"):
            refused = tyrefrf_command("run", "long.toml", more, cwd=here)
            assert refused.returncode == 2
            assert f"long.h5 is being written by process {process.pid} on" in refused.stderr
        assert process.poll() is None


def test_a_worker_that_is_killed_is_replaced(here, whole):
    with started("run", "long.toml", "--jobs", 2, cwd=here) as process:
        wait_for_lines(here / "results/long/long.journal", 20, process)
        os.kill(workers_of(process.pid)[0], signal.SIGKILL)
        _, err = process.communicate()
    assert process.returncode == 0, err
    assert_same_digits(here / "results/long/long.h5", whole)


def test_workers_end_with_the_run_that_is_killed(here):
    with started("run", "long.toml", "--jobs", 2, cwd=here) as process:
        wait_for_lines(here / "results/long/long.journal", 1, process)
        workers = workers_of(process.pid)
        ended(process, signal.SIGKILL)
    assert len(workers) == 2
    until = time.monotonic() + PATIENCE
    while any(map(is_alive, workers)):
        assert time.monotonic() < until


def is_alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_a_changed_case_is_refused_and_the_change_shown(here):
    (here / "long.toml").write_text(TEXT)
    assert tyrefrf_command("run", "long.toml", cwd=here).returncode == 0
    (here / "long.toml").write_text(text_with(("rho = 1200.0", "rho = 1100.0")))
    refused = tyrefrf_command("run", "long.toml", "--resume", cwd=here)
    assert refused.returncode == 2
    assert "long.h5: begun with another case:" in refused.stderr
    assert "  materials.rubber.rho: 1200.0 -> 1100.0" in refused.stderr


def test_a_sweep_is_gone_on_with_too(here):
    target, journal = (here / f"results/long_sweep/long_sweep.{end}" for end in ("h5", "journal"))
    with started("sweep", "long.toml", *SWEEP, cwd=here) as process:
        wait_for_lines(journal, 100, process)
        ended(process, signal.SIGKILL)
    told = tyrefrf_command("info", target, cwd=here)
    assert re.search(r"MISSING +\d+ lines, not solved yet", told.stdout)
    other = tyrefrf_command("sweep", "long.toml", *SWEEP[:3], "40,90 MPa", "--resume", cwd=here)
    assert other.returncode == 2
    assert "E_rubber = 40 MPa, 80 MPa -> E_rubber = 40 MPa, 90 MPa" in other.stderr
    done = tyrefrf_command("sweep", "long.toml", *SWEEP, "--resume", cwd=here)
    assert done.returncode == 0, done.stderr
    assert re.search(r"resumed +\d+ lines were there", done.stdout)
    whole = tyrefrf.sweep(here / "long.toml", {"E_rubber": [40e6, 80e6]})
    for point, expected in zip(load_sweep(target).points, whole.points, strict=True):
        for name in SAME:
            np.testing.assert_array_equal(getattr(point, name), getattr(expected, name))


def test_resume_and_force_exclude_each_other(here):
    refused = tyrefrf_command("run", "long.toml", "--resume", "--force", cwd=here)
    assert refused.returncode == 2
    assert "give one" in refused.stderr


def test_resume_begins_where_nothing_is_there(here):
    (here / "long.toml").write_text(TEXT)
    done = tyrefrf_command("run", "long.toml", "--resume", cwd=here)
    assert done.returncode == 0
    assert "resumed" not in done.stdout


def test_a_run_under_way_is_no_run_that_was_ended(here):
    with started("run", "long.toml", cwd=here) as process:
        wait_for_lines(here / "results/long/long.journal", 1, process)
        refused = tyrefrf_command("run", "long.toml", cwd=here)
    assert refused.returncode == 2
    assert f"long.h5 is being written by process {process.pid} on" in refused.stderr


def test_an_adaptive_case_is_gone_on_with_where_all_lines_were_there(here):
    adaptive = text_with(
        ("[0.0, 40.0, 150.0, 420.0]", "[0.0, 40.0, 150.0, 420.0]\nadaptive = true")
    )
    (here / "long.toml").write_text(adaptive)
    first = tyrefrf.run(here / "long.toml", jobs=1, journal=here / "results/long/long.journal")
    done = tyrefrf_command("run", "long.toml", "--resume", "--jobs", 1, cwd=here)
    assert done.returncode == 0, done.stderr
    assert_same_digits(here / "results/long/long.h5", first)


def test_other_results_outlast_the_end_of_their_replacement(here):
    target, journal = here / "results/long/long.h5", here / "results/long/long.journal"
    with started("run", "long.toml", cwd=here) as process:
        wait_for_lines(journal, 100, process)
        ended(process, signal.SIGTERM)
    before = target.read_bytes()
    journal.unlink()
    (here / "long.toml").write_text(LONG.replace("80 MPa", "90 MPa"))
    with started("run", "long.toml", "--force", cwd=here) as process:
        wait_for_lines(journal, 5, process)
        _, _, err = ended(process, signal.SIGTERM)
    assert re.search(r"long.journal holds \d+ of 1201 lines; --resume computes the rest", err)
    assert target.read_bytes() == before


def test_stderr_that_takes_nothing_ends_nothing(here):
    (here / "long.toml").write_text(TEXT)
    for k, redirection in enumerate(("2>&-", "2>/dev/full")):
        command = [sys.executable, "-m", "tyrefrf", "run", "long.toml", "--output", f"o{k}"]
        shell = ["sh", "-c", f'"$@" {redirection}', "sh", *command]
        done = subprocess.run(shell, cwd=here, capture_output=True, text=True, check=False)
        assert done.returncode == 0
        assert done.stdout.startswith("Small tyre\n")
        assert not load_results(here / f"o{k}/long.h5").n_missing


def test_a_terminal_that_is_closed_ends_the_run_in_order(here):
    ours, theirs = pty.openpty()
    target = here / "results/long"
    with subprocess.Popen(
        [sys.executable, "-m", "tyrefrf", "run", "long.toml", "--jobs", "2"],
        cwd=here,
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        start_new_session=True,
        preexec_fn=lambda: (heeding(), fcntl.ioctl(0, termios.TIOCSCTTY, 0)),
    ) as process:
        os.close(theirs)
        threading.Thread(target=drain, args=(ours,), daemon=True).start()
        wait_for_lines(target / "long.journal", 20, process)
        os.killpg(process.pid, signal.SIGHUP)
        assert process.wait(PATIENCE) == 128 + signal.SIGHUP
    assert load_results(target / "long.h5").n_missing
    os.close(ours)


def drain(terminal):
    with suppress(OSError):
        while os.read(terminal, 10_000):
            pass


def test_a_group_that_is_hung_up_on_says_one_thing(here):
    with started("run", "long.toml", "--jobs", 2, cwd=here, start_new_session=True) as process:
        wait_for_lines(here / "results/long/long.journal", 20, process)
        os.killpg(process.pid, signal.SIGHUP)
        _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 128 + signal.SIGHUP
    assert "Traceback" not in err
    assert "interrupted by SIGHUP: " in err
