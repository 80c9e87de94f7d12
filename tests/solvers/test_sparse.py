"""Sparse symmetric systems, the count of their factors' entries, and the memory that these take."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rings import R, lopsided, omegas, tyre, with_steel_belt
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from tyrefrf.errors import SolveError
from tyrefrf.solvers import memory, mkl
from tyrefrf.solvers.direct import ring_matrix
from tyrefrf.solvers.memory import available_memory, check_memory, memory_needed
from tyrefrf.solvers.pardiso import PardisoSystem
from tyrefrf.solvers.sparse import Scattered, factor_entries, minimum_degree

needs_mkl = pytest.mark.skipif(
    not mkl.installed(), reason="MKL is not installed, PARDISO is NOT TESTED: pip install mkl"
)
every_library = pytest.mark.parametrize(
    "library", ["superlu", pytest.param("pardiso", marks=needs_mkl)]
)

RINGS = {
    "homogeneous": tyre(n_cells=12),
    "layers of steel": with_steel_belt(tyre(n_cells=12)),
    "quadratic": tyre("hex20r", n_cells=8, elements_along=8),
    "lopsided": lopsided(tyre(n_cells=7, elements_along=6, elements_around=3)),
    "one cell": tyre(n_cells=1, elements_along=6, elements_around=5),
    "two cells": lopsided(tyre(n_cells=2, elements_along=6, elements_around=4)),
}


def problem_of(ring):
    return ring.problem(ring.point_loads((0, 3, R)))


def superlu_factor(ring):
    """What SuperLU makes of the ring at 500 Hz, on its own."""
    matrix = ring_matrix(problem_of(ring))
    A = coo_array(
        (
            ring.cell.dynamic_stiffness(omegas(500.0)[0])[matrix.source],
            (matrix.rows, matrix.columns),
        ),
        shape=2 * (matrix.n,),
    )
    return splu(
        A.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


# --- patterns ---


@st.composite
def scattered(draw):
    """A symmetric matrix as a sum, with places that are hit more than once, and its values."""
    n = draw(st.integers(1, 8))
    below = st.tuples(st.integers(0, n - 1), st.integers(0, n - 1), st.integers(0, 3))
    drawn = draw(st.lists(below, max_size=20)) + [(k, k, 0) for k in range(n)]
    pairs = [(i, j, s) for i, j, s in drawn] + [(j, i, s) for i, j, s in drawn]
    rows, columns, source = (np.array(column) for column in zip(*pairs, strict=True))
    return Scattered(n, rows, columns, source)


VALUES = np.array([1.0 + 2.0j, -0.5, 3.0j, 0.25])


def full(matrix):
    A = np.zeros((matrix.n, matrix.n), complex)
    np.add.at(A, (matrix.rows, matrix.columns), VALUES[matrix.source])
    return A


@given(scattered())
def test_compressed_is_the_sum(matrix):
    pattern = matrix.compressed()
    A = pattern.of(pattern.entries(VALUES))
    np.testing.assert_allclose(A.toarray(), full(matrix), atol=1e-13)
    assert A.has_canonical_format


@given(scattered(), st.randoms())
def test_reordered_is_the_same_matrix_in_another_order(matrix, random):
    order = np.array(random.sample(range(matrix.n), matrix.n))
    np.testing.assert_array_equal(full(matrix.reordered(order)), full(matrix)[np.ix_(order, order)])


@given(scattered())
def test_upper_is_the_upper_triangle(matrix):
    np.testing.assert_array_equal(full(matrix.upper()), np.triu(full(matrix)))


# --- the count of the factor's entries ---


@pytest.mark.parametrize("name", RINGS)
def test_the_order_of_elimination_is_superlus(name):
    """So that what is counted is what will be factorised."""
    pattern = ring_matrix(problem_of(RINGS[name])).compressed()
    np.testing.assert_array_equal(
        np.argsort(minimum_degree(pattern)), superlu_factor(RINGS[name]).perm_c
    )


@pytest.mark.parametrize("name", RINGS)
def test_the_factors_entries_are_counted(name):
    pattern = ring_matrix(problem_of(RINGS[name])).compressed()
    counted = factor_entries(pattern, minimum_degree(pattern))
    assert counted == pytest.approx(superlu_factor(RINGS[name]).nnz, rel=1e-3)  # measured: equal


@needs_mkl
@pytest.mark.parametrize("name", RINGS)
def test_pardisos_factor_is_about_half_of_superlus(name):
    """L alone of L D L^T. It stores whole squares on the diagonal: twice as much on tiny rings."""
    entries = PardisoSystem(ring_matrix(problem_of(RINGS[name]))).factor_entries
    assert 0.8 < 2 * entries / superlu_factor(RINGS[name]).nnz < 1.9


@pytest.mark.long
@every_library
def test_the_memory_needed_is_what_a_process_takes(library):
    """Peak resident size of a process that solves three lines of the paper's tyre."""
    code = f"""
import resource
from rings import *
from tyrefrf.solvers import Direct
from tyrefrf.solvers.memory import memory_needed
ring = tyre("hex20r", n_cells=30)
problem = ring.problem(ring.point_loads((0, 3, R)))
solver = Direct(problem, {library!r})
for omega in omegas(100.0, 200.0, 300.0):
    solver.field(omega)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
print(memory_needed(problem, {library!r}))
"""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment
    )
    taken, needed = map(float, run.stdout.split())
    assert 1.0 / 1.5 < needed / taken < 1.5


# --- refused before the machine swaps ---


@every_library
def test_a_ring_that_does_not_fit_is_refused_with_both_numbers(library, monkeypatch):
    problem = problem_of(RINGS["homogeneous"])
    needed = memory_needed(problem, library)
    monkeypatch.setattr(memory, "available_memory", lambda: 2.5 * needed)

    check_memory(problem, library, jobs=2)
    with pytest.raises(SolveError) as error:
        check_memory(problem, library, jobs=3)

    assert f"{3 * needed / 1e9:.3g} GB" in str(error.value)
    assert f"{2.5 * needed / 1e9:.3g} GB are available" in str(error.value)
    assert "--jobs 2 would fit" in str(error.value)


def test_a_thousand_loads_more_take_a_thousand_fields_more():
    ring = RINGS["homogeneous"]
    one, many = (ring.problem(ring.point_loads(*[(0, 3, R)] * n)) for n in (1, 1001))
    more = memory_needed(many, "superlu") - memory_needed(one, "superlu")
    field = 16.0 * ring.n_dofs  # complex numbers
    assert 4 * 1000 * field < more < 16 * 1000 * field


def test_no_number_of_jobs_is_offered_where_none_fits(monkeypatch):
    monkeypatch.setattr(memory, "available_memory", lambda: 1000)
    with pytest.raises(SolveError, match="available: 'cyclic' and 'recursive'"):
        check_memory(problem_of(RINGS["homogeneous"]), "superlu", jobs=1)


def test_a_ring_whose_entries_do_not_fit_is_not_assembled_to_know_that(monkeypatch):
    problem = problem_of(RINGS["homogeneous"])
    needed = memory_needed(problem, "superlu")

    def refuse(problem):
        raise MemoryError

    monkeypatch.setattr(memory, "ring_matrix", refuse)
    monkeypatch.setattr(memory, "available_memory", lambda: 1000)
    monkeypatch.setattr(memory, "resident_now", lambda: 0)
    assert memory.PROCESS < memory_needed(problem, "superlu") < needed


def test_where_the_system_does_not_say_nothing_is_refused(monkeypatch):
    monkeypatch.setattr(memory, "available_memory", lambda: None)
    check_memory(problem_of(RINGS["homogeneous"]), "superlu", jobs=10**9)


MACHINE = {"proc/meminfo": "MemTotal: 16000 kB\nMemAvailable:    8000 kB\nSwapTotal: 0 kB\n"}
V2 = {
    "proc/self/cgroup": "0::/user/job\n",
    "sys/fs/cgroup/user/job/memory.max": "max\n",
    "sys/fs/cgroup/user/job/memory.current": "100\n",
    "sys/fs/cgroup/user/memory.max": "5000000\n",
    "sys/fs/cgroup/user/memory.current": "3000000\n",
    "sys/fs/cgroup/user/memory.stat": "anon 1\ninactive_file 1000000\n",
}
V1 = {
    "proc/self/cgroup": "4:cpu:/a\n3:memory:/job\n0::/\n",
    "sys/fs/cgroup/memory/job/memory.limit_in_bytes": "4000000\n",
    "sys/fs/cgroup/memory/job/memory.usage_in_bytes": "1500000\n",
    "sys/fs/cgroup/memory/job/memory.stat": "cache 7\ntotal_inactive_file 500000\n",
    "sys/fs/cgroup/memory/memory.limit_in_bytes": "9223372036854771712\n",
    "sys/fs/cgroup/memory/memory.usage_in_bytes": "1500000\n",
}
IN_A_CONTAINER = {  # the group's own path is not to be seen from inside
    "proc/self/cgroup": "0::/docker/0123\n",
    "sys/fs/cgroup/memory.max": "2000000\n",
    "sys/fs/cgroup/memory.current": "500000\n",
}


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        ({}, None),
        ({"proc/meminfo": "MemTotal: 16000 kB\n"}, None),
        (MACHINE, 8_192_000),
        (MACHINE | V2, 3_000_000),
        (MACHINE | V1, 3_000_000),
        (MACHINE | IN_A_CONTAINER, 1_500_000),
    ],
    ids=["no Linux", "old kernel", "machine", "cgroup v2", "cgroup v1", "container"],
)
def test_available_memory_is_the_least_of_the_machines_and_the_groups(tmp_path, files, expected):
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)

    assert available_memory(tmp_path) == expected


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux says")
def test_this_machine_has_some_memory():
    assert 1e7 < available_memory() < 1e14
