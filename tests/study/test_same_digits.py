"""A line's digits are the tyre's alone, whoever solved it, when, and whatever they solved before.

Alike means to the bit, on one machine. What other threads and processors change is measured in
docs/accuracy/digits.md.
"""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache, partial
from itertools import chain

import numpy as np
import pytest
from alike import HERTZ, SOLVERS, TYRES, bits, maker_of, problem_of, solved, solving, text_of
from brought import export
from hdf5 import differences
from rings import clamped_frequencies, lossless, skewed, tyre
from threadpoolctl import threadpool_info, threadpool_limits

from tyrefrf.case import parse_case
from tyrefrf.solvers import Direct, Recursive, answer
from tyrefrf.study.executor import Task, map_unordered
from tyrefrf.study.model import build_model
from tyrefrf.study.run import run_case

TWO_THREADS = 1e-9
"""Of a line's norm over its responses, as solvers agree among themselves: rounding, times the
condition of the equations. Measured: nothing mostly, 1e-10 by `direct` with a belt of steel."""
OWN = {"created", "seconds", "solve_time", "point/seconds", "point/created"}
"""What two runs may differ in: when they were, and what they took."""


def alone(problem, make):
    """Every line by a solver that has solved no other."""
    return dict(chain(*(solved(problem, make, [f]).items() for f in HERTZ)))


def orders():
    """The lines backwards, and twice over, the second time at random."""
    rng = np.random.default_rng(0)
    return [HERTZ[::-1], np.concatenate([HERTZ, rng.permutation(HERTZ)])]


def pieces(hertz, length):
    return [hertz[k : k + length].tolist() for k in range(0, len(hertz), length)]


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", TYRES)
def test_a_line_does_not_depend_on_what_its_solver_solved_before(name, solver):
    problem = problem_of(name)
    make = maker_of(problem, solver)
    expected = alone(problem, make)
    for hertz in orders():
        assert solved(problem, make, hertz) == expected


@pytest.mark.parametrize("solver", SOLVERS)
def test_nor_where_the_cell_was_brought_as_matrices(solver, tmp_path):
    exported = export(skewed(tyre(n_cells=12, elements_along=4)), tmp_path)
    problem = build_model(exported.case()).problem
    make = maker_of(problem, solver)
    expected = alone(problem, make)
    for hertz in orders():
        assert solved(problem, make, hertz) == expected


@pytest.mark.parametrize("make", [Recursive, Direct])
def test_nor_where_a_line_took_another_way(make):
    """At a held chain's resonance `recursive` asks `cyclic`, and `direct` pivots anew."""
    ring = lossless(tyre(n_cells=7, elements_along=4, elements_around=2))
    problem = ring.problem(ring.point_loads((0, 3, 0)))
    omega = clamped_frequencies(ring, 1)[0]
    solver = make(problem)
    lines = {w: bits(answer(problem, make(problem), w)) for w in (omega, 0.8 * omega, 1.1 * omega)}
    for w in (omega, 0.8 * omega, omega, 1.1 * omega, 0.8 * omega):
        assert bits(answer(problem, solver, w)) == lines[w]


@cache
def in_turn(name, solver):
    """A problem, what makes its solver, and its lines by one solver, one after the other."""
    problem = problem_of(name)
    make = maker_of(problem, solver)
    return problem, make, solved(problem, make, HERTZ)


@pytest.mark.parametrize("jobs", [1, 2, 3])
def test_nor_on_the_processes_and_on_what_each_is_given_at_a_time(jobs):
    """A process keeps its solver, and that of another tyre; who solves what is chance."""
    for name in ("undamped", "layered"):
        for solver in SOLVERS:
            problem, make, expected = in_turn(name, solver)
            work = partial(solving, problem, make)
            for length in (1, 2, 7, 64):
                tasks = (Task(work, piece) for piece in pieces(HERTZ, length))
                found = map_unordered(tasks, jobs, lambda task, reason: pytest.fail(reason))
                assert dict(chain(*(part.items() for part in found))) == expected


DIRECT = ("[cell]", '[solver]\nname = "direct"\nlibrary = "superlu"\n[cell]')
MODAL = ("[cell]", '[solver]\nname = "modal"\nmodes = 60\n[cell]')
ADAPTIVE = ("values = [0.0, 40.0, 150.0, 420.0]", "stop = 600.0\nstep = 5.0\nadaptive = true")
RUNS = {
    "direct": text_of("layered", DIRECT),
    "adaptive": text_of("viscoelastic", ADAPTIVE),
    "modal": text_of("inflated", MODAL),
}
SETTINGS = [
    ({"PYTHONHASHSEED": "0"}, 1),
    ({"PYTHONHASHSEED": "1", "OPENBLAS_NUM_THREADS": "4", "OMP_NUM_THREADS": "4"}, 1),
    ({"PYTHONHASHSEED": "random", "OPENBLAS_NUM_THREADS": "2", "MKL_NUM_THREADS": "4"}, 3),
]
RUN = (
    "import sys, tyrefrf; results = tyrefrf.run('tyre.toml', jobs=int(sys.argv[1]), certify=True); "
    "tyrefrf.write_results(sys.argv[2], results)"
)


@pytest.mark.parametrize("name", RUNS)
def test_two_runs_write_the_same_file_whatever_their_surroundings(name, tmp_path):
    (tmp_path / "tyre.toml").write_text(RUNS[name])
    files = [tmp_path / f"{number}.h5" for number in range(len(SETTINGS))]
    for file, (settings, jobs) in zip(files, SETTINGS, strict=True):
        command = [sys.executable, "-c", RUN, str(jobs), str(file)]
        subprocess.run(command, cwd=tmp_path, env=os.environ | settings, check=True)
    assert [differences(files[0], file, OWN) for file in files[1:]] == [[], []]


@pytest.mark.parametrize("solver", SOLVERS)
def test_two_blas_threads_change_rounding_alone(solver):
    problem = problem_of("layered")

    def at(threads):
        with threadpool_limits(limits=threads, user_api="blas"):
            assert threads in {pool["num_threads"] for pool in threadpool_info()}
            own = maker_of(problem, solver)()
            return [answer(problem, own, 2.0 * np.pi * f).receptance for f in HERTZ[:4]]

    for H, other in zip(at(1), at(2), strict=True):
        assert np.linalg.norm(other - H) <= TWO_THREADS * np.linalg.norm(H)


def test_a_run_uses_one_blas_thread_whatever_its_caller_does():
    """With `direct`: two threads would change its digits here."""
    case = parse_case(RUNS["direct"], "tyre.toml", "tyre")
    expected = run_case(case, jobs=1)
    with threadpool_limits(limits=2, user_api="blas"):
        found = run_case(case, jobs=1)
    np.testing.assert_array_equal(found.receptance, expected.receptance)
    np.testing.assert_array_equal(found.residual, expected.residual)
