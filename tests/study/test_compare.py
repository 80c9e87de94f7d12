"""Solvers compared, each in a process of its own: differences, memory, and deaths."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
import textwrap
import time
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from small import TEXT, case_with

import tyrefrf
from tyrefrf.case import parse_case
from tyrefrf.errors import CommandError, SolveError
from tyrefrf.solvers import prepare
from tyrefrf.study import compare
from tyrefrf.study.compare import (
    Task,
    evenly,
    known_solvers,
    response_difference,
    run_comparison,
    section_error,
    with_lines,
    with_solver,
)
from tyrefrf.study.model import build_model
from tyrefrf.study.own_process import in_own_process, peak_memory

ROUND_OFF = 1e-9  # the project's promise between solvers; the small tyre stays near 1e-12
MB = 1e6

WORKS = """
import os, signal, time
from dataclasses import replace
from functools import partial

from tyrefrf.errors import SolveError


def nothing(say):
    from tyrefrf.study.own_process import peak_memory
    return peak_memory()

def holds(n_bytes, say):
    from tyrefrf.study.own_process import peak_memory
    held = bytearray(b"x") * n_bytes
    return peak_memory() + 0 * len(held)

def speaks(say):
    print("a library that prints", flush=True)
    os.system("echo a library that prints from C")
    for k in range(3):
        say(k)
    return os.environ["OPENBLAS_NUM_THREADS"]

def waits_to_be_killed(say):
    say(os.getpid())
    time.sleep(60)

def refuses(say):
    raise SolveError("the library 'pardiso' is not installed")

def runs_out_of_memory(say):
    return bytearray(2**62)

def has_a_bug(say):
    return 1 / 0

def exits(say):
    os._exit(3)


def solve_wrongly(task, say):
    "As `solve_alone`, but `cyclic` is wrong by 1e-6, and `modal` is killed on its second line."
    from tyrefrf.solvers import Cyclic, prepare
    from tyrefrf.study import compare

    class Wrong(Cyclic):
        def field(self, omega):
            field = super().field(omega)
            return replace(field, q=(1 + 1e-6) * field.q)

    class Dying(Cyclic):
        def field(self, omega):
            if omega > 0:
                os.kill(os.getpid(), signal.SIGKILL)
            return super().field(omega)

    wrong = {"cyclic": Wrong, "modal": Dying}

    def prepare_wrongly(problem, choice):
        if choice.name in wrong:
            return partial(wrong[choice.name], problem)
        return prepare(problem, choice)

    compare.prepare = prepare_wrongly
    return compare.solve_alone(task, say)
"""
"""Work for other processes, which import it; what is patched here does not reach them."""


@pytest.fixture(scope="module")
def works(tmp_path_factory):
    """The module of the works, where spawned processes find it too."""
    directory = tmp_path_factory.mktemp("works")
    (directory / "works.py").write_text(WORKS)
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(directory)
        yield importlib.import_module("works")


def silence(what):
    """For a process of which nothing is expected but its result."""


@pytest.fixture(scope="module")
def compared(works):
    """The small tyre by four solvers of which one is wrong and one dies; lines as reported."""
    told = []

    @contextmanager
    def watch(solver):
        yield lambda n: told.append((solver, n))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compare, "solve_alone", works.solve_wrongly)
        solvers = ["recursive", "modal", "cyclic", "direct"]
        return run_comparison(case_with(), solvers, case_text="as written", watch=watch), told


def test_what_is_said_arrives_in_order_and_what_is_printed_does_not(works, capfd):
    heard = []
    assert in_own_process(works.speaks, heard.append) == "1"
    assert heard == [0, 1, 2]
    assert capfd.readouterr().out == ""


def test_200_megabytes_more_are_200_megabytes_more(works):
    none = in_own_process(works.nothing, silence)
    more = in_own_process(partial(works.holds, 200_000_000), silence)
    assert more - none == pytest.approx(200 * MB, abs=2 * MB)  # pages, and what bytearray needs


def test_a_process_s_memory_is_not_its_parent_s(works):
    held = np.ones(25_000_000)  # 200 MB, which `ru_maxrss` of a child would begin with
    assert peak_memory() > held.nbytes
    assert in_own_process(works.nothing, silence) < 50 * MB


def test_a_killed_process_is_reported_at_once(works):
    with pytest.raises(SolveError, match=r"killed \(SIGKILL\).* memory"):
        in_own_process(works.waits_to_be_killed, lambda pid: os.kill(pid, 9))


def test_a_listener_that_gives_up_ends_the_process(works):
    pids = []

    def give_up(pid):
        pids.append(pid)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        in_own_process(works.waits_to_be_killed, give_up)
    with pytest.raises(ProcessLookupError):
        os.kill(pids[0], 0)


@pytest.mark.parametrize(
    ("work", "reason"),
    [
        ("refuses", "the library 'pardiso' is not installed"),
        ("runs_out_of_memory", "too little memory"),
        ("has_a_bug", "ZeroDivisionError: division by zero"),
        ("exits", "its process ended with status 3 before it was done"),
    ],
)
def test_work_that_fails_says_why(works, work, reason):
    with pytest.raises(SolveError, match=reason):
        in_own_process(getattr(works, work), silence)


def test_work_that_cannot_be_read_is_refused():
    module = type(sys)("nowhere_to_be_found")
    exec("def work(say): pass", module.__dict__)
    sys.modules[module.__name__] = module
    try:
        with pytest.raises(SolveError, match="No module named 'nowhere_to_be_found'"):
            in_own_process(module.work, silence)
    finally:
        del sys.modules[module.__name__]


def test_a_script_without_a_main_guard_runs_once(tmp_path, works):
    """A clean interpreter does not run the caller's script again, as multiprocessing's would."""
    script = tmp_path / "script.py"
    script.write_text(
        textwrap.dedent(f"""
        import sys
        sys.path.insert(0, {str(Path(works.__file__).parent)!r})
        import works
        from tyrefrf.study.own_process import in_own_process
        print("once", in_own_process(works.speaks, print))
        """)
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["0", "1", "2", "once", "1"]


def test_a_field_wrong_by_a_millionth_differs_by_a_millionth():
    q = np.random.default_rng(1).standard_normal((5, 6, 2)) * (1 + 2j)
    assert section_error((1 + 1e-6) * q, q) == pytest.approx(1e-6, rel=1e-9)
    assert section_error(q, q) == 0.0


def test_the_worst_section_and_load_count_by_their_own_size():
    q = np.ones((5, 4, 2), complex)
    q[3, :, 1] = 1e-4  # a far section moves little
    wrong = q.copy()
    wrong[3, 0, 1] += 2e-7  # norm of the section: 2e-4
    assert section_error(wrong, q) == pytest.approx(1e-3, rel=1e-12)


def test_a_section_that_stands_still_differs_if_it_moves():
    q = np.ones((2, 3, 1), complex)
    q[1] = 0.0
    assert section_error(q, q) == 0.0
    moved = q.copy()
    moved[1, 0] = 1e-20
    assert section_error(moved, q) == np.inf


def test_responses_differ_relative_to_all_probes_of_a_load():
    H = np.zeros((2, 3, 4), complex)
    H[0, 0], H[1, 1] = 5.0, 1e-3
    wrong = H.copy()
    wrong[0, 2, 1] += 1e-5  # zero by symmetry, but for rounding
    wrong[1, 2, 3] -= 1e-5j
    assert response_difference(wrong, H) == pytest.approx([0.0, 2e-6, 0.0, 1e-2], rel=1e-9)


def test_a_failed_line_has_no_difference():
    H = np.ones((1, 2, 3), complex)
    wrong = H.copy()
    wrong[..., 1] = complex(np.nan, np.nan)
    assert np.isnan(response_difference(wrong, H)).tolist() == [False, True, False]


def test_every_solver_is_measured_against_every_other(compared):
    found, _ = compared
    r, m, c, d = range(4)
    assert found.reference == "direct"
    assert found.error[c] == pytest.approx(1e-6, rel=1e-4)
    assert found.error[r] < ROUND_OFF
    assert found.error[d] == 0.0
    assert found.pair_error[c, r] == pytest.approx(1e-6, rel=1e-4)
    assert np.isnan(found.pair_error[m]).all()
    np.testing.assert_allclose(found.section_error[c, d], 1e-6, rtol=1e-4)
    np.testing.assert_array_equal(found.samples, range(4))


def test_differences_of_responses_are_those_of_every_line(compared):
    found, _ = compared
    H, truth = found.receptance[2], found.receptance[3]
    shares = np.abs(truth).max(axis=1) / np.linalg.norm(truth, axis=1)
    np.testing.assert_allclose(found.difference[2], 1e-6 * shares.max(axis=0), rtol=1e-4)
    np.testing.assert_allclose(H, (1 + 1e-6) * truth, rtol=0, atol=ROUND_OFF * abs(truth).max())
    assert np.all(found.difference[0] < ROUND_OFF)


def test_the_answers_are_a_run_s(compared):
    found, _ = compared
    alone = tyrefrf.run(case_with(), jobs=1)
    np.testing.assert_array_equal(found.of("recursive").receptance, alone.receptance)
    np.testing.assert_array_equal(found.of("recursive").residual, alone.residual)
    assert found.of("recursive").probes == alone.probes
    assert found.provenance.case_hash == alone.provenance.case_hash


def test_one_that_is_killed_leaves_the_others_their_rows(compared):
    found, _ = compared
    assert [bool(why) for why in found.failure] == [False, True, False, False]
    assert "SIGKILL" in found.failure[1]
    assert found.failed.tolist() == [[False] * 4, [True] * 4, [False] * 4, [False] * 4]
    assert np.isnan(found.disk).tolist() == [False, True, False, False]


def test_lines_are_reported_while_they_are_solved(compared):
    _, told = compared
    expected = ["recursive"] * 4 + ["modal"] + ["cyclic"] * 4 + ["direct"] * 4
    assert told == [(solver, 1) for solver in expected]


def test_costs_are_those_of_a_process(compared, tmp_path):
    found, _ = compared
    whole = [0, 2, 3]
    assert np.all(found.seconds[whole] > 0)
    assert np.all(found.prepare_seconds[whole] > 0)
    assert np.all(found.base_memory[whole] > 50 * MB)  # numpy and scipy are loaded
    assert np.all(found.peak_memory >= found.base_memory, where=~np.isnan(found.disk))
    tyrefrf.write_results(tmp_path / "run.h5", tyrefrf.run(case_with(), jobs=1))
    size = (tmp_path / "run.h5").stat().st_size
    assert found.disk[whole] == pytest.approx(size, rel=0.05)  # texts and times differ
    assert "1 thread" in found.machine["BLAS"]


def test_of_a_reference_without_answers_another_takes_the_place(works, monkeypatch):
    monkeypatch.setattr(compare, "in_own_process", _answers_but_direct)
    found = run_comparison(case_with(), ["direct", "cyclic"])
    assert found.reference == "cyclic"
    assert found.failure == ("too little memory", "")
    assert found.error.tolist()[1] == 0.0
    assert np.isnan(found.error[0])


def _answers_but_direct(work, listen):
    """The same here and now, but that `direct` refuses."""
    (task,) = work.args
    if task.case.solver.name == "direct":
        raise SolveError("too little memory")
    return work(listen)


def test_sections_are_kept_of_the_sampled_lines_alone(tmp_path):
    case = case_with(('"hex8i"', '"hex20r"'))  # has nodes between its sections
    task = Task(with_solver(case, "cyclic"), "", np.array([1, 3]), tmp_path)
    compare.solve_alone(task, silence)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cyclic_1.npy", "cyclic_3.npy"]
    problem = build_model(task.case).problem
    field = prepare(problem, task.case.solver)().field(2 * np.pi * 40.0)
    kept = np.load(tmp_path / "cyclic_1.npy")
    assert problem.cell.n_face < problem.cell.n_own
    np.testing.assert_array_equal(kept, field.q[:, : problem.cell.n_face])


def test_a_failed_line_is_a_remark(tmp_path):
    task = Task(case_with(), "", np.array([0]), tmp_path)
    problem = build_model(task.case).problem

    class Refusing:
        exact = True

        def field(self, omega):
            raise SolveError("an undamped resonance lies on this line")

    spectrum = compare._spectrum(problem, Refusing(), 0.5, task, silence)
    assert spectrum.remark[1] == "40 Hz: an undamped resonance lies on this line"
    assert np.isnan(spectrum.receptance).all()
    assert not list(tmp_path.iterdir())


def test_times_are_cpu_times_which_waiting_does_not_lengthen(tmp_path):
    task = Task(case_with(), "", np.array([0]), tmp_path)
    problem = build_model(task.case).problem

    class Waiting:
        exact = True

        def field(self, omega):
            time.sleep(0.05)
            raise SolveError("no answer")

    spectrum = compare._spectrum(problem, Waiting(), 0.5, task, silence)
    assert np.all((spectrum.solve_time >= 0.0) & (spectrum.solve_time < 0.02))


@pytest.mark.parametrize(
    ("n", "wanted", "picked"),
    [(5, 12, [0, 1, 2, 3, 4]), (9, 3, [0, 4, 8]), (401, 2, [0, 400]), (1, 3, [0]), (5, 1, [0])],
)
def test_lines_are_picked_evenly(n, wanted, picked):
    assert evenly(n, wanted).tolist() == picked


def test_fewer_lines_are_lines_of_the_case():
    case = case_with(("values = [0.0, 40.0, 150.0, 420.0]", "stop = 100.0\nstep = 2.5"))
    assert with_lines(case, 5).frequency.lines() == [0.0, 25.0, 50.0, 75.0, 100.0]
    assert with_lines(case, None) is case
    assert with_lines(case, 41) is case


def test_the_case_s_own_solver_keeps_its_options():
    own = parse_case(TEXT + '\n[solver]\nname = "direct"\nlibrary = "superlu"\n', "own", "own")
    assert with_solver(own, "direct").solver.library == "superlu"
    assert with_solver(own, "cyclic").solver.name == "cyclic"


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["cyclc"], r"no solver 'cyclc'; did you mean 'cyclic'\?"),
        (["xyz"], "no solver 'xyz'; there are: recursive, cyclic, direct, modal"),
        (["direct", "cyclic", "direct"], "solver 'direct' is named twice"),
        ([], "no solvers to compare; name some of: recursive"),
    ],
)
def test_wrong_names_are_refused(names, message):
    with pytest.raises(CommandError, match=message):
        known_solvers(names)


def test_no_room_for_sections_is_said_with_its_place(tmp_path):
    task = Task(case_with(), "", np.array([0]), tmp_path / "gone")
    problem = build_model(task.case).problem
    solver = prepare(problem, task.case.solver)()
    with pytest.raises(SolveError, match=r"gone, for what is compared, .*TMPDIR names another"):
        compare._spectrum(problem, solver, 0.5, task, silence)
