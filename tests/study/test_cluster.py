"""A real cluster of two workers, one of which is killed on the way."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from functools import partial

import deadly
import numpy as np
import pytest
from deadly import reason_of, tasks_of
from small import TEXT, case_with

from tyrefrf.case import make_grid
from tyrefrf.cli.main import main
from tyrefrf.errors import CommandError
from tyrefrf.study import cluster as cluster_module
from tyrefrf.study import spectrum
from tyrefrf.study.cluster import cluster
from tyrefrf.study.executor import Task, map_unordered
from tyrefrf.study.run import run_case
from tyrefrf.study.sweep import run_sweep

dask = pytest.importorskip("dask", reason="NO CLUSTER IS TESTED: pip install '.[test]'")
distributed = pytest.importorskip(
    "distributed", reason="NO CLUSTER IS TESTED: pip install '.[test]'"
)

N = 12
SQUARES = [n**2 for n in range(N)]
DEATHS = 2  # workers that an item may kill before the scheduler says KilledWorker


@pytest.fixture(scope="module")
def address():
    """A scheduler with two workers, each restarted by its nanny when it dies."""
    settings = {
        "distributed.scheduler.allowed-failures": DEATHS - 1,
        "distributed.comm.timeouts.connect": "10s",  # to a dead worker, for its last answer; 30 s
        "logging.distributed": "error",
    }
    with (
        dask.config.set(settings),
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as local,
    ):
        yield local.scheduler_address


@pytest.fixture
def workers(address):
    with cluster(address) as found:
        yield found


@pytest.fixture(scope="module")
def alone():
    return run_case(case_with(), jobs=1)


@pytest.fixture
def notes(tmp_path):
    (tmp_path / "notes").mkdir()
    return tmp_path / "notes"


def test_a_run_has_the_same_bits(workers, alone):
    results = run_case(case_with(), jobs=workers)
    assert workers.jobs == 2
    np.testing.assert_array_equal(results.receptance, alone.receptance)
    np.testing.assert_array_equal(results.residual, alone.residual)


def test_a_sweep_has_the_same_bits(workers):
    grid = make_grid(case_with(), {"E_rubber": (40e6, 70e6), "sector_angle": (24.0, 36.0)})
    here, there = (run_sweep(grid, jobs=jobs) for jobs in (1, workers))
    for one, other in zip(here.points, there.points, strict=True):
        np.testing.assert_array_equal(one.receptance, other.receptance)


def test_a_worker_makes_once_for_batch_after_batch(workers, notes):
    make = deadly.Making(np.arange(100.0), notes)
    for first in (0, 15):
        tasks = (Task(make, n) for n in range(first, first + 15))
        assert len(list(map_unordered(tasks, workers, reason_of))) == 15
    times = [note.name.split("-")[0] for note in notes.iterdir()]
    assert len(times) == len(set(times))


def test_a_maker_that_is_fetched_again_has_made_already(notes):
    for token in ("one", "one", "other"):
        make = deadly.Making(np.arange(3.0), notes)
        cluster_module._call(cluster_module.Sent(token, make), 1)
    assert len(list(notes.iterdir())) == 2


def test_workers_use_one_blas_thread(workers):
    assert set().union(*map_unordered(tasks_of(deadly.blas_threads, 4), workers, reason_of)) == {1}


def test_no_more_is_submitted_than_keeps_the_workers_busy(workers):
    taken, most = [], 0
    make = partial(partial, deadly.slow_square)
    tasks = (taken.append(item) or Task(make, item) for item in range(N))
    for n_results, _ in enumerate(map_unordered(tasks, workers, reason_of)):
        most = max(most, len(taken) - n_results)
    assert most == 4


def test_an_error_of_its_own_ends_the_work(workers):
    with pytest.raises(ValueError, match="three has no square"):
        list(map_unordered(tasks_of(deadly.no_square, N), workers, reason_of))


@pytest.mark.parametrize("command", [["run"], ["sweep", "--param", "E_rubber=40e6,80e6"]])
def test_the_command_line_takes_a_scheduler(address, tmp_path, monkeypatch, capsys, command):
    (tmp_path / "small.toml").write_text(TEXT)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tyrefrf.plots.draw_plots", lambda *_: [])  # they take most of the time
    status, said = answer(monkeypatch, capsys, *command, "small.toml", "--scheduler", address)
    assert status == 0, said.err
    assert "4, 0 to 420 Hz" in said.out


def test_other_versions_are_refused(workers, monkeypatch):
    monkeypatch.setattr(cluster_module, "version", deadly.other_version)
    with pytest.raises(CommandError) as caught, cluster(workers.address):
        pass
    found = re.sub(r"tcp://[\d.:]+", "W", str(caught.value))
    own = deadly.other_version
    assert found.splitlines() == [
        "the cluster at W has other packages than this process:",
        f"  no tyrefrf, here {own('tyrefrf')}: W, W",
        f"  scipy 0.1, here {own('scipy')}: W, W",
        "install the same versions there",
    ]


def test_a_worker_that_is_killed_from_outside_leaves_nothing_undone(workers):
    (pid, *_) = workers._client.run(os.getpid).values()
    results = []
    for result in map_unordered(tasks_of(deadly.slow_square, 40), workers, reason_of):
        results.append(result)
        if len(results) == 5:
            os.kill(pid, signal.SIGKILL)
    assert sorted(results) == [n**2 for n in range(40)]


def test_only_the_line_that_kills_its_worker_fails(workers, alone, monkeypatch):
    monkeypatch.setattr(
        spectrum, "prepare", lambda problem, *_: partial(deadly.DeadlyAbove, problem)
    )
    monkeypatch.setattr(spectrum.Pace, "chunks", lambda _, lines: [lines[:2], lines[2:]])
    results = run_case(case_with(), jobs=workers)
    assert results.solved.tolist() == [True, True, True, False]
    np.testing.assert_array_equal(results.receptance[..., :3], alone.receptance[..., :3])
    reason = f"420 Hz: KilledWorker: {DEATHS} workers died of it, twice, the last at tcp:"
    assert results.remark[3].startswith(reason)


@contextmanager
def started(kind, *arguments):
    """`dask scheduler` or `dask worker`, killed at the end."""
    command = [sys.executable, "-W", "ignore", "-m", "distributed.cli.dask_" + kind]
    process = subprocess.Popen(
        [*command, *map(str, arguments)],
        stderr=subprocess.DEVNULL,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@contextmanager
def scheduler(directory):
    """A scheduler of its own process, and its file."""
    file = directory / "scheduler.json"
    options = ("--host", "127.0.0.1", "--port", 0, "--no-dashboard", "--no-show")
    with started("scheduler", *options, "--scheduler-file", file) as process:
        end = time.monotonic() + 30.0
        while not file.exists():
            assert time.monotonic() < end
            time.sleep(0.05)
        yield file, process


@pytest.mark.parametrize(
    ("dies", "reason"), [("worker", "no worker was left at"), ("scheduler", "has gone")]
)
def test_what_is_left_is_given_up_where_nobody_comes_back(tmp_path, monkeypatch, dies, reason):
    """The file of a scheduler, too, is an address; and a worker without a nanny stays dead."""
    monkeypatch.setattr("tyrefrf.study.cluster.WORKERS_BACK_WITHIN", 1.0)
    monkeypatch.setattr("tyrefrf.study.executor.SECONDS_BETWEEN_LOOKS", 0.5)
    found = []
    with (
        dask.config.set({"distributed.comm.timeouts.connect": "2s"}),
        scheduler(tmp_path) as (file, boss),
        started("worker", "--scheduler-file", file, "--no-nanny", "--nthreads", 1) as worker,
        cluster(str(file)) as workers,
    ):
        for result in map_unordered(tasks_of(deadly.slow_square, 40), workers, reason_of):
            found.append(result)
            if len(found) == 5:
                {"worker": worker, "scheduler": boss}[dies].kill()
    lost = [result for result in found if isinstance(result, str)]
    assert len(found) == 40
    assert 25 < len(lost) <= 35
    assert all(reason in result for result in lost)


def test_a_scheduler_without_workers_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(cluster_module, "ANSWER_WITHIN", 2.0)
    with scheduler(tmp_path) as (file, _), pytest.raises(CommandError, match="has no worker"):
        cluster(str(file)).__enter__()


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("tcp://127.0.0.1:1", "no scheduler answers at tcp://127.0.0.1:1 within 1 s"),
        ("127.0.0.1:1", "no scheduler answers at 127.0.0.1:1 within 1 s"),
        ("smoke://signals", "no scheduler answers at smoke://signals"),
        ("nowhere/scheduler.json", "no scheduler file nowhere/scheduler.json"),
    ],
)
def test_an_address_without_an_answer_is_one_message(address, message, monkeypatch, capsys):
    monkeypatch.setattr(cluster_module, "ANSWER_WITHIN", 1.0)
    status, said = refused(monkeypatch, capsys, "--scheduler", address)
    assert status == 2
    assert message in said


def test_without_dask_the_extra_is_named(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "distributed", None)
    status, said = refused(monkeypatch, capsys, "--scheduler", "tcp://127.0.0.1:1")
    assert status == 2
    assert 'pip install "tyrefrf[cluster]"' in said


def test_jobs_and_scheduler_exclude_one_another(monkeypatch, capsys):
    status, said = refused(monkeypatch, capsys, "--scheduler", "tcp://127.0.0.1:1", "--jobs", "2")
    assert status == 2
    assert "give one of them" in said


def refused(monkeypatch, capsys, *options):
    """The exit status and the message of a run that does not begin."""
    status, said = answer(monkeypatch, capsys, "run", *options)
    assert "Traceback" not in said.err
    return status, said.err


def answer(monkeypatch, capsys, *arguments):
    """The exit status of a command, and what it says."""
    monkeypatch.setattr(sys, "argv", ["tyrefrf", *arguments])
    with pytest.raises(SystemExit) as exit_:
        main()
    return exit_.value.code, capsys.readouterr()
