"""Free waves of the cell: motions that pass from cell to cell with a fixed ratio, without a load.

A wave is q(theta) ~ exp(-(decay + i order) theta): at exp(+i omega t) it runs, or dies away, in
the sense of +theta. From cell to cell it changes by lambda = exp(-(decay + i order) 2 pi / N).
Its partner of 1 / lambda runs the other way and is not reported.

That no wave was missed is proved by the argument principle: along the circle |lambda| = rho > 1,
det A(lambda) turns once for every pair of waves in the ring 1 / rho < |lambda| < rho.

Sources: Duhamel, Mace & Brennan, J. Sound Vib. 294 (2006) 205; Waki, Mace & Brennan, J. Sound
Vib. 327 (2009) 92; Mencik & Ichchou, Eur. J. Mech. A 24 (2005) 877.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.errors import SolveError
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.solvers.orders import Orders
from tyrefrf.solvers.palindrome import Band, Pair, Palindrome

MARGIN = 1.15
"""Waves are sought to so much beyond the bound: the circle of the proof keeps away from them."""
SAME = 1e-8
"""Ratios closer than that, relatively, are one found twice; refined ones agree to 1e-12."""
RESIDUAL_MAX = 1e-10
"""Residual above which what was found is no wave."""
LOSSLESS = 1e-8
"""| |lambda| - 1 | below which a wave's sense is that of its power."""
AMID = complex(np.exp(1e-3 + 1.1j))
"""A shift amid the strip and off every order, where an undamped ring may resonate."""
POINTS = 48  # on the circle of the proof, to begin with
SHORTEST = 1e-6  # between two of them [rad], at the end
QUARTER = np.pi / 2.0
"""The largest step of phase between two points of the circle that is believed."""


@dataclass(frozen=True, slots=True, eq=False)
class Waves:
    """The m free waves of a cell within a bound on their decay, the least decaying first.

    order: (m,) circumferential order, from -N/2 to N/2; negative where the phase runs against the
        power. decay: (m,) [Np/rad], >= 0.
    velocity: (m,) that of the energy, power over energy per angle [rad/s]: the group velocity
        where nothing dissipates.
    q: (n_own, m) displacement of the cell's own dofs, zero where fixed.
    residual: (m,) ||A q|| / (||A|| ||q||), dofs scaled by the root of their static stiffness.
    found, counted: waves within the circle of the proof, which may hold a few beyond the bound,
        by the search and by the argument principle: the same.
    """

    order: FloatArray
    decay: FloatArray
    velocity: FloatArray
    q: ComplexArray
    residual: FloatArray
    found: int
    counted: int


class FreeWaves:
    """Finds the free waves of a cell that is one of N around the axle.

    Made once for all lines. typical: an omega [rad/s] amid them, where all waves are found; the
    strongly decaying ones, which hardly change with frequency, then ease the proof at others.
    """

    def __init__(self, cell: CellMatrices, n_cells: int, typical: float) -> None:
        self.cell = cell
        self.angle = 2.0 * np.pi / n_cells
        self._orders = orders = Orders(cell)
        static = sum(cell.K.values(), start=cell.K_G + cell.K_P)
        pattern = orders.matrix(np.asarray(orders.folded(static).straight, complex))
        self._band = Band(pattern)
        self._scale = 1.0 / np.sqrt(np.abs(pattern.diagonal()))  # makes steel and rubber alike
        columns = np.repeat(np.arange(orders.n), np.diff(pattern.indptr))
        self._both = self._scale[pattern.indices] * self._scale[columns]
        self._elsewhere = once(self.problem(typical).everywhere(AMID))

    def at(self, omega: float, decay: float) -> Waves:
        """All waves that decay by at most `decay` [Np/rad]; omega > 0 [rad/s].

        Raises SolveError, which names the frequency, where their number cannot be proved.
        """
        problem, bound = self.problem(omega), decay * self.angle
        for search in (search_by_shifts, search_dense):
            try:
                pairs = distinct([problem.refined(nu) for nu in search(problem, MARGIN * bound)])
                found, counted = self._proof(problem, pairs, bound)
            except SolveError as error:
                reason = str(error)
                continue
            if found == counted:
                near = [pair for pair in pairs if decay_of(pair.ratio) <= bound]
                return self._waves(omega, near, found)
            reason = f"{found} free waves found of the {counted} within the bound on the decay"
        raise SolveError(
            f"{omega / (2.0 * np.pi):.6g} Hz: {reason}; another bound, or a line beside this one, "
            "may avoid it"
        )

    def _proof(self, problem: Palindrome, pairs: Sequence[Pair], bound: float) -> tuple[int, int]:
        """Waves found, and by the argument principle, inside a circle at the bound or beyond."""
        circle = widest_gap(pairs, bound)
        found = sum(decay_of(pair.ratio) < circle for pair in pairs)
        nu = np.array([pair.ratio + 1.0 / pair.ratio for pair in pairs], complex)
        beyond = self._elsewhere[decay_of_sum(self._elsewhere) > MARGIN * bound]
        return found, found + missed(problem, nu, beyond, circle)

    def problem(self, omega: float) -> Palindrome:
        """The eigenproblem, in dofs that are scaled by the root of their static stiffness."""
        folded = self._orders.folded(self.cell.dynamic_stiffness(omega))
        parts = (folded.straight, folded.on, folded.back)
        return Palindrome(self._band, *(self._orders.matrix(self._both * part) for part in parts))

    def _waves(self, omega: float, pairs: Sequence[Pair], found: int) -> Waves:
        """Of every pair the member that runs in +theta, sorted by decay."""
        ratio = np.array([pair.ratio for pair in pairs], complex)
        right, left = (
            self._displacement([getattr(pair, side) for pair in pairs])
            for side in ("right", "left")
        )
        partner = np.reciprocal(ratio)
        velocity = self._velocity(omega, ratio, right), self._velocity(omega, partner, left)
        loss = 1.0 - np.abs(ratio)
        ahead = np.where(np.abs(loss) > LOSSLESS, loss > 0.0, velocity[0] > velocity[1])
        exponent = -np.log(np.where(ahead, ratio, partner)) / self.angle
        by_decay = np.argsort(exponent.real, kind="stable")
        return Waves(
            order=exponent.imag[by_decay],
            decay=np.maximum(exponent.real, 0.0)[by_decay],
            velocity=np.where(ahead, *velocity)[by_decay],
            q=np.where(ahead, right, left)[:, by_decay],
            residual=np.array([pair.residual for pair in pairs])[by_decay],
            found=found,
            counted=found,  # or it would not be here
        )

    def _displacement(self, vectors: Sequence[ComplexArray]) -> ComplexArray:
        """Vectors of the eigenproblem as displacements (n_own, m) of unit norm."""
        q = np.zeros((self.cell.n_own, len(vectors)), complex)
        for wave, vector in enumerate(vectors):
            q[~self.cell.fixed[: self.cell.n_own], wave] = self._scale * vector
        return q / np.linalg.norm(q, axis=0)

    def _velocity(self, omega: float, ratio: ComplexArray, q: ComplexArray) -> FloatArray:
        """Power through a section over energy per angle [rad/s], of waves q (n_own, m).

        Both die away as exp(-2 decay theta), so a mean over the cell is compared with a mean.
        """
        cell = self.cell
        Q = np.concatenate([q, ratio * q[: cell.n_face]])
        D, M = (cell.sparse(a) @ Q for a in (cell.dynamic_stiffness(omega), cell.M))
        power = omega / 2.0 * np.sum(Q[: cell.n_face].conj() * D[: cell.n_face], axis=0).imag
        energy = np.sum(Q.conj() * (D + 2.0 * omega**2 * M), axis=0).real / 4.0
        twice = -2.0 * np.log(np.abs(ratio))
        twice[np.abs(twice) < LOSSLESS] = LOSSLESS
        return power * -np.expm1(-twice) / twice / (energy / self.angle)


def search_by_shifts(problem: Palindrome, bound: float) -> ComplexArray:
    """Sums nu = lambda + 1/lambda of waves that decay by up to `bound` per cell, mostly all.

    Every shift finds what is nearest to it, a disc in nu = 2 cosh(decay + i phase); new shifts
    stand amid what no disc covers yet, those of no decay first. Points stand for the whole strip:
    what lies between them and was missed anyhow, the proof notices.
    """
    phase = np.pi * (np.arange(96) + 0.47) / 96  # off the orders, where a ring may resonate
    decay = np.append(np.linspace(-1.0, 1.0, 10), 1e-3) * bound
    open_ = (decay + 1j * phase[:, None]).ravel()
    found = []
    while len(open_):
        least = np.abs(open_.real).min()
        row = open_[np.abs(open_.real) == least]
        ratio = complex(np.exp(row[len(row) // 2]))
        nu, radius = problem.near(ratio)
        found.append(nu)
        open_ = open_[np.abs(2.0 * np.cosh(open_) - ratio - 1.0 / ratio) >= radius]
    nu = np.concatenate(found)
    return once(nu[decay_of_sum(nu) <= bound])


def search_dense(problem: Palindrome, bound: float) -> ComplexArray:
    """The same from all eigenvalues: slow, and without gaps between discs."""
    nu = problem.everywhere(AMID)
    return once(nu[decay_of_sum(nu) <= bound])


def once(nu: ComplexArray) -> ComplexArray:
    """Sums of which there are two of each, and more where discs overlap, about once each."""
    kept = np.empty(0, complex)
    for x in nu:
        if np.all(np.abs(kept - x) > SAME * np.abs(x)):
            kept = np.append(kept, x)
    return kept


def distinct(pairs: Sequence[Pair]) -> list[Pair]:
    """The pairs that are waves, each once, in the order of their decay and phase."""
    kept: list[Pair] = []
    for pair in pairs:
        a = pair.ratio
        same = (min(abs(a / b.ratio - 1.0), abs(a * b.ratio - 1.0)) < SAME for b in kept)
        if pair.residual <= RESIDUAL_MAX and not any(same):
            kept.append(pair)
    return sorted(kept, key=lambda pair: (decay_of(pair.ratio), abs(np.angle(pair.ratio))))


def decay_of(ratio: complex) -> float:
    """Decay per cell [Np]."""
    return float(abs(np.log(abs(ratio))))


def decay_of_sum(nu: ComplexArray) -> FloatArray:
    """Decay per cell [Np] from nu = lambda + 1 / lambda."""
    decay: FloatArray = np.abs(np.arccosh(nu / 2.0).real)
    return decay


def widest_gap(pairs: Sequence[Pair], bound: float) -> float:
    """A decay per cell from the bound to its MARGIN, as far from all waves as can be."""
    decays = np.array([decay_of(pair.ratio) for pair in pairs])
    beyond = decays[(decays > bound) & (decays < MARGIN * bound)]
    edges = np.sort(np.concatenate([beyond, [bound, MARGIN * bound]]))
    widest = int(np.argmax(np.diff(edges)))
    return float(edges[widest] + edges[widest + 1]) / 2.0


def missed(problem: Palindrome, found: ComplexArray, beyond: ComplexArray, circle: float) -> int:
    """How many pairs that decay by less than `circle` per cell are not among those found.

    found: their sums nu. beyond: any numbers outside the circle.
    Turns of det A(lambda) / prod (lambda + 1/lambda - nu) along |lambda| = exp(circle): zeros
    within that were found cancel and leave those that were not. Numbers beyond the circle turn
    nothing, but where they are close to this frequency's own strongly decaying waves they make
    the phase smooth, which otherwise turns 60 times to and fro (layered tyre; then: 1 to 5).
    A step between two points is believed where a point between them agrees.
    """
    nu = np.concatenate([found, beyond])

    def phases_at(t: FloatArray) -> FloatArray:
        ratio = np.exp(circle + 1j * t)
        known = np.angle((ratio + 1.0 / ratio)[:, None] - nu).sum(axis=1)
        return np.array([problem.factorise(x).phase for x in ratio]) - known

    t = np.linspace(0.0, 2.0 * np.pi, POINTS + 1)
    phase = phases_at(t)
    a, b, phase_a, phase_b = t[:-1], t[1:], phase[:-1], phase[1:]
    turns = 0.0
    while len(a):
        if np.min(b - a) < SHORTEST:
            raise SolveError("a free wave lies on the circle that is to prove their number")
        c = (a + b) / 2.0
        phase_c = phases_at(c)
        first, second = turned(phase_c - phase_a), turned(phase_b - phase_c)
        steps = np.abs([first, second, first + second])
        open_ = np.any(steps > QUARTER, axis=0)
        turns += np.sum((first + second)[~open_])
        a, b = np.concatenate([a[open_], c[open_]]), np.concatenate([c[open_], b[open_]])
        phase_a, phase_b = (
            np.concatenate([phase_a[open_], phase_c[open_]]),
            np.concatenate([phase_c[open_], phase_b[open_]]),
        )
    return round(turns / (2.0 * np.pi))


def turned(phase: FloatArray) -> FloatArray:
    """Phases [rad] from -pi to pi."""
    return np.remainder(phase + np.pi, 2.0 * np.pi) - np.pi
