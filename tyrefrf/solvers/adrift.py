"""Lines of a tyre that nothing holds: its rigid motions by the balance of momentum.

Let R be the rigid motions, K R = 0. With D R = (i omega C - omega^2 M) R the part R a of the answer
follows from what no stiffness has a part in,

    R^T (i omega C - omega^2 M) q = R^T f,

however small omega is: far below the first mode the tyre moves as a body, q = -R (R^T M R)^-1 R^T f
/ omega^2. In the ring's equations that motion is multiplied by K, whose rounding soon exceeds the
load (at 0.01 Hz on the homogeneous tyre), so there it is taken out before they are solved.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import csc_array

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.solvers.cyclic import Cyclic
from tyrefrf.solvers.problem import Field, RingProblem, norms, ring_forces, watched

REMARK = "nothing holds the tyre: rigid motions by momentum, the rest by `cyclic`"

IN_BALANCE = 1e-13
"""Share of a field that its rigid motions may lack: rounding."""


def balanced(problem: RingProblem, field: Field, omega: float) -> Field:
    """The field with the rigid motions that balance momentum in place of those it has."""
    lack = _correction(problem, _ring_loads(problem), field.q, omega)
    if np.linalg.norm(lack) <= IN_BALANCE * np.linalg.norm(field.q):
        return field
    D = problem.cell.dynamic_stiffness(omega)
    checked = Field.checked(problem, D, field.q + lack)
    return replace(checked, residual=max(checked.residual, field.residual), remark=field.remark)


def parted(problem: RingProblem, omega: float) -> Field:
    """A line with its rigid motions apart, by `Cyclic`; omega > 0 [rad/s].

    One load more, that excites every mode, is solved for: see `watched`.
    """
    watching = watched(problem)
    f, D = _ring_loads(watching), problem.cell.dynamic_stiffness(omega)
    rows = _inertia(problem, omega)
    a = np.linalg.solve(_resistance(problem, omega), problem.rigid.against(problem.rigid.own, f))
    rest = f - problem.rigid.moved(rows, a)
    q = _displacements(problem, D, rest)
    q += _correction(problem, rest, q, omega)
    remainder = rest - ring_forces(problem, D, q)
    lack = norms(np.moveaxis(remainder, 1, 0)[problem.free]) / watching.load_sizes
    q += problem.rigid.moved(problem.rigid.own, a)
    return Field(q, remainder, float(np.max(lack)), REMARK).without_last()


def _displacements(problem: RingProblem, D: ComplexArray, f: ComplexArray) -> ComplexArray:
    """D^-1 f for complex forces f (n_cells, n_own, m): real loads are solved for, and combined."""
    parts = np.concatenate([f.real, f.imag], axis=2).reshape(problem.n_ring_dofs, -1)
    loaded = parts.any(axis=0)
    solver = Cyclic(replace(problem, loads=csc_array(parts[:, loaded]), sensors=None))
    q = np.zeros((*f.shape[:2], parts.shape[1]), complex)
    q[..., loaded] = solver.displacements(D)
    real, imaginary = np.split(q, 2, axis=2)
    return real + 1j * imaginary


def _ring_loads(problem: RingProblem) -> FloatArray:
    """The loads (n_cells, n_own, n_loads)."""
    return problem.loads.toarray().reshape(problem.n_cells, problem.cell.n_own, -1)


def _inertia(problem: RingProblem, omega: float) -> ComplexArray:
    """(n_own, 6) i omega C - omega^2 M of the ring times a rigid motion."""
    rigid = problem.rigid
    return 1j * omega * rigid.damping - omega**2 * rigid.inertia


def _resistance(problem: RingProblem, omega: float) -> ComplexArray:
    """R^T (i omega C - omega^2 M) R (k, k)."""
    rigid = problem.rigid
    return rigid.against(rigid.own, rigid.moved(_inertia(problem, omega), np.eye(rigid.count)))


def _correction(
    problem: RingProblem, f: ComplexArray | FloatArray, q: ComplexArray, omega: float
) -> ComplexArray:
    """The rigid motion that q lacks for the balance of momentum under forces f; all of the ring."""
    rigid = problem.rigid
    lack = rigid.against(rigid.own, f) - rigid.against(_inertia(problem, omega), q)
    return rigid.moved(rigid.own, np.linalg.solve(_resistance(problem, omega), lack))
