"""A run that goes on where another was ended gives the same digits, and solves only the rest."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from small import case_with

import tyrefrf
from tyrefrf.case import case_hash, load_case, make_grid
from tyrefrf.errors import CommandError, ResultsError
from tyrefrf.results import Results
from tyrefrf.results.journal import Journal
from tyrefrf.results.left import left_in, read_journal
from tyrefrf.solvers import no_answer
from tyrefrf.study.model import build_model
from tyrefrf.study.resume import recorded, resumed
from tyrefrf.study.run import run_case
from tyrefrf.study.sweep import run_sweep

CASES = Path(__file__).parents[2] / "cases"
LINES = ("values = [0.0, 40.0, 150.0, 420.0]", "stop = 420.0\nstep = 3.5")
ADAPTIVE = ("values = [0.0, 40.0, 150.0, 420.0]", "stop = 420.0\nstep = 1.0\nadaptive = true")
SAME = ("frequency", "mobility", "receptance", "blocked_force", "residual", "solved", "remark")


@pytest.fixture(autouse=True)
def one_line_at_a_time(monkeypatch):
    """Otherwise all of these would be solved before the first is known to be."""
    monkeypatch.setattr("tyrefrf.study.spectrum.SOON", 1e-9)


def with_solver(name):
    return ("[frequency]", f'[solver]\nname = "{name}"\n\n[frequency]')


class Killed(BaseException):
    """What ends a run here; a signal would do the same."""


class KilledAfter(Journal):
    """A journal of a run that is killed after so many lines."""

    def __init__(self, path, known=(), most=10_000):
        super().__init__(path, known)
        self.most = most

    def add(self, lines):
        super().add(lines)
        if self.n_lines >= self.most:
            raise Killed


def left_after(run, path, known, most):
    """What is there of a run that is killed when it has so many lines."""
    with KilledAfter(path, known, most) as journal, pytest.raises(Killed):
        run(record=journal)
    return read_journal(path)


def gone_on_with(run, path, known):
    """The results of a run that has these lines already, and how many lines its journal has."""
    with Journal(path, [line for line in known if line.has_answer]) as journal:
        return run(record=journal), journal.n_lines


def assert_same_digits(one, other):
    for name in SAME:
        assert np.array_equal(
            getattr(one, name), getattr(other, name), equal_nan=name not in ("remark", "solved")
        ), name


@pytest.mark.parametrize("solver", ["recursive", "cyclic", "direct", "modal"])
def test_a_run_killed_twice_ends_with_the_digits_of_one_that_was_not(solver, tmp_path):
    case = case_with(LINES, with_solver(solver))
    run = partial(run_case, case, jobs=2)
    left = left_after(run, tmp_path / "j", (), 20)
    left = left_after(run, tmp_path / "j", left.lines, 60)
    assert left.n_there == 60
    results, n_lines = gone_on_with(run, tmp_path / "j", left.lines)
    assert_same_digits(results, run())
    assert results.provenance.numbers["resumed_lines"] == left.n_there
    assert n_lines == 121  # none was solved twice


def test_adaptive_lines_take_the_same_course(tmp_path):
    run = partial(run_case, case_with(ADAPTIVE), jobs=2)
    left = left_after(run, tmp_path / "j", (), 30)
    results, whole = gone_on_with(run, tmp_path / "j", left.lines)[0], run()
    assert 24 < whole.solved.sum() < 300
    assert_same_digits(results, whole)
    assert results.provenance.numbers["fit_error"] == whole.provenance.numbers["fit_error"]


@pytest.mark.parametrize("lines", [LINES, ADAPTIVE], ids=["all", "adaptive"])
def test_a_sweep_goes_on_at_the_point_where_it_was_killed(lines, tmp_path):
    grid = make_grid(case_with(lines), {"E_rubber": (40e6, 80e6, 160e6)})
    run = partial(run_sweep, grid, jobs=2)
    whole = run()
    left = left_after(run, tmp_path / "j", (), int(whole.solved.sum() * 0.4))
    results, _ = gone_on_with(run, tmp_path / "j", left.lines)
    for point, expected in zip(results.points, whole.points, strict=True):
        assert_same_digits(point, expected)


def test_what_is_complete_needs_no_solver(tmp_path, monkeypatch):
    run = partial(run_case, case_with(), jobs=1)
    whole = run()
    monkeypatch.setattr("tyrefrf.study.spectrum.prepare", lambda *_: pytest.fail("prepared"))
    assert_same_digits(gone_on_with(run, tmp_path / "j", left_in(whole).lines)[0], whole)


def test_what_a_reader_sees_of_a_run_under_way_is_what_it_will_be(tmp_path):
    run = partial(run_case, case_with(LINES), jobs=1)
    so_far, whole = left_after(run, tmp_path / "j", (), 40).results, run()
    there = ~so_far.missing
    assert there.sum() >= 40
    np.testing.assert_array_equal(so_far.mobility[..., there], whole.mobility[..., there])
    assert so_far.provenance.case_hash == whole.provenance.case_hash
    assert so_far.probes == whole.probes


@pytest.fixture
def left():
    return left_in(run_case(case_with(), jobs=1))


def test_a_changed_case_is_refused_with_what_changed(left):
    changed = case_with(("80 MPa", "90 MPa"), ("eta = 0.1\n", ""))
    with pytest.raises(CommandError) as refused:
        resumed(changed, left)
    assert str(refused.value).splitlines() == [
        "begun with another case:",
        "  materials.rubber.E: 80000000.0 -> 90000000.0",
        "  materials.rubber.eta: 0.1 -> 0.0",
    ]


def test_a_case_that_is_only_written_otherwise_is_the_same(left):
    written_otherwise = case_with(('"80 MPa"', "8e7  # the same"), ('title = "Small tyre"\n', ""))
    with pytest.raises(CommandError, match=r"title: 'Small tyre' -> ''"):
        resumed(written_otherwise, left)
    assert resumed(case_with(('"80 MPa"', "8e7  # the same")), left) == case_with()


def test_files_that_changed_are_another_case(tmp_path):
    (tmp_path / "m.csv").write_text("10.0,1.0,0.0\n20.0,1.0,0.0\n")
    entry = '[[measured]]\nfile = "m.csv"\nload = "radial"\nprobe = "sidewall"\n'
    case = case_with(
        ('[[probes]]\nname = "hub"', f'{entry}quantity = "mobility"\n\n[[probes]]\nname = "hub"')
    )
    case = case.beside(tmp_path)
    left = left_in(run_case(case, jobs=1))
    assert resumed(case, left) == case
    (tmp_path / "m.csv").write_text("10.0,2.0,0.0\n20.0,1.0,0.0\n")
    with pytest.raises(CommandError, match="other contents of the files that the case names"):
        resumed(case, left)


def test_the_solver_that_was_picked_stays_the_one(left):
    case = resumed(case_with(with_solver("auto")), left)
    assert case.solver.name == "recursive"


def test_lines_of_another_version_are_not_mixed_in(left, monkeypatch):
    monkeypatch.setattr("tyrefrf.study.resume.version", lambda _: "9.9.9")
    with pytest.raises(CommandError, match=r"begun by tyrefrf 0\.1\.0, and this is 9\.9\.9"):
        resumed(case_with(), left)


def test_lines_that_failed_are_tried_again(tmp_path):
    run = partial(run_case, case_with(), jobs=1)
    whole = run()
    *answered, last = left_in(whole).lines
    failed = replace(last, line=no_answer(build_model(case_with()).problem, "died"))
    results, n_lines = gone_on_with(run, tmp_path / "j", [*answered, failed])
    assert_same_digits(results, whole)
    assert n_lines == 4


def test_from_python_a_journal_is_begun_and_gone_on_with(tmp_path, monkeypatch):
    file, case = tmp_path / "tyre.journal", case_with(LINES)
    first = tyrefrf.run(case, jobs=1, journal=file)
    monkeypatch.setattr("tyrefrf.study.spectrum.prepare", lambda *_: pytest.fail("prepared"))
    assert_same_digits(tyrefrf.run(case, jobs=1, journal=file), first)
    with pytest.raises(CommandError, match="begun with another case"):
        tyrefrf.run(case_with(), journal=file)


def test_from_python_a_sweep_is_gone_on_with_by_the_same_values_only(tmp_path, monkeypatch):
    file, values = tmp_path / "sweep.journal", {"E_rubber": [40e6, 80e6]}
    first = tyrefrf.sweep(case_with(), values, jobs=1, journal=file)
    monkeypatch.setattr("tyrefrf.study.spectrum.prepare", lambda *_: pytest.fail("prepared"))
    again = tyrefrf.sweep(case_with(), values, jobs=1, journal=file)
    for point, expected in zip(again.points, first.points, strict=True):
        assert_same_digits(point, expected)
    with pytest.raises(CommandError, match=r"E_rubber = 40 MPa, 80 MPa -> E_rubber = 40 MPa, 90"):
        tyrefrf.sweep(case_with(), {"E_rubber": [40e6, 90e6]}, journal=file)


def test_from_python_a_journal_of_another_command_is_refused(tmp_path):
    of_sweep, of_run = tmp_path / "sweep.journal", tmp_path / "run.journal"
    tyrefrf.sweep(case_with(), {"E_rubber": [40e6, 80e6]}, jobs=1, journal=of_sweep)
    tyrefrf.run(case_with(), jobs=1, journal=of_run)
    with pytest.raises(CommandError, match="holds results of another command"):
        tyrefrf.run(case_with(), journal=of_sweep)
    with pytest.raises(CommandError, match="holds results of another command"):
        tyrefrf.sweep(case_with(), {"E_rubber": [40e6, 80e6]}, journal=of_run)


def test_from_python_a_journal_has_one_writer(tmp_path):
    file = tmp_path / "tyre.journal"
    with recorded(case_with(), file, Results), pytest.raises(ResultsError, match="being written"):
        tyrefrf.run(case_with(), journal=file)


@pytest.fixture
def named(tmp_path):
    """A case that names a mesh, with three lines, and the mesh."""
    mesh = tmp_path / "meshes" / "section.inp"
    mesh.parent.mkdir()
    mesh.write_bytes((CASES / "meshes/section.inp").read_bytes())
    text = (CASES / "mesh_section.toml").read_text()
    text = text.replace("stop = 500.0\nstep = 5.0", "values = [0.0, 50.0, 100.0]")
    (tmp_path / "tyre.toml").write_text(text)
    return load_case(tmp_path / "tyre.toml"), mesh


def change(mesh):
    """Move a node a little."""
    mesh.write_text(mesh.read_text().replace("\n1, 168.0", "\n1, 168.1", 1))


class Changing(Journal):
    """Its run finds a file changed as its first line is there."""

    def __init__(self, path, mesh):
        super().__init__(path)
        self.mesh = mesh

    def add(self, lines):
        super().add(lines)
        change(self.mesh)


def test_results_are_of_the_files_that_were_read(named, tmp_path):
    case, mesh = named
    expected = case_hash(case)
    with Changing(tmp_path / "j", mesh) as journal:
        results = run_case(case, jobs=1, record=journal)
    assert results.provenance.case_hash == expected != case_hash(case)
    assert read_journal(tmp_path / "j").results.provenance.case_hash == expected


def test_files_that_change_while_they_are_read_are_refused(named, monkeypatch):
    case, mesh = named

    def changing(case):
        change(mesh)
        return build_model(case)

    monkeypatch.setattr("tyrefrf.study.run.build_model", changing)
    with pytest.raises(CommandError, match=r"names \(mesh.file\) was changed while it was read"):
        run_case(case, jobs=1)
