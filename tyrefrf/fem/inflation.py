"""The static shape under internal pressure, and the stiffness about it: section 3.1 of the paper.

The cell is solved with equal displacements of both sections in cylindrical dofs, which is all
that the paper's condition on the end sections says. Linear: one step, every matrix on the shape
at rest (the paper's). Nonlinear: Newton's method, every matrix on the deformed shape.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.errors import SolveError
from tyrefrf.fem.assembly import CellMatrices, Pattern, dofs_of
from tyrefrf.fem.elasticity import VOIGT
from tyrefrf.fem.elements import Element
from tyrefrf.fem.frames import axes, rotations, turned
from tyrefrf.fem.orientation import layer_axes
from tyrefrf.fem.pressure import pressure_forces, pressure_stiffness
from tyrefrf.fem.prestress import TENSOR, Deformed, geometric_stiffness
from tyrefrf.fem.relaxation import Reassembly, Relaxation
from tyrefrf.fem.statics import PeriodicCell
from tyrefrf.mesh.cell import CellMesh

CONVERGED = 1e-10  # ||f - f_int|| / ||f|| of a Newton iteration
MAX_ITERATIONS = 15  # of a load step; the paper's tyre at 2 bar takes seven
SMALLEST_STEP = 1.0 / 256.0  # of the pressure
DIVERGED = 1e6  # residual at which a step is given up
"""A thin wall's first full step overshoots: its residual grows some 30 times before it falls
quadratically, so no line search on the residual; a step that fails is halved."""


@dataclass(frozen=True, slots=True)
class LoadStep:
    """One converged step of the inflation.

    share: of the pressure, reached. iterations: Newton's. residual: ||f - f_int|| / ||f||.
    """

    share: float
    iterations: int
    residual: float


@dataclass(frozen=True, slots=True, eq=False)
class Inflation:
    """A cell at rest under pressure.

    displacement: (n_nodes, 3) in (r, y, theta) [m].
    stress: (e, 6) mean stress of every brick in the axes (r, y, theta) of its middle, in the
        order rr, yy, tt, ry, yt, tr [Pa]; nonlinear: second Piola-Kirchhoff.
    resultant: (3,) pressure force on the cell in the axes (r, y, theta) of its middle [N].
    steps: how it converged.
    K, relaxation: by material where they are others than at rest: material stiffness about the
        state, and what becomes of it at a frequency; K_G, K_P: all as in `CellMatrices`.
    K_static: (nnz,) material stiffness about the state with the moduli that carry the pressure.
    strain: the largest principal one, where it is taken as small; NaN where it is not.
    """

    displacement: FloatArray
    stress: FloatArray
    resultant: FloatArray
    steps: tuple[LoadStep, ...]
    K: Mapping[str, FloatArray]
    relaxation: Mapping[str, Relaxation]
    K_G: FloatArray
    K_P: FloatArray
    K_static: FloatArray
    strain: float

    def applied_to(self, cell: CellMatrices, *, pressure_stiffness: bool) -> CellMatrices:
        """The cell's matrices about this state; the paper leaves the pressure stiffness out.

        Mass and viscous damping stay those of the cell at rest.
        """
        K_P = self.K_P if pressure_stiffness else np.zeros_like(self.K_P)
        return replace(
            cell,
            K={**cell.K, **self.K},
            relaxation={**cell.relaxation, **self.relaxation},
            K_G=self.K_G,
            K_P=K_P,
        )

    def at_equilibrium(self, cell: CellMatrices, *, pressure_stiffness: bool) -> CellMatrices:
        """The same with the stiffness of the moduli that carry the pressure, as one material."""
        about = self.applied_to(cell, pressure_stiffness=pressure_stiffness)
        return replace(about, K={"static": self.K_static}, relaxation={})


@dataclass(frozen=True, slots=True, eq=False)
class _Bricks:
    """The bricks of one material: numbers, coordinates, and their displacement gradient.

    static: elasticity that carries the pressure [Pa]; dynamic: that of K afterwards.
    """

    name: str
    numbers: IntArray
    X: FloatArray
    static: FloatArray
    dynamic: FloatArray
    H: FloatArray
    dV: FloatArray


class Inflatable:
    """A cell with all that does not depend on its deformation, ready to be inflated.

    static, dynamic: elasticity by material, (6, 6) or (e, g, 6, 6) [Pa]; they differ only for
    materials with a modulus of their own at rest.
    """

    def __init__(
        self,
        mesh: CellMesh,
        element: Element,
        cell: CellMatrices,
        static: Mapping[str, FloatArray],
        dynamic: Mapping[str, FloatArray],
    ) -> None:
        self.mesh, self.element, self.cell = mesh, element, cell
        self._pattern = Pattern.of(dofs_of(mesh.bricks), cell.n_dofs)
        self._periodic = PeriodicCell(cell)
        self._R = axes(mesh.points[:, 2])
        self._T = rotations(mesh.points[mesh.bricks, 2])
        self._faces = mesh.inside
        self._bricks = list(self._by_material(static, dynamic))

    def linear(self, pressure: float) -> Inflation:
        """One linear step under a pressure [Pa]; strains and rotations are taken as small."""
        at_rest = np.zeros(self.cell.n_dofs)
        K = self._zero()
        for b in self._bricks:
            K += self._add(b, self.element.stiffness(b.X, b.static))
        f = self._pressure_forces(at_rest, pressure)
        load = self._periodic.folded(f)
        q = self._periodic.solve(K, load)
        lack = load - self._periodic.folded(self.cell.sparse(K) @ q)

        u = self._brick_displacements(q)
        stress = {b.name: self.element.stress(b.X, b.static, u[b.numbers]) for b in self._bricks}
        K_G = self._zero()
        for b in self._bricks:
            K_G += self._add(b, geometric_stiffness(b.H, stress[b.name], b.dV))
        return Inflation(
            displacement=q.reshape(-1, 3),
            stress=self._brick_stress(stress),
            resultant=self._resultant(f),
            steps=(LoadStep(1.0, 1, self._size(lack) / self._size(load)),),
            K={},
            relaxation={},
            K_G=K_G,
            K_P=self._pressure_stiffness(at_rest, pressure),
            K_static=K,
            strain=max(_largest_strain(b.H, u[b.numbers]) for b in self._bricks),
        )

    def nonlinear(self, pressure: float) -> Inflation:
        """Newton's method under a pressure [Pa], raised in steps where it must be.

        Raises SolveError where even small steps do not converge, and for bricks without a
        finite-strain form.
        """
        if not self.element.finite_strain:
            raise SolveError("this brick has no finite-strain form; use hex20 or hex20r")
        q: FloatArray = np.zeros(self.cell.n_dofs)
        share, step = 0.0, 1.0
        steps: list[LoadStep] = []
        while share < 1.0:
            target = min(1.0, share + step)
            found = self._newton(q, pressure, target)
            if found is not None:
                q, share = found[0], target
                steps.append(found[1])
                step *= 2.0
            elif (step := step / 2.0) < SMALLEST_STEP:
                raise SolveError(
                    f"no equilibrium found beyond {share * pressure:.4g} Pa: the tyre has a limit "
                    "point or buckles there, or bricks turn inside out; lower inflation.pressure, "
                    "or stiffen the tyre"
                )
        return self._about(q, pressure, tuple(steps))

    def _newton(
        self, q: FloatArray, pressure: float, share: float
    ) -> tuple[FloatArray, LoadStep] | None:
        """Equilibrium at a share of the pressure, iterated from q.

        None if it does not converge, or to a state with bricks inside out: forces may balance
        there (measured: a tyre of 2 MPa at 1 bar, in one step from rest), and no tyre comes there.
        """
        p = share * pressure
        lack, load = self._lack(q, p)
        for iteration in range(1, MAX_ITERATIONS + 1):
            q = q + self._periodic.solve(self._tangent(q, p), lack)
            lack, load = self._lack(q, p)
            residual = self._size(lack) / self._size(load)
            if residual <= CONVERGED:
                inside_out = any(np.any(state.J <= 0.0) for _, state in self._deformed(q))
                return None if inside_out else (q, LoadStep(share, iteration, residual))
            if not residual < DIVERGED:  # NaN too
                return None
        return None

    def _about(self, q: FloatArray, pressure: float, steps: tuple[LoadStep, ...]) -> Inflation:
        """Everything that vibration about the deformed state q needs."""
        K, stress, K_G, K_static = {}, {}, self._zero(), self._zero()
        relaxation: dict[str, Relaxation] = {}
        for bricks, state in self._deformed(q):
            if isinstance(at_rest := self.cell.relaxation[bricks.name], Reassembly):
                relaxation[bricks.name] = self._reassembled(at_rest, bricks, state)
            K[bricks.name] = self._add(bricks, state.material_stiffness(bricks.dynamic))
            K_static += self._add(bricks, state.material_stiffness(bricks.static))
            K_G += self._add(bricks, state.geometric_stiffness())
            stress[bricks.name] = state.S
        return Inflation(
            displacement=q.reshape(-1, 3),
            stress=self._brick_stress(stress),
            resultant=self._resultant(self._pressure_forces(q, pressure)),
            steps=steps,
            K=K,
            relaxation=relaxation,
            K_G=K_G,
            K_P=self._pressure_stiffness(q, pressure),
            K_static=K_static,
            strain=float("nan"),
        )

    def _reassembled(self, at_rest: Reassembly, bricks: _Bricks, state: Deformed) -> Reassembly:
        """The parts of a stiffness that changes its form with frequency, about a state."""
        of_layer = layer_axes(self.element.tangents(bricks.X))
        slots = self._pattern.slots(dofs_of(self.mesh.bricks[bricks.numbers]))
        T = self._T[bricks.numbers]
        return Reassembly.of(at_rest.stuff, state.B, state.dV, of_layer, T, slots)

    def _lack(self, q: FloatArray, p: float) -> tuple[FloatArray, FloatArray]:
        """Pressure less inner forces, and pressure forces, both (n_own,)."""
        inner = np.zeros((self.mesh.n_nodes, 3))
        for bricks, state in self._deformed(q):
            nodes = self.mesh.bricks[bricks.numbers]
            np.add.at(inner, nodes.ravel(), state.forces().reshape(-1, 3))
        load = self._periodic.folded(self._pressure_forces(q, p))
        return load - self._periodic.folded(self._in_cylindrical(inner)), load

    def _tangent(self, q: FloatArray, p: float) -> FloatArray:
        """Entries of the tangent stiffness at q."""
        K = self._pressure_stiffness(q, p)
        for bricks, state in self._deformed(q):
            tangent = state.material_stiffness(bricks.static) + state.geometric_stiffness()
            K += self._add(bricks, tangent)
        return K

    def _by_material(
        self, static: Mapping[str, FloatArray], dynamic: Mapping[str, FloatArray]
    ) -> Iterator[_Bricks]:
        """The bricks, material by material."""
        X = self.mesh.cartesian[self.mesh.bricks]
        for index, name in enumerate(self.mesh.materials):
            here = np.flatnonzero(self.mesh.material == index)
            H, dV = self.element.displacement_gradient(X[here], static[name])
            yield _Bricks(name, here, X[here], static[name], dynamic[name], H, dV)

    def _deformed(self, q: FloatArray) -> Iterator[tuple[_Bricks, Deformed]]:
        """The bricks under displacements q (n,)."""
        u = self._brick_displacements(q)
        for bricks in self._bricks:
            yield bricks, Deformed.at(bricks.H, bricks.dV, bricks.static, u[bricks.numbers])

    def _pressure_forces(self, q: FloatArray, p: float) -> FloatArray:
        """Forces (n,) of pressure p on the inner surface displaced by q."""
        f = np.zeros((self.mesh.n_nodes, 3))
        forces = p * pressure_forces(self._face_points(q))
        np.add.at(f, self._faces.ravel(), forces.reshape(-1, 3))
        return self._in_cylindrical(f)

    def _pressure_stiffness(self, q: FloatArray, p: float) -> FloatArray:
        """Entries of K_P of pressure p on the inner surface displaced by q."""
        K = p * pressure_stiffness(self._face_points(q))
        T = rotations(self.mesh.points[self._faces, 2])
        return self._pattern.add(dofs_of(self._faces), turned(T, K))

    def _face_points(self, q: FloatArray) -> FloatArray:
        """Cartesian coordinates (f, a, 3) of the inner surface's nodes under q."""
        return (self.mesh.cartesian + self._in_cartesian(q))[self._faces]

    def _zero(self) -> FloatArray:
        """Entries of a stiffness before anything is added."""
        return np.zeros(self._pattern.nnz)

    def _add(self, bricks: _Bricks, K: FloatArray) -> FloatArray:
        """Cartesian stiffnesses of some bricks as entries of the cell's pattern."""
        dofs = dofs_of(self.mesh.bricks[bricks.numbers])
        return self._pattern.add(dofs, turned(self._T[bricks.numbers], K))

    def _brick_displacements(self, q: FloatArray) -> FloatArray:
        """Cartesian displacements (e, 3a) of every brick's nodes."""
        return self._in_cartesian(q)[self.mesh.bricks].reshape(len(self.mesh.bricks), -1)

    def _in_cartesian(self, q: FloatArray) -> FloatArray:
        """Nodal vectors (n_nodes, 3) in Cartesian axes from cylindrical dofs (n,): [7]."""
        return np.einsum("nij,ni->nj", self._R, q.reshape(-1, 3))

    def _in_cylindrical(self, v: FloatArray) -> FloatArray:
        """Cylindrical dofs (n,) from nodal vectors (n_nodes, 3) in Cartesian axes: [7]."""
        return np.einsum("nij,nj->ni", self._R, v).ravel()

    def _brick_stress(self, stress: Mapping[str, FloatArray]) -> FloatArray:
        """Volume means (e, 6) of Gauss-point stresses, in the axes of every brick's middle."""
        mean = np.empty((len(self.mesh.bricks), 6))
        for b in self._bricks:
            mean[b.numbers] = np.einsum("egv,eg->ev", stress[b.name], b.dV / b.dV.sum(1)[:, None])
        R = axes(self.mesh.points[self.mesh.bricks, 2].mean(axis=1))
        tensor = np.einsum("eki,ijv,ev,elj->ekl", R, TENSOR, mean, R, optimize=True)
        return np.einsum("vkl,ekl->ev", VOIGT, tensor) / VOIGT.sum(axis=(1, 2))

    def _resultant(self, f: FloatArray) -> FloatArray:
        """Sum (3,) of forces f (n,) in the axes (r, y, theta) of the cell's middle."""
        return axes(np.asarray(self.mesh.sector_angle / 2.0)) @ self._in_cartesian(f).sum(axis=0)

    def _size(self, f: FloatArray) -> float:
        """Norm of forces (n_own,) over the dofs that move."""
        return float(np.linalg.norm(f[self._periodic.free]))


def _largest_strain(H: FloatArray, u: FloatArray) -> float:
    """The largest principal strain at any point of bricks under displacements u (e, 3a) [m]."""
    gradient = np.einsum("egijn,en->egij", H, u, optimize=True)
    strain = (gradient + gradient.transpose(0, 1, 3, 2)) / 2.0
    return float(np.abs(np.linalg.eigvalsh(strain)).max())
