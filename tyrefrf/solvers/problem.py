"""The question that every solver answers: a ring of equal cells, its loads and its probes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy.sparse import csc_array, hstack

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from tyrefrf.errors import SolveError
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.solvers.modes import Pencils
from tyrefrf.solvers.rigid import RigidMotions
from tyrefrf.solvers.sensors import Sensors

RESIDUAL_MAX = 1e-6
"""A line's residual above which it counts as unsolved. Damped tyres stay below 4e-9 (steel belt;
homogeneous: 1e-12), an undamped resonance of the ring on the line gives 0.02 to 3."""

SOFTNESS = (2e-9, 2e-8, 2e-7)
"""omega_r^2 of a mode over the largest diagonal of K over M: steps in which the least is known."""
BLIND = 1e-10
"""Of that times the loss factor, where a damped tyre's answer may be wrong by more than its
residual tells. Rounding moves it by some 1e-15 over this: measured 4e-8 at a residual of 9e-14, at
3 Hz on a block of tread that hangs by one edge. The least of the paper's layered tyre is 4.7e-10,
of its homogeneous one 4e-7; a mechanism has zero."""
LOSSY_SHARE = 0.9
"""Share of the dofs that lose as much, for a tyre to count as losing it: where a single damper
acts, the others lose nothing. Of the paper's layered tyre, 0.024 are in the steel, and do not."""
SAMPLED = 12  # orders, crowded towards 0, at which soft motions are looked for


@dataclass(frozen=True, eq=False)
class RingProblem:
    """N equal cells around the axle, with loads and probes as sparse columns.

    The ring's dofs are the cells' own dofs (left section and interior), cell after cell: row
    `cell * cell.n_own + dof`, N * n_own in all, fixed ones included.
    loads: (rows, n_loads) nodal forces [N] of every unit load; what acts on a fixed dof goes
        straight into the rim.
    probes: (rows, n_probes) weights. On a free dof a weight takes the displacement, on a fixed
    dof the force that the tyre exerts on the rim (blocked force).
    sensors: masses whose places are the last of the loads and of the probes; their effect is in
        the answers, in which those loads and probes are not.
    """

    cell: CellMatrices
    n_cells: int
    loads: csc_array
    probes: csc_array
    sensors: Sensors | None = None

    def __post_init__(self) -> None:
        moves = np.tile(self.free, self.n_cells)
        if not np.all(abs(self.loads).T @ moves):
            raise SolveError("a load acts on nothing but the rim, which is fixed")

    @property
    def free(self) -> BoolArray:
        """(n_own,) the cell's own dofs that move."""
        return ~self.cell.fixed[: self.cell.n_own]

    @property
    def n_loads(self) -> int:
        """Columns to solve for."""
        return int(self.loads.shape[1])

    @property
    def shape(self) -> tuple[int, int]:
        """Probes and loads of an answer: all but the sensors' places."""
        hidden = self.sensors.n_columns if self.sensors else 0
        return int(self.probes.shape[1]) - hidden, self.n_loads - hidden

    @property
    def n_ring_dofs(self) -> int:
        """Dofs of the whole ring, fixed ones included."""
        return self.n_cells * self.cell.n_own

    @cached_property
    def forces(self) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
        """Cell, own dof, load and force [N] of everything that acts, in arrays of equal length."""
        loads = self.loads.tocoo()
        loads.sum_duplicates()
        cell, dof = np.divmod(loads.row, self.cell.n_own)
        return cell, dof, loads.col, loads.data

    @cached_property
    def rigid(self) -> RigidMotions:
        """The rigid motions that nothing holds; mostly none."""
        return RigidMotions.of(self.cell, self.n_cells)

    @cached_property
    def softness(self) -> float:
        """The largest of `SOFTNESS` that no mode is below, in a sample of the orders; or zero."""
        pencils, n_orders = Pencils(self.cell, self.n_cells), 1 + self.n_cells // 2
        sample = np.unique(np.geomspace(1, n_orders, SAMPLED).astype(int) - 1)
        softness = 0.0
        for step in SOFTNESS:
            below = float(np.sqrt(step * pencils.of(0).scale))
            if any(pencils.of(int(h)).count_below(below) for h in sample):
                break
            softness = step
        return softness

    @cached_property
    def diagonal(self) -> tuple[IntArray, FloatArray]:
        """Which entries (nnz,) of the cell's stand on the diagonal, and their static stiffness.

        Of the dofs that move.
        """
        cell = self.cell
        entries = np.flatnonzero((cell.rows == cell.indices) & ~cell.fixed[cell.rows])
        return entries, np.abs(cell.static[entries])

    @cached_property
    def load_sizes(self) -> FloatArray:
        """(n_loads,) norms [N] of what acts on dofs that move."""
        _, dof, load, f = self.forces
        return np.sqrt(np.bincount(load, np.abs(f) ** 2 * self.free[dof], self.n_loads))

    def load_cells(self) -> dict[int, ComplexArray]:
        """Forces (n_own, n_loads) by cell, of the cells that carry any."""
        shape = self.cell.n_own, self.n_loads
        found = {int(c): np.zeros(shape, complex) for c in np.unique(self.forces[0])}
        for cell, dof, load, force in zip(*self.forces, strict=True):
            found[int(cell)][dof, load] = force
        return found


def needs_watch(problem: RingProblem, D: ComplexArray, omega: float) -> bool:
    """Whether a line's answer may hold motions that its loads' own residual does not tell.

    So where modes that lose next to nothing may resonate, and where some have next to no stiffness.
    D: entries (nnz,) of the cell's dynamic stiffness at omega [rad/s].
    """
    return omega == 0.0 or problem.softness * loss_factor(problem, D) < BLIND


def loss_factor(problem: RingProblem, D: ComplexArray) -> float:
    """What most of the tyre loses, relative to its static stiffness: see `LOSSY_SHARE`."""
    entries, stiffness = problem.diagonal
    losses = np.sort(np.abs(D[entries].imag) / stiffness)
    return float(losses[int((1.0 - LOSSY_SHARE) * len(losses))])


def watched(problem: RingProblem) -> RingProblem:
    """The same problem with one load more: forces without any symmetry all over the first cell.

    A mode that no load excites, by symmetry, leaves no trace in the loads' residuals where it
    resonates undamped, and yet an arbitrary amount of it may be in the answer (measured: up to 300
    times the answer, at a residual of 4e-12). This load excites every mode: its residual tells.
    So does it of motions with next to no stiffness, and of a mechanism's at 0 Hz, damped or not.
    """
    force = np.zeros((problem.n_ring_dofs, 1))
    moves = np.flatnonzero(problem.free)
    force[moves, 0] = np.random.default_rng(0).normal(size=len(moves))
    return replace(problem, loads=csc_array(hstack([problem.loads, csc_array(force)])))


@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """Displacements of the whole ring under every load, checked against the ring's equations.

    q: (n_cells, n_own, n_loads) [m/N], zero where fixed.
    remainder: f - D q, of the same shape: rounding where the tyre moves, what goes into the rim
        where it is fixed.
    residual: ||f - D q|| / ||f|| over the dofs that move, the worst load's; also of a load that a
        solver adds to be warned by it.
    remark: what was special about how it was found; mostly "".
    """

    q: ComplexArray
    remainder: ComplexArray
    residual: float
    remark: str = ""

    @classmethod
    def checked(cls, problem: RingProblem, D: ComplexArray, q: ComplexArray) -> Field:
        """A solver's q with what the uncondensed equations say of it.

        D: entries (nnz,) of the cell's dynamic stiffness on this line.
        """
        remainder = -ring_forces(problem, D, q)
        cell, dof, load, f = problem.forces
        remainder[cell, dof, load] += f
        lack = norms(np.moveaxis(remainder, 1, 0)[problem.free])
        return cls(q, remainder, float(np.max(lack / problem.load_sizes)))

    def without_last(self) -> Field:
        """The field of all loads but the last, with the residual of all."""
        return replace(self, q=self.q[..., :-1], remainder=self.remainder[..., :-1])


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """One frequency line's answer.

    receptance: `problem.shape` [m/N]; blocked-force probes [N/N].
    residual: ||f - D q|| / ||f|| of the ring's equations, the worst load's.
    remark: the field's.
    """

    receptance: ComplexArray
    residual: float
    remark: str = ""


class Solver(Protocol):
    """Built once from the problem, asked once per line.

    exact: whether it solves the ring's equations to rounding; one that is truncated reports its
    residual, and is not judged by it.
    """

    @property
    def exact(self) -> bool:
        """See above."""
        ...

    def field(self, omega: float) -> Field:
        """Solve one line. Raises SingularError where the equations have no unique answer."""
        ...


def no_answer(problem: RingProblem, reason: str) -> Line:
    """A line that failed."""
    nowhere = np.full(problem.shape, complex(np.nan, np.nan))
    return Line(nowhere, float("nan"), reason)


def responses(problem: RingProblem, field: Field, omega: float) -> ComplexArray:
    """What the probes see of a field at omega [rad/s]: displacements, and forces on the rim.

    (n_probes, n_loads), with the sensors' masses if there are any. Raises SolveError as they do.
    """
    seen = np.where(problem.free[:, None], field.q, field.remainder)
    H: ComplexArray = problem.probes.T @ seen.reshape(problem.n_ring_dofs, -1)
    return problem.sensors.seen(H, omega) if problem.sensors else H


def ring_forces(problem: RingProblem, D: ComplexArray, q: ComplexArray) -> ComplexArray:
    """D q of the whole ring, cell by cell, from uncondensed matrices: (n_cells, n_own, n_loads).

    Works dof by dof, all cells at once, as does q where it is a view of such an array.
    """
    cell = problem.cell
    own = np.moveaxis(q, 1, 0)
    both = np.concatenate([own, np.roll(own[: cell.n_face], -1, axis=1)])
    G = (cell.sparse(D) @ both.reshape(cell.n_dofs, -1)).reshape(both.shape)
    forces = G[: cell.n_own]
    forces[: cell.n_face] += np.roll(G[cell.n_own :], 1, axis=1)
    return np.moveaxis(forces, 0, 1)


def norms(x: ComplexArray) -> FloatArray:
    """(k,) of the columns of x (..., k)."""
    columns = x.reshape(-1, x.shape[-1])
    return np.sqrt(np.einsum("nk,nk->k", columns.conj(), columns).real)
