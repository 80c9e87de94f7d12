"""Work in several processes: every result once, nothing made twice, and no death contagious."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import Future
from dataclasses import replace
from functools import partial
from itertools import chain

import deadly
import joblib
import numpy as np
import pytest
from deadly import reason_of, tasks_of
from small import TEXT, case_with

from tyrefrf.case import make_grid
from tyrefrf.cli.main import main
from tyrefrf.results import load_results
from tyrefrf.study import certify, dispersion, spectrum
from tyrefrf.study.executor import Task, executor_of, map_unordered
from tyrefrf.study.local import Here, Local, local
from tyrefrf.study.model import build_model
from tyrefrf.study.run import run_case
from tyrefrf.study.sweep import run_sweep

N = 12
SQUARES = [n**2 for n in range(N)]
DIED_TWICE = "its worker process died twice (SIGKILL(-9)): killed, or out of memory?"


@pytest.fixture
def notes(tmp_path):
    (tmp_path / "notes").mkdir()
    return tmp_path / "notes"


@pytest.fixture
def no_pool(monkeypatch):
    """Whoever starts a process fails."""
    monkeypatch.setattr("tyrefrf.study.local._processes", lambda _: pytest.fail("a process"))
    local.cache_clear()


@pytest.fixture
def deadly_above_400_hz(monkeypatch):
    """Lines of the small tyre: 0, 40, 150, and 420 Hz, which kills whoever solves it."""
    monkeypatch.setattr(
        spectrum, "prepare", lambda problem, *_: partial(deadly.DeadlyAbove, problem)
    )
    monkeypatch.setattr(spectrum.Pace, "chunks", lambda _, lines: [lines[:2], lines[2:]])


@pytest.mark.parametrize("workers", [1, 2])
def test_every_item_has_its_result_once(workers):
    assert sorted(map_unordered(tasks_of(deadly.square, N), workers, reason_of)) == SQUARES


@pytest.mark.parametrize(("workers", "ahead"), [(1, 1), (2, 4)])
def test_no_more_is_under_way_than_keeps_the_processes_busy(workers, ahead):
    taken, most = [], 0
    make = partial(partial, deadly.slow_square)
    tasks = (taken.append(item) or Task(make, item) for item in range(N))
    for n_results, _ in enumerate(map_unordered(tasks, workers, reason_of)):
        most = max(most, len(taken) - n_results)
    assert most == ahead
    assert len(taken) == N


def test_work_goes_on_with_fewer_workers(monkeypatch):
    monkeypatch.setattr("tyrefrf.study.executor.SECONDS_BETWEEN_LOOKS", 0.01)
    found = list(map_unordered(tasks_of(deadly.square, N), Shrinking(), reason_of))
    assert sorted(found) == SQUARES


class Shrinking(Here):
    """Three workers, soon one; whenever looked at, one task is done."""

    jobs = 3

    def __init__(self):
        self.under_way = []

    def submit(self, make, item):
        self.under_way.append((Future(), make()(item)))
        return self.under_way[-1][0]

    def look(self):
        self.jobs = 1
        for future, result in self.under_way[-1:]:
            future.set_result(result)
        self.under_way = self.under_way[:-1]


@pytest.mark.parametrize("workers", [1, 2])
def test_a_task_s_own_error_ends_the_work(workers):
    with pytest.raises(ValueError, match="three has no square"):
        list(map_unordered(tasks_of(deadly.no_square, N), workers, reason_of))


def test_processes_that_nobody_waits_for_are_killed():
    results = map_unordered(tasks_of(deadly.own_pid, N), 2, reason_of)
    pid = next(results)
    results.close()
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_tasks_that_wait_are_no_error_where_the_processes_are_killed(monkeypatch):
    said = []
    monkeypatch.setattr(threading, "excepthook", lambda error: said.append(error.exc_value))
    for _ in range(4):
        workers = Local(2)
        for _ in range(400):
            workers._submit(time.sleep, 0.0)
        workers.stop()
    assert said == []


@pytest.mark.parametrize("workers", [1, 2])
def test_processes_work_with_one_blas_thread(workers, monkeypatch):
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "2")
    local.cache_clear()
    found = map_unordered(tasks_of(deadly.blas_threads, 4), workers, reason_of)
    assert set().union(*found) == {1}


@pytest.mark.parametrize("jobs", [1, 2])
def test_one_pool_serves_batch_after_batch_and_makes_once(notes, jobs):
    executor = executor_of(jobs)
    make = deadly.Making(np.arange(100.0), notes)
    batches = [
        list(
            map_unordered([Task(make, n) for n in range(10 * i, 10 * i + 10)], executor, reason_of)
        )
        for i in range(3)
    ]
    found = list(chain(*batches))
    pids = {str(pid) for pid, _, _ in found}
    assert len(pids) <= jobs
    assert sorted(note.name.split("-")[0] for note in notes.iterdir()) == sorted(pids)
    assert sorted(value for _, _, value in found) == list(range(30))


def test_processes_share_the_arrays_that_they_are_given(notes):
    make = deadly.Making(np.arange(100.0), notes)
    found = list(map_unordered([Task(make, n) for n in range(4)], 2, reason_of))
    assert not any(writeable for _, writeable, _ in found)


@pytest.mark.parametrize("executor", [Here, partial(Local, 1)], ids=["here", "there"])
def test_a_process_keeps_the_last_two_functions(notes, executor):
    workers = executor()
    one, other, third = (deadly.Making(np.arange(3.0), notes) for _ in range(3))
    tasks = [Task(make, 0) for make in (one, other, one, third, other)]
    assert len(list(map_unordered(tasks, workers, reason_of))) == 5
    workers.stop()
    assert len(list(notes.iterdir())) == 4  # the third one has taken the other's place


def test_what_is_sent_stays_as_long_as_somebody_may_want_it(notes):
    executor = local(2)
    make, other = (deadly.Making(np.arange(3.0), notes) for _ in range(2))
    file, others = executor._file(make), executor._file(other)
    assert executor._file(make) == file != others
    del make
    assert not file.exists()
    assert others.exists()


def test_a_single_task_needs_no_pool(no_pool):
    assert isinstance(executor_of(2, n_tasks=1), Here)
    results = run_case(case_with(("[0.0, 40.0, 150.0, 420.0]", "[40.0]")), jobs=2)
    assert results.solved.all()


def test_one_job_needs_no_pool(no_pool):
    assert run_case(case_with(), jobs=1).solved.all()


def test_nothing_of_dask_is_imported_unasked(tmp_path):
    (tmp_path / "small.toml").write_text(TEXT)
    code = (
        "import sys, tyrefrf, tyrefrf.cli.running; tyrefrf.run('small.toml', jobs=2); "
        "print(sorted({'dask', 'distributed', 'joblib'} & set(sys.modules)))"
    )
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=tmp_path, check=True, text=True, stdout=subprocess.PIPE)
    assert done.stdout == "['joblib']\n"


def test_joblib_s_own_pool_is_left_alone():
    assert list(map_unordered(tasks_of(deadly.square, 4), 2, reason_of))
    two = joblib.Parallel(n_jobs=2)
    assert two(joblib.delayed(deadly.square)(n) for n in range(3)) == [0, 1, 4]
    assert list(map_unordered(tasks_of(deadly.square, 4), 2, reason_of))


def test_a_process_that_dies_once_leaves_nothing_undone(notes):
    tasks = tasks_of(deadly.Deadly(5, notes, times=1), N)
    assert sorted(map_unordered(tasks, 2, reason_of)) == SQUARES
    assert len(list(notes.iterdir())) == 1


def test_a_process_that_is_killed_from_outside_leaves_nothing_undone():
    (pid,) = map_unordered(tasks_of(deadly.own_pid, 1), local(2), reason_of)
    results = []
    for result in map_unordered(tasks_of(deadly.slow_square, 40), 2, reason_of):
        results.append(result)
        if len(results) == 5:
            os.kill(pid, signal.SIGKILL)
    assert sorted(results) == [n**2 for n in range(40)]
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_an_item_that_kills_is_tried_twice_and_stands_alone(notes):
    found = list(map_unordered(tasks_of(deadly.Deadly(5, notes), N), 2, reason_of))
    assert f"5: {DIED_TWICE}" in found
    found.remove(f"5: {DIED_TWICE}")
    assert sorted(found) == [square for n, square in enumerate(SQUARES) if n != 5]
    assert len(list(notes.iterdir())) == 2


def test_only_the_line_that_kills_its_process_fails(
    deadly_above_400_hz, tmp_path, monkeypatch, capsys
):
    alone = run_case(case_with(("420.0]", "150.0]"), ("40.0, 150.0", "40.0")), jobs=1)
    (tmp_path / "small.toml").write_text(TEXT)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tyrefrf.plots.draw_plots", lambda *_: [])
    monkeypatch.setattr(sys, "argv", ["tyrefrf", "run", "small.toml", "--jobs", "2"])
    with pytest.raises(SystemExit) as exit_:
        main()
    said = capsys.readouterr()
    assert exit_.value.code == 1
    assert f"420 Hz: {DIED_TWICE}" in said.err
    assert "4, 0 to 420 Hz, 1 FAILED" in said.out
    results = load_results("results/small/small.h5")
    assert results.remark == ("", "", "", f"420 Hz: {DIED_TWICE}")
    assert results.solved.tolist() == [True, True, True, False]
    np.testing.assert_array_equal(results.receptance[..., :3], alone.receptance)
    assert np.isnan(results.receptance[..., 3]).all()


def test_a_free_wave_s_line_that_kills_is_a_line_without_waves(monkeypatch):
    monkeypatch.setattr(dispersion, "_solve_line", deadly.kill_this_process_whatever)
    problem = build_model(case_with()).problem
    counted = []
    (line,) = dispersion.search_lines(problem, np.array([100.0]), 0.5, 2, counted.append)
    assert line.waves is None
    assert line.remark == DIED_TWICE
    assert counted == [1]


def test_a_certificate_s_line_that_kills_has_no_difference(monkeypatch):
    case = case_with()
    plan = replace(certify.plan_certificate(case, run_case(case, jobs=1)), refined=None)
    monkeypatch.setattr(
        certify, "prepare", lambda problem, *_: partial(deadly.DeadlyAbove, problem)
    )
    certificate = certify.certified(plan, 2).certificate
    assert np.isnan(certificate.residual).tolist() == [False, False, False, True]
    assert np.isnan(certificate.difference[:, 3]).all()


def test_results_do_not_depend_on_the_processes():
    grid = make_grid(case_with(), {"E_rubber": (40e6, 70e6), "sector_angle": (24.0, 36.0)})
    one, two = (run_sweep(grid, jobs=jobs) for jobs in (1, 2))
    for point, same in zip(one.points, two.points, strict=True):
        np.testing.assert_array_equal(point.receptance, same.receptance)
        np.testing.assert_array_equal(point.residual, same.residual)
