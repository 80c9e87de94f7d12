"""The paper's method: condense the cell, join by doubling, close the ring, look back inside."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tyrefrf.arrays import ComplexArray
from tyrefrf.errors import SingularError
from tyrefrf.solvers.chain import Chain, Chains, join
from tyrefrf.solvers.condense import Condenser, Interior
from tyrefrf.solvers.cyclic import Cyclic
from tyrefrf.solvers.factor import factorise
from tyrefrf.solvers.problem import Field, RingProblem

RESIDUAL_TRUSTED = 1e-8
"""Residual up to which the recursion's own answer stands. Near an undamped resonance of a chain
it loses digits long before a condition estimate calls the face singular."""


class Recursive:
    """[3]-[5], [16]-[18] and [19]-[22] of the paper, for loads in any sections and cells.

    Sections that carry a load are kept while the chains between them are built; all others come
    back from the joints' own factors. Where a chain with fixed ends resonates without damping,
    its face cannot be eliminated, and near that only with loss of digits: such a line is solved
    by `Cyclic`, and says so.
    """

    exact = True

    def __init__(self, problem: RingProblem) -> None:
        self.problem = problem
        self._condense = Condenser(problem.cell)
        self._spare = Cyclic(problem)
        free = problem.free
        n, n_face = self._condense.n_face, problem.cell.n_face
        loads = problem.load_cells()
        self._f_L = {c: f[:n_face][free[:n_face]] for c, f in loads.items()}
        self._f_I = {c: f[n_face:][free[n_face:]] for c, f in loads.items()}
        self._zero = np.zeros((n, problem.n_loads), complex)

    def field(self, omega: float) -> Field:
        """Solve one line; omega [rad/s]. Raises SingularError if the ring itself resonates."""
        problem = self.problem
        try:
            q = self._solve(problem.cell.dynamic_stiffness(omega))
            field = Field.checked(problem, omega, q)
            if field.residual <= RESIDUAL_TRUSTED:
                return field
            why = f"a chain of cells nearly resonates here (residual {field.residual:.0e})"
        except SingularError:
            why = "a chain of cells resonates undamped here"
        return replace(self._spare.field(omega), remark=f"{why}: solved by `cyclic`")

    def _solve(self, D: ComplexArray) -> ComplexArray:
        """Displacements (n_cells, n_own, n_loads) from the cell's dynamic stiffness entries."""
        cell, interior = self._condense(D)
        inside = {c: interior.factor.solve(f) for c, f in self._f_I.items() if np.any(f)}
        forces = self._face_forces(interior, inside)
        faces = ring_faces(Chains(cell), self.problem.n_cells, forces)
        return self._with_interior(faces, interior, inside)

    def _face_forces(
        self, interior: Interior, inside: dict[int, ComplexArray]
    ) -> dict[int, ComplexArray]:
        """Forces (n, n_loads) by loaded section; a load inside a cell acts on both its faces."""
        forces = {c: f.copy() for c, f in self._f_L.items() if np.any(f)}
        for c, x in inside.items():
            right = (c + 1) % self.problem.n_cells
            forces[c] = forces.get(c, self._zero) - interior.D_LI @ x
            forces[right] = forces.get(right, self._zero) - interior.D_RI @ x
        return forces

    def _with_interior(
        self, faces: ComplexArray, interior: Interior, inside: dict[int, ComplexArray]
    ) -> ComplexArray:
        """The cells' own dofs, fixed ones zero, from the faces' (n_cells, n, n_loads): [3]."""
        problem = self.problem
        right = np.roll(faces, -1, axis=0)
        inner = -(interior.X_L @ faces + interior.X_R @ right)
        for c, x in inside.items():
            inner[c] += x
        q = np.zeros((problem.n_cells, problem.cell.n_own, problem.n_loads), complex)
        q[:, problem.free] = np.concatenate([faces, inner], axis=1)
        return q


def ring_faces(chains: Chains, n_cells: int, forces: dict[int, ComplexArray]) -> ComplexArray:
    """Displacements (n_cells, n, n_loads) of all sections of a ring under forces on some of them.

    forces: (n, n_loads) [N] by section, at least one. The ring is cut at the first of them; the
    chains between the others are joined and their loaded faces eliminated with their forces, and
    D_tot q = F closes the ring: [19]-[22], with F the force applied to the tyre.
    Raises SingularError if a chain with fixed ends, or the ring, resonates without damping.
    """
    kept = sorted(forces)
    lengths = np.diff([*kept, kept[0] + n_cells])
    segments = [chains.of(int(m)) for m in lengths]

    chain = segments[0]
    g_L, g_R = forces[kept[0]], np.zeros_like(forces[kept[0]])
    steps: list[
        tuple[Chain, ComplexArray]
    ] = []  # the chain up to each kept face, and its q at rest
    for section, segment in zip(kept[1:], segments[1:], strict=True):
        joined = join(chain, segment)
        assert joined.joint is not None
        x = joined.joint.factor.solve(forces[section] + g_R)
        g_L, g_R = g_L - chain.LR @ x, -segment.LR.T @ x
        steps.append((joined, x))
        chain = joined

    D_tot = chain.LL + chain.LR + chain.LR.T + chain.RR
    q_cut = factorise(D_tot).solve(g_L + g_R)

    q_kept = [q_cut]
    for joined, x in reversed(steps):
        assert joined.joint is not None
        q_kept.append(x + joined.joint.shared_face(q_cut, q_kept[-1]))
    q_kept = [q_cut, *reversed(q_kept[1:]), q_cut]

    faces = np.empty((n_cells, *q_cut.shape), complex)
    for section, segment, q_L, q_R in zip(kept, segments, q_kept, q_kept[1:], strict=False):
        between = np.arange(section, section + segment.n_cells) % n_cells
        faces[between[0]] = q_L
        faces[between[1:]] = segment.inner_faces(q_L, q_R)
    return faces
