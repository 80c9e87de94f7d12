"""What a solver keeps in memory on a line, known before it is made."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.solvers.chain import Chain
from tyrefrf.solvers.memory import PROCESS, memory_needed
from tyrefrf.solvers.mirror import MirrorChain
from tyrefrf.solvers.modal import DEFAULT_MODES
from tyrefrf.solvers.modes import Pencils
from tyrefrf.solvers.problem import RingProblem
from tyrefrf.solvers.ring import MOST_CHAINS, n_chains, steps
from tyrefrf.solvers.symmetry import Share, shares

if TYPE_CHECKING:
    from tyrefrf import case

COMPLEX = 16.0  # bytes
FIXED = 8e6
"""Of the libraries that a first line loads, and of what is small."""
FIELDS = 8.0
"""Fields of the ring's dofs under all loads at once: displacements, both sides of their equations,
and copies in another order. Measured: 7 to 8."""
COLUMNS = 3.3
"""The same of the recursion, where every loaded section has a column for every load."""
PER_ENTRY = {"recursive": 60.0, "cyclic": 350.0, "modal": 200.0, "waves": 500.0}
"""Bytes per entry of the cell's pattern: values, and where each goes. Measured on 12e3 to 9e5."""
OF_JOINT = {Chain: 5.0, MirrorChain: 3.7}
"""Matrices of a chain that are kept for the way back, and"""
AT_WORK = 6.0
"""those that a join works with."""
DENSE = 4.0
"""Matrices of the cell's own dofs, where modes are found by value."""
SHAPES = 3.0
"""Sets of shapes at once: those found, projected, and turned."""


def line_memory(problem: RingProblem, choice: case.Solver) -> float:
    """Peak bytes of a process that solves lines of this ring, beside the process and the problem.

    Costs a fraction of a line; `modal` with a cut-off counts its modes.
    """
    return FIXED + _OF[choice.name](problem, choice)


def waves_memory(problem: RingProblem) -> float:
    """The same of one that finds the free waves of its cell."""
    n = int(problem.free.sum())
    return FIXED + 2.5 * DENSE * COMPLEX * n**2 + PER_ENTRY["waves"] * _entries(problem)


def modes_memory(problem: RingProblem, n_modes: float) -> float:
    """The same of one that finds so many natural modes of the ring, both of each pair counted."""
    own = float(problem.free.sum())
    per_order = min(n_modes / problem.n_cells, own)
    shapes = COMPLEX * own * per_order * (problem.n_cells // 2 + 1)
    dense = DENSE * COMPLEX * own**2
    return FIXED + dense + SHAPES * shapes + PER_ENTRY["modal"] * _entries(problem)


def _recursive(problem: RingProblem, choice: case.Solver) -> float:
    n = int(problem.free[: problem.cell.n_face].sum())
    inner = int(problem.free.sum()) - n
    condensed = (2 * n + inner) ** 2 + inner**2 + 6 * inner * n + 3 * n**2
    joined = max(_of_share(problem, share) for share in shares(problem.cell))
    loaded = {int(cell) for cell in problem.forces[0]}
    if inner and np.any(problem.forces[1] >= problem.cell.n_face):
        loaded |= {(cell + 1) % problem.n_cells for cell in loaded}
    n_loads = _watched_loads(problem)
    columns = problem.n_cells * n * n_loads * (len(loaded) + n_loads - problem.n_loads)
    fields = max(FIELDS * problem.n_cells * problem.cell.n_own * n_loads, COLUMNS * columns)
    entries = PER_ENTRY["recursive"] * _entries(problem)
    return COMPLEX * (condensed + joined + fields) + entries


def _of_share(problem: RingProblem, share: Share) -> float:
    """Numbers in the chains that are joined for a share of the section's motions."""
    kind = Chain if share.n_even is None else MirrorChain
    costs = kind.DOUBLE, kind.JOIN
    k = n_chains(problem.n_cells, *costs, MOST_CHAINS)
    joints = len(steps(problem.n_cells // k, *costs))
    return float(share.Q.shape[1] ** 2 * (3.0 + OF_JOINT[kind] * joints + AT_WORK))


def _cyclic(problem: RingProblem, choice: case.Solver) -> float:
    return _fields(problem) + PER_ENTRY["cyclic"] * _entries(problem)


def _direct(problem: RingProblem, choice: case.Solver) -> float:
    return memory_needed(problem, choice.library) - PROCESS


def _modal(problem: RingProblem, choice: case.Solver) -> float:
    n_modes: float = choice.modes or DEFAULT_MODES
    if choice.cutoff is not None:
        below = 2.0 * np.pi * choice.cutoff
        n_modes = Pencils(problem.cell, problem.n_cells, below / 2.0).count_below(below)
    own, n_orders = float(problem.free.sum()), problem.n_cells // 2 + 1
    per_order = min(n_modes / problem.n_cells, own)
    projected = n_orders * (4 + len(problem.cell.K)) * per_order**2
    corrected = _cyclic(problem, choice) if choice.static_correction else 0.0
    return modes_memory(problem, n_modes) + COMPLEX * projected + _fields(problem) + corrected


def _fields(problem: RingProblem) -> float:
    return FIELDS * COMPLEX * problem.n_ring_dofs * _watched_loads(problem)


def _watched_loads(problem: RingProblem) -> int:
    """Columns that are solved for: one more where no loss makes the answer unique."""
    lossless = not np.any(problem.cell.dynamic_stiffness(1.0).imag)
    return problem.n_loads + lossless


def _entries(problem: RingProblem) -> int:
    return len(problem.cell.indices)


_OF = {"recursive": _recursive, "cyclic": _cyclic, "direct": _direct, "modal": _modal}
