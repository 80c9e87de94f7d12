"""Too little memory is said beforehand, with what is needed and what is there; and where it runs
out all the same, a line fails, not the run.
"""

from __future__ import annotations

import re

import pytest
from small import case_with

from tyrefrf.case import make_grid
from tyrefrf.errors import SolveError
from tyrefrf.solvers import SOLVERS, Cyclic
from tyrefrf.study import memory
from tyrefrf.study.compare import run_comparison
from tyrefrf.study.deflection import deflections
from tyrefrf.study.dispersion import dispersion
from tyrefrf.study.estimate import estimate
from tyrefrf.study.memory import Need, Part, check_fits, need_of_cell, need_of_run
from tyrefrf.study.model import build_model
from tyrefrf.study.modes import modes
from tyrefrf.study.run import run
from tyrefrf.study.sweep import run_sweep

GB = 1e9


def little(monkeypatch, there: float) -> None:
    """So many bytes are left on the machine, and this process holds none."""
    monkeypatch.setattr(memory, "available_memory", lambda: there)
    monkeypatch.setattr(memory, "resident_now", lambda: 0)


def need(main: float, worker: float, jobs: int) -> Need:
    solver = Part("the solver 'direct'", worker, "'cyclic' takes less")
    return Need((Part("the responses", main, "take fewer lines"),), (solver,), jobs)


def test_what_fits_is_not_refused(monkeypatch):
    little(monkeypatch, 10 * GB)
    check_fits(need(1 * GB, 2 * GB, 4))


def test_what_does_not_fit_is_refused_with_both_numbers_and_what_takes_less(monkeypatch):
    little(monkeypatch, 10 * GB)
    message = (
        "needs 41.4 GB of memory (10.1 GB for each of 4 jobs), and 10 GB are available: the most "
        "is the solver 'direct', 40 GB: 'cyclic' takes less"
    )
    with pytest.raises(SolveError, match=re.escape(message)):
        check_fits(need(1 * GB, 10 * GB, 4))


def test_fewer_jobs_are_proposed_where_they_would_fit(monkeypatch):
    little(monkeypatch, 10 * GB)
    with pytest.raises(SolveError, match="available: --jobs 2 would fit; the most is"):
        check_fits(need(1 * GB, 4 * GB, 4))


def test_what_this_process_holds_already_is_there_for_it(monkeypatch):
    little(monkeypatch, 1 * GB)
    monkeypatch.setattr(memory, "resident_now", lambda: 3 * GB)
    check_fits(need(2 * GB, 0.0, 0))


def test_a_limit_on_processes_holds_for_each_of_them(monkeypatch):
    little(monkeypatch, 100 * GB)
    monkeypatch.setattr(memory, "room_of_process", lambda: 3 * GB)
    check_fits(need(2 * GB, 2 * GB, 8))
    for too_much in (need(4 * GB, 0.0, 0), need(1 * GB, 4 * GB, 1)):
        with pytest.raises(SolveError, match=r"and 3 GB are left by the limit on a process"):
            check_fits(too_much)


def test_where_the_system_does_not_say_nothing_is_refused(monkeypatch):
    monkeypatch.setattr(memory, "available_memory", lambda: None)
    monkeypatch.setattr(memory, "room_of_process", lambda: float("inf"))
    check_fits(need(1e6 * GB, 0.0, 0))


CASE = case_with()


@pytest.mark.parametrize(
    "study",
    [
        lambda: run(CASE, jobs=1),
        lambda: run_sweep(make_grid(CASE, {"E_rubber": (4e7, 8e7)}), jobs=1),
        lambda: modes(CASE),
        lambda: modes(CASE, below=300.0),
        lambda: dispersion(CASE, lines=2, jobs=1),
        lambda: run_comparison(CASE, ("cyclic", "direct")),
        lambda: deflections(CASE, [100.0]),
    ],
    ids=["run", "sweep", "modes", "modes below", "dispersion", "compare", "deflections"],
)
@pytest.mark.parametrize("there", [1e6, 166e6], ids=["before meshing", "before solving"])
def test_every_study_is_refused_before_it_takes_the_memory(study, there, monkeypatch):
    little(monkeypatch, there)
    with pytest.raises(SolveError, match=r"needs .* GB of memory.* are available: the most is the"):
        study()


def test_a_mesh_that_does_not_fit_is_refused_before_it_is_made(monkeypatch):
    little(monkeypatch, 20 * GB)
    large = case_with(
        ("elements_along = 8", "elements_along = 2000\nelements_through = 50"),
        ("sector_angle = 24.0", "sector_angle = 24.0\nelements_around = 10"),
    )
    monkeypatch.setattr("tyrefrf.study.model.tyre_section", None)
    with pytest.raises(SolveError, match=r"needs 62\.2 GB .* the matrices of a cell"):
        build_model(large)


def test_check_says_what_a_run_would_be_refused_for():
    need = need_of_run(CASE, [build_model(CASE).problem], 2)
    assert estimate(CASE, 2).memory == need.total
    assert estimate(CASE, 1).memory == pytest.approx(
        need_of_run(CASE, [build_model(CASE).problem], 1).total
    )


def test_more_of_anything_needs_more():
    def total(case, jobs=1):
        return need_of_run(case, [build_model(case).problem], jobs).total

    least = total(CASE)
    assert total(CASE, 2) > total(CASE, 1)
    for change in (
        ("elements_along = 8", "elements_along = 16"),
        ("sector_angle = 24.0", "sector_angle = 12.0"),
        ("sector_angle = 24.0", "sector_angle = 24.0\nelements_around = 2"),
        ("values = [0.0, 40.0, 150.0, 420.0]", "stop = 400.0\nstep = 0.1"),
        ('[[probes]]\nname = "hub"', '[[probes]]\nname = "p"\ns = 0.5\ndirection = "r"\n'
         '[[probes]]\nname = "hub"'),
        ('[[loads]]\nname = "patch"', '[[loads]]\nname = "l"\ns = 0.5\ndirection = "r"\n'
         '[[loads]]\nname = "patch"'),
    ):  # fmt: skip
        assert total(case_with(change)) > least, change
    assert need_of_cell(CASE, 1000).total > need_of_cell(CASE, 999).total


class Hungry(Cyclic):
    """A solver that one line is too much for."""

    def field(self, omega):
        if omega > 2.0:
            raise MemoryError("Unable to allocate 8. GiB")
        return super().field(omega)


def test_a_line_for_which_memory_runs_out_fails_and_the_others_are_kept(monkeypatch):
    monkeypatch.setitem(SOLVERS, "recursive", Hungry)
    found = run(CASE, jobs=1)
    assert found.failed.tolist() == [False, True, True, True]
    assert found.remark[1].startswith("40 Hz: memory ran out: Unable to allocate 8. GiB; fewer")
