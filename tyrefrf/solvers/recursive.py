"""The paper's method: condense the cell, join by doubling, close the ring, look back inside."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from tyrefrf.arrays import ComplexArray
from tyrefrf.errors import SingularError
from tyrefrf.solvers.chain import Chain
from tyrefrf.solvers.condense import Condenser, Interior
from tyrefrf.solvers.cyclic import Cyclic
from tyrefrf.solvers.mirror import MirrorChain
from tyrefrf.solvers.problem import Field, RingProblem, needs_watch, watched
from tyrefrf.solvers.ring import MOST_CHAINS, operations, ring_faces
from tyrefrf.solvers.symmetry import UNTOUCHED, Share, mapped, shares, whole

RESIDUAL_TRUSTED = 1e-8
"""Residual up to which the recursion's own answer stands. Near an undamped resonance of a chain
it loses digits long before a condition estimate calls the face singular."""


class Recursive:
    """[3]-[5], [16]-[18] and [19]-[22] of the paper, for loads in any sections and cells.

    The ring looks the same from every section: each load's answer is that of the load moved to
    the first section, turned back. All other sections come back from the joints' own factors.
    Where a chain with fixed ends resonates without damping, its face cannot be eliminated, and
    near that only with loss of digits: such a line is solved by `Cyclic`, and says so.

    symmetries: whether those of the cell are looked for. most_chains: that the ring may be closed
    from. Without symmetries, and with one chain, it is done as the paper writes it.
    """

    exact = True

    def __init__(
        self, problem: RingProblem, *, symmetries: bool = True, most_chains: int = MOST_CHAINS
    ) -> None:
        self.problem, self.symmetries, self.most_chains = problem, symmetries, most_chains
        self._condense = Condenser(problem.cell)
        self._shares = shares(problem.cell) if symmetries else (whole(problem.cell),)
        free = problem.free
        n, n_face = self._condense.n_face, problem.cell.n_face
        loads = problem.load_cells()
        self._f_L = {c: f[:n_face][free[:n_face]] for c, f in loads.items()}
        self._f_I = {c: f[n_face:][free[n_face:]] for c, f in loads.items()}
        self._zero = np.zeros((n, problem.n_loads), complex)

    @property
    def operations(self) -> float:
        """Of a line's joins and closings, all shares together."""
        N, most = self.problem.n_cells, self.most_chains
        kinds = [(Chain if s.n_even is None else MirrorChain, s.Q.shape[1]) for s in self._shares]
        return sum(operations(kind, n, N, most) for kind, n in kinds)

    def field(self, omega: float) -> Field:
        """Solve one line; omega [rad/s]. Raises SingularError if the ring itself resonates."""
        D = self.problem.cell.dynamic_stiffness(omega)
        try:
            field = self._checked(D, omega)
            if field.residual <= RESIDUAL_TRUSTED:
                return field
            why = f"a chain of cells nearly resonates here (residual {field.residual:.0e})"
        except SingularError:
            why = "a chain of cells resonates undamped here"
        return replace(self._spare.field(omega), remark=f"{why}: solved by `cyclic`")

    @cached_property
    def _spare(self) -> Cyclic:
        """Made for the first line that needs it; few tyres have one."""
        return Cyclic(self.problem)

    def _checked(self, D: ComplexArray, omega: float) -> Field:
        """The recursion's field, with one load more where proof needs it: see `needs_watch`."""
        if not needs_watch(self.problem, D, omega):
            return Field.checked(self.problem, D, self._solve(D))
        watching = self._watching
        return Field.checked(watching.problem, D, watching._solve(D)).without_last()

    @cached_property
    def _watching(self) -> Recursive:
        return Recursive(
            watched(self.problem), symmetries=self.symmetries, most_chains=self.most_chains
        )

    def _solve(self, D: ComplexArray) -> ComplexArray:
        """Displacements (n_cells, n_own, n_loads) from the cell's dynamic stiffness entries."""
        cell, interior = self._condense(D)
        inside = {c: interior.factor.solve(f) for c, f in self._f_I.items() if np.any(f)}
        faces = self._faces(cell, self._face_forces(interior, inside))
        return self._with_interior(faces, interior, inside)

    def _faces(self, cell: Chain, forces: dict[int, ComplexArray]) -> ComplexArray:
        """Displacements (n_cells, n, n_loads) of all sections, each share of motions by itself."""
        F = np.hstack(list(forces.values()))
        q = np.zeros((self.problem.n_cells, *F.shape), complex)
        for share in self._shares:
            f = share.Q.T @ F
            excited = np.linalg.norm(f, axis=0) > UNTOUCHED * np.linalg.norm(F, axis=0)
            if np.any(excited):
                part = share_of(cell, share)
                own = ring_faces(part, len(q), f[:, excited], self.most_chains)
                q[:, :, excited] += np.moveaxis(mapped(share.Q, np.moveaxis(own, 0, 1)), 1, 0)
        moved = np.split(q, len(forces), axis=2)
        turned = [np.roll(there, c, axis=0) for c, there in zip(forces, moved, strict=True)]
        return np.sum(turned, axis=0)

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


def share_of(cell: Chain, share: Share) -> Chain | MirrorChain:
    """A cell's stiffness for a share of the section's motions."""
    Q = share.Q
    LL, LR = (Q.T @ (block @ Q) for block in (cell.LL, cell.LR))
    if share.n_even is None:
        return Chain(1, LL, LR, Q.T @ (cell.RR @ Q))
    return MirrorChain(1, LL, LR, share.n_even)
