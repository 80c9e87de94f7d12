"""What the benchmarks time is what they say, and how they write it down; nothing is timed here."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest
from small import case_with

from benchmarks import __main__ as everything
from benchmarks import growth, lines, machine, operations, parts, speed, startup, tyres
from benchmarks.command import command
from tyrefrf.case import parse_case, resolved_toml
from tyrefrf.solvers.symmetry import halves, turnabout
from tyrefrf.study.compare import section_error

ROUND_OFF = 1e-9  # condition 1e5 to 1e6 times eps, with margin
NAMES = ("recursive", "cyclic", "plain", "direct", *tyres.libraries())
SCRIPTS = sorted(
    path.stem
    for path in Path(everything.__file__).parent.glob("*.py")
    if "__name__ ==" in path.read_text()
)


@pytest.fixture(scope="module", params=tyres.LOADS)
def ring(request):
    """A small ring under each of the loads."""
    return tyres.problem_under(case_with(), request.param)


@pytest.fixture(scope="module")
def truth(ring):
    return tyres.line_of("direct", ring)()


@pytest.mark.parametrize("name", NAMES)
def test_whatever_is_timed_solves_the_same_line(ring, truth, name):
    line = tyres.lines_of((name,), ring)[name]
    assert section_error(line(), truth) < ROUND_OFF


@pytest.mark.parametrize(("load", "excited"), [(tyres.MID_TREAD, 1), (tyres.OBLIQUE, 2)])
def test_a_load_excites_the_halves_that_it_is_said_to(load, excited):
    ring = tyres.problem_under(case_with(), load)
    f = ring.load_cells()[0][ring.free]
    parts_of_f = [np.linalg.norm(Q.T @ f) for Q in halves(ring.cell)]
    assert np.linalg.norm(f) == pytest.approx(1.0)
    assert np.sum(np.array(parts_of_f) > 0.1) == excited


@pytest.mark.parametrize(("load", "kept"), [(tyres.MID_TREAD, True), (tyres.OBLIQUE, False)])
def test_only_the_load_at_mid_tread_is_kept_by_the_rings_mirror(load, kept):
    ring = tyres.problem_under(case_with(), load)
    f = ring.load_cells()[0][ring.free][:, None]
    image = turnabout(ring.cell).of(f, np.zeros(1))
    assert np.allclose(image, f) == kept


@pytest.mark.parametrize("load", [tyres.OBLIQUE])
def test_the_joins_that_are_timed_are_a_part_of_the_line(load):
    ring = tyres.problem_under(case_with(), load)
    for part in parts.parts_of(ring).values():
        part()
    seconds = {parts.LINE: 10.0, parts.CELL: 1.0, parts.JOINS: 5.0, parts.CHECK: 1.5}
    assert parts.recovery(seconds) == pytest.approx(2.5)


@pytest.mark.parametrize(
    "changed",
    [
        lambda case: tyres.with_cells(case, 720),
        lambda case: tyres.with_elements(case, 56, 2),
        lambda case: tyres.with_lines(case, 2001, adaptive=True),
        lambda case: tyres.with_solver(case, "cyclic"),
        startup.one_line,
        lambda case: startup.one_line(case, plots=False),
    ],
)
@pytest.mark.parametrize("tyre", tyres.tyres())
def test_a_changed_case_is_one_that_a_file_could_hold(tyre, changed):
    case = changed(tyres.tyres()[tyre])
    assert parse_case(resolved_toml(case), "case", "case") == case


def test_the_lines_go_from_0_to_2000_hz():
    frequency = tyres.with_lines(case_with(), 2001).frequency.lines()
    assert (frequency[0], frequency[1], frequency[-1], len(frequency)) == (0, 1, 2000, 2001)


def test_a_finer_section_in_more_cells_has_their_dofs():
    case = tyres.with_cells(tyres.with_elements(case_with(), 10, 2), 20)
    ring = tyres.problem_under(case, tyres.OBLIQUE)
    assert (ring.n_cells, tyres.section_dofs(ring)) == (20, 3 * (10 - 1) * 3)


def test_functions_are_timed_in_turn_and_the_shortest_run_counts(monkeypatch):
    clock = iter([0.0, 0.0, 5.0, 10.0, 10.0, 12.0, 20.0, 20.0, 23.0, 30.0, 30.0, 34.0])
    monkeypatch.setattr(machine.time, "perf_counter", lambda: next(clock))
    calls = []
    functions = {name: lambda name=name: calls.append(name) for name in "ab"}
    assert machine.interleaved(functions, rounds=2, share=0.0) == {"a": 3.0, "b": 2.0}
    assert calls == ["a", "b", "a", "b"]


def test_what_would_take_too_long_is_left_out_and_expected(monkeypatch):
    monkeypatch.setattr(
        growth, "interleaved", lambda functions, rounds: dict.fromkeys(functions, 5.0)
    )
    rings = [tyres.problem_under(tyres.with_cells(case_with(), N), tyres.OBLIQUE) for N in (4, 8)]
    first, second = growth.grown(rings)
    assert {first["recursive"], first["SuperLU"]} == {"5e+03"}
    assert {second["recursive"], second["SuperLU"]} == {"(1e+04)"}


def test_what_does_not_fit_into_memory_is_said(monkeypatch):
    monkeypatch.setattr("tyrefrf.solvers.memory.available_memory", lambda: 1)
    (row,) = growth.grown([tyres.problem_under(case_with(), tyres.OBLIQUE)])
    assert row["SuperLU"] == "memory"
    assert float(row["recursive"]) > 0


def test_the_joins_operations_are_the_recursions():
    ring = tyres.problem_under(case_with(), tyres.OBLIQUE)
    found = operations.operations_of(ring)
    assert found["recursive"] == found[operations.ALONE] < found["plain"]


def test_fixed_cost_and_cost_per_line_are_those_of_the_line_through_both_ends():
    assert lines.line_through({10: 2.1, 100: 9.0, 1000: 12.0}) == pytest.approx((2.0, 0.01))


def test_a_ratio_without_its_library_is_not_here():
    assert speed.ratio({"PARDISO": 3.0, "cyclic": 0.5}, "PARDISO", "cyclic") == "6"
    assert speed.ratio({"cyclic": 0.5}, "PARDISO", "cyclic") == machine.NOT_HERE


def test_without_mkl_the_table_of_speed_says_so(monkeypatch):
    monkeypatch.setattr(tyres.mkl, "installed", lambda: False)
    monkeypatch.setattr(speed, "ROUNDS", 1)
    monkeypatch.setattr(speed, "tyres", lambda: {"small": case_with()})
    *_, first, second = speed.measured().splitlines()
    words = [[cell.strip() for cell in row.split("|")] for row in (first, second)]
    assert [row[3] for row in words] == [machine.NOT_HERE] * 2  # PARDISO's time
    assert all(float(row[8]) > 0 for row in words)  # SuperLU / recursive
    assert all(float(row[-2]) < ROUND_OFF for row in words)
    assert "no PARDISO" in machine.description()


def test_a_commands_memory_is_watched_and_its_childrens_too():
    hold = "import time; held = b'x' * 100_000_000; time.sleep(0.4)"
    child = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {hold!r}])"
    found = command("-c", child, program=(sys.executable,), watch=True)
    assert found.main < 1e8 < found.together
    assert found.seconds > 0.4


def test_a_command_that_fails_says_why():
    with pytest.raises(RuntimeError, match=r"no\.toml: cannot be read"):
        command("check", "no.toml")


@pytest.mark.parametrize("script", [name for name in SCRIPTS if name != "__main__"])
def test_every_script_is_part_of_the_whole(script):
    module = importlib.import_module(f"benchmarks.{script}")
    assert {getattr(module, "measured", None), getattr(module, "table", None)} & set(
        everything.SECTIONS.values()
    )


def test_the_readme_keeps_its_words_around_the_tables():
    found = {title: f"table of {title}" for title in everything.SECTIONS}
    before = "Above.\n<!-- results -->\nold\n<!-- /results -->\nBelow."
    after = everything.with_tables(before, "Made here.", found)
    assert after.startswith("Above.\n<!-- results -->\n\nMade here.\n\nSpeed. table of Speed")
    assert after.endswith("<!-- /results -->\nBelow.")
    assert "old" not in after
    assert all(
        f"## {title}\n\n{text}" in everything.page("", found) for title, text in found.items()
    )
