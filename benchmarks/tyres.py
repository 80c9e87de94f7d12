"""What is timed: the paper's two tyres, two loads, and what solves a line of them.

The loads are unit forces at a node of the outer surface. The first is radial at mid-tread: it
excites one of the halves of motions into which a tyre that mirrors in y falls, and the ring's
mirror keeps it. The second leans in all three directions and stands beside the mid-plane: it
excites both halves, and no symmetry makes any order's answer follow from another's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.sparse import csc_array

from tyrefrf.arrays import ComplexArray
from tyrefrf.case import Case, NodeLoad, Solver, builtin_text, parse_case, starter_text
from tyrefrf.solvers import Cyclic, Direct, Recursive, RingProblem, mkl
from tyrefrf.solvers import Solver as LineSolver
from tyrefrf.solvers.direct import ring_matrix
from tyrefrf.solvers.mkl import Pardiso
from tyrefrf.solvers.sparse import minimum_degree, solve_sparse
from tyrefrf.study.model import build_model

OMEGA = 2.0 * np.pi * 700.0
"""[rad/s] of the line that is timed; the operations are the same at every line."""

MID_TREAD, OBLIQUE = "radial, mid-tread", "oblique, beside it"
LOADS = {MID_TREAD: (0.5, ("r",)), OBLIQUE: (0.42, ("r", "y", "theta"))}
"""Place s along the outer surface, and the directions in which a load leans alike."""

Line = Callable[[], ComplexArray]
"""Solves a line: displacements (N, n_own, n_loads) of the whole ring [m/N]."""


def tyres() -> dict[str, Case]:
    """The paper's homogeneous and its layered tyre (sections 3.2 and 3.3)."""
    return {
        "homogeneous": parse_case(starter_text(), "starter", "homogeneous"),
        "layered": parse_case(builtin_text(), "built-in", "layered"),
    }


def problem_under(case: Case, load: str) -> RingProblem:
    """The case's ring under one of `LOADS`."""
    s, directions = LOADS[load]
    parts = tuple(NodeLoad.model_validate({"name": d, "s": s, "direction": d}) for d in directions)
    problem = build_model(case.model_copy(update={"loads": parts})).problem
    lean = np.full((len(parts), 1), len(parts) ** -0.5)
    return replace(problem, loads=csc_array(problem.loads @ lean))


def with_cells(case: Case, n_cells: int) -> Case:
    """The same section in another number of cells, one element around in each."""
    cell = case.cell.model_copy(update={"sector_angle": 360.0 / n_cells, "elements_around": 1})
    return case.model_copy(update={"cell": cell})


def with_elements(case: Case, along: int, through: int) -> Case:
    """The same section in so many elements from rim to rim, and through the wall."""
    changes = {"elements_along": along, "elements_through": through}
    assert case.geometry is not None
    return case.model_copy(update={"geometry": case.geometry.model_copy(update=changes)})


def with_lines(case: Case, count: int, *, adaptive: bool = False) -> Case:
    """The case with so many lines from 0 to 2000 Hz."""
    changes = {"start": 0.0, "stop": 2000.0, "step": None, "count": count, "values": None}
    frequency = case.frequency.model_copy(update={**changes, "adaptive": adaptive})
    return case.model_copy(update={"frequency": frequency})


def with_solver(case: Case, name: str) -> Case:
    """The case with another solver."""
    return case.model_copy(update={"solver": Solver.model_validate({"name": name})})


def size_of(problem: RingProblem) -> str:
    """Section and ring in words."""
    return f"{section_dofs(problem)} dofs, {problem.n_cells} cells"


def section_dofs(problem: RingProblem) -> int:
    """Dofs of a section that move."""
    return int(problem.free[: problem.cell.n_face].sum())


def plain(problem: RingProblem) -> Recursive:
    """The recursion as the paper writes it: no symmetries, one chain all around."""
    return Recursive(problem, symmetries=False, most_chains=1)


SOLVERS: dict[str, Callable[[RingProblem], LineSolver]] = {
    "recursive": Recursive,
    "cyclic": Cyclic,
    "plain": plain,
    "direct": Direct,
}
"""Solvers whose line is everything: D formed and solved, the field of all sections, its residual.

Each is built once; what it needs to know of the pattern (symmetries, orderings, the analysis of a
sparse library) is found then, and not timed."""


def line_of(solver: str, problem: RingProblem) -> Line:
    """A line by one of `SOLVERS`."""
    built = SOLVERS[solver](problem)
    return lambda: built.field(OMEGA).q


def library_line(library: str, problem: RingProblem) -> Line:
    """The line by a sparse library alone: the full ring factorised and substituted.

    Analysis, order of elimination and the filling of the matrix are done here: what is timed is
    nothing but the library's work, the least that a line by it could take.
    """
    moves = np.tile(problem.free, problem.n_cells)
    f = problem.loads.toarray()[moves].astype(complex)
    solve = ALONE[library](problem, f)

    def line() -> ComplexArray:
        q = np.zeros((problem.n_ring_dofs, problem.n_loads), complex)
        q[moves] = solve()
        return q.reshape(problem.n_cells, problem.cell.n_own, -1)

    return line


def _pardiso(problem: RingProblem, f: ComplexArray) -> Line:
    """MKL PARDISO, complex symmetric (mtype 6)."""
    upper = ring_matrix(problem).upper().compressed()
    entries = upper.entries(problem.cell.dynamic_stiffness(OMEGA))
    pardiso = Pardiso(upper.indptr, upper.indices)
    return lambda: pardiso.solve(entries, f)


def _superlu(problem: RingProblem, f: ComplexArray) -> Line:
    """SuperLU as scipy has it, in symmetric mode."""
    matrix = ring_matrix(problem)
    order = minimum_degree(matrix.compressed())
    pattern = matrix.reordered(order).compressed()
    A = pattern.of(pattern.entries(problem.cell.dynamic_stiffness(OMEGA)))
    back = np.argsort(order)
    return lambda: solve_sparse(A, f[order], ordering="NATURAL")[back]


ALONE = {"PARDISO": _pardiso, "SuperLU": _superlu}


def libraries() -> tuple[str, ...]:
    """The sparse libraries that are installed here, the fastest first."""
    return tuple(name for name in ALONE if name != "PARDISO" or mkl.installed())


def lines_of(names: tuple[str, ...], problem: RingProblem) -> dict[str, Line]:
    """Lines by solvers and by libraries alone, by their names."""
    return {
        name: (library_line if name in ALONE else line_of)(name, problem)
        for name in names
        if name not in ALONE or name in libraries()
    }
