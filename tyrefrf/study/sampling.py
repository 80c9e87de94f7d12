"""Which lines to solve, so that a rational fit gives the others.

Lines are chosen in batches. Every line of a batch is predicted by the fit to the lines before it,
and only then solved: so it first tells how wrong the fit was. A batch stands where the fit is
least sure: where the last two fits differ most, at poles closer to the axis than to any solved
line, and in the middle of the widest gaps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from tyrefrf.study.rational import Rational, fit

START, BATCH = 24, 6
"""Lines of the first batch and of the others; fixed, so that the choice of lines is the same on
any number of cores."""
CROWDED = 1.5
"""Exponent by which the first lines crowd towards low frequencies, where resonances are narrow."""
IN_GAPS = 2
"""Lines of a batch that stand in the widest gaps, whatever the fit says."""
BATCHES_TRUSTED = 2
"""Batches in a row whose predictions have to hold."""
CLOSER = 0.03
"""Share of the tolerance to which the fit meets the lines that are solved."""
MOST, MOST_SUPPORT = 0.5, 300
"""Share of the lines that may be solved, and support points that may be found for them, before the
fit is given up."""
STALLED, PREDICTED = 16, 0.1
"""Batches of which the later half predicts no better than the earlier, though they do predict, to
that share of the peak: what is left is not rational, noise say, and the fit is given up."""
BLOCK = 4_000_000  # complex numbers held at once where responses at all lines are compared


@dataclass(frozen=True, slots=True, eq=False)
class Scale:
    """What an error of a response counts: the larger of two shares of a peak.

    of_receptance, of_mobility: (p, l) 1 over the peak that the load's driving point has in
    receptance [N/m] and in mobility [s N/m]: both have to be met, as they peak at different
    frequencies. A response that is zero by symmetry is measured by the driving point too. For
    forces on the rim the first is 1 over their largest peak [N/N], and the second zero.
    """

    of_receptance: FloatArray
    of_mobility: FloatArray

    @classmethod
    def of(cls, omega: FloatArray, receptance: ComplexArray, arms: FloatArray) -> Scale:
        """From responses (p, l, k) at omega (k,) [rad/s]; arms as in `Sampling`."""
        size = np.abs(receptance)
        drive = np.einsum("iik->ik", size[: size.shape[1]])
        peaks = np.broadcast_to(drive.max(axis=1), size.shape[:2]).copy()
        fastest = np.broadcast_to((omega * drive).max(axis=1), size.shape[:2]).copy()
        force = arms > 0.0
        largest = (size[force].max(axis=2) / arms[force, None]).max(axis=0, initial=0.0)
        peaks[force] = arms[force, None] * largest
        fastest[force] = 0.0
        return cls(_inverse(peaks), _inverse(fastest))

    def at(self, omega: FloatArray) -> FloatArray:
        """(p, l, k) what an error counts at omega (k,)."""
        return np.maximum(self.of_receptance[..., None], self.of_mobility[..., None] * omega)


def _inverse(peak: FloatArray) -> FloatArray:
    """1 / peak; 0 where nothing moves."""
    return np.divide(1.0, peak, out=np.zeros_like(peak), where=peak > 0.0)


class Sampling:
    """The lines solved so far, and which to solve next.

    omega: (f,) [rad/s], increasing. arms: (p,) 0 for probes of displacements, of which the first
    are the driving points of the loads in their order; for a probe of the rim's force 1, of its
    moment the arm [m] of the largest. tolerance: of the driving points' peaks, as `Scale` has it.
    first: numbers of lines that have to be solved.
    given_up: whether all lines are solved as the fit cannot be trusted.
    """

    def __init__(
        self, omega: FloatArray, arms: FloatArray, tolerance: float, first: IntArray
    ) -> None:
        self.omega, self.arms, self.tolerance = omega, arms, tolerance
        self.solved = np.zeros(len(omega), bool)
        self.errors: list[float] = []
        self.given_up = False
        self.first = first
        self._lines = np.empty(0, int)
        self._receptance = np.empty((0, 0, 0), complex)
        self._fits: list[Rational] = []

    @property
    def held_back_error(self) -> float:
        """The worst error of the last predictions; NaN where too few were made to judge by."""
        last = self.errors[-BATCHES_TRUSTED:]
        return max(last) if len(last) == BATCHES_TRUSTED else float("nan")

    def next_lines(self) -> IntArray:
        """Numbers of the lines to solve next, ascending; none when all others can be fitted.

        All that are left where the fit is given up.
        """
        left = np.flatnonzero(~self.solved)
        chosen = self._chosen(left)
        if len(chosen) and (self._hopeless() or self._too_many(len(chosen))):
            self.given_up = True
            return left
        return chosen

    def _chosen(self, left: IntArray) -> IntArray:
        if not self.solved.any():
            return np.union1d(_spread(self.omega), self.first)
        if not self._fits:
            return left
        doubt, poles = self._doubt(left), self._sharp_poles()
        trusted = self.held_back_error <= self.tolerance >= doubt.max(initial=0.0)
        return left[:0] if trusted and not len(poles) else self._least_sure(left, doubt, poles)

    def _too_many(self, more: int) -> bool:
        return bool(np.sum(self.solved) + more > MOST * len(self.omega))

    def _hopeless(self) -> bool:
        """Whether nothing was learnt of late, or more would cost more than it saves."""
        if self._fits and len(self._fits[-1].z) > MOST_SUPPORT:
            return True
        half = len(self.errors) // 2
        if 2 * half < STALLED:
            return False
        earlier, later = min(self.errors[:half]), min(self.errors[half:])
        return PREDICTED > later > earlier / 2.0

    def add(self, lines: IntArray, receptance: ComplexArray) -> None:
        """Take answers (p, l, k), NaN where a line failed: such a line tells nothing."""
        self.solved[lines] = True
        if self.given_up:
            return
        there = ~np.isnan(receptance).any(axis=(0, 1))
        lines, receptance = lines[there], receptance[..., there]
        if not len(lines):
            return
        if self._fits:
            self.errors.append(self._error(lines, receptance))
        if len(self._lines):
            lines = np.append(self._lines, lines)
            receptance = np.concatenate([self._receptance, receptance], axis=2)
        self._lines, self._receptance = lines, receptance
        self._fits = [*self._fits[-1:], self._fit()]

    def fitted(self, lines: IntArray) -> ComplexArray:
        """(p, l, k) responses at lines that are not solved."""
        return self._at(self._fits[-1], lines)

    def _fit(self) -> Rational:
        """The fit to all solved lines; it keeps the support of the one before."""
        omega = self.omega[self._lines]
        scale = Scale.of(omega, self._receptance, self.arms)
        values = np.asarray(self._receptance * scale.of_receptance[..., None], complex)
        least = np.where(scale.of_receptance > 0.0, scale.of_receptance, 1.0)
        weight = (scale.at(omega) / least[..., None]).reshape(-1, len(omega)).T
        start = self._fits[-1].support.tolist() if self._fits else []
        columns = values.reshape(-1, len(omega)).T
        return fit(omega, columns, weight, CLOSER * self.tolerance, start)

    def _at(self, rational: Rational, lines: IntArray) -> ComplexArray:
        f = self._receptance[..., rational.support]
        return np.asarray(f @ rational.basis(self.omega[lines]).T)

    def _scale(self) -> Scale:
        return Scale.of(self.omega[self._lines], self._receptance, self.arms)

    def _error(self, lines: IntArray, receptance: ComplexArray) -> float:
        """The worst error of the fit at lines just solved."""
        error = np.abs(self.fitted(lines) - receptance)
        return float((self._scale().at(self.omega[lines]) * error).max())

    def _doubt(self, lines: IntArray) -> FloatArray:
        """(k,) how far the last two fits differ at lines; endless with one fit alone."""
        if len(self._fits) < 2:
            return np.full(len(lines), np.inf)
        scale = self._scale()
        length = max(1, BLOCK // self._receptance[..., 0].size)
        blocks = [lines[i : i + length] for i in range(0, len(lines), length)]
        return np.concatenate([np.zeros(0)] + [self._difference(block, scale) for block in blocks])

    def _difference(self, lines: IntArray, scale: Scale) -> FloatArray:
        before, now = self._fits
        difference = np.abs(self._at(now, lines) - self._at(before, lines))
        worst: FloatArray = (scale.at(self.omega[lines]) * difference).max(axis=(0, 1))
        return worst

    def _sharp_poles(self) -> IntArray:
        """Unsolved lines at poles that lie closer to the axis than to any solved line.

        Such a pole was never seen: it may be a narrow resonance, or none. What counts is one
        that contributes more than the tolerance at the line next to it.
        """
        rational, omega = self._fits[-1], self.omega
        poles = rational.poles()
        poles = poles[(poles.real >= omega[0]) & (poles.real <= omega[-1])]
        distance = np.abs(poles.real[:, None] - omega)
        unseen = np.abs(poles.imag) < distance[:, self.solved].min(axis=1, initial=np.inf)
        poles, line = poles[unseen], distance[unseen].argmin(axis=1)
        residue = self._receptance[..., rational.support] @ rational.residues(poles).T
        size = np.abs(residue) / np.abs(poles - omega[line])
        counts = (self._scale().at(omega[line]) * size).max(axis=(0, 1)) > self.tolerance
        return np.unique(line[counts & ~self.solved[line]])

    def _least_sure(self, left: IntArray, doubt: FloatArray, poles: IntArray) -> IntArray:
        """A batch: at sharp poles, in the widest gaps, and where the doubt is largest."""
        taken = _Taken(self.solved)
        for line in poles[: BATCH - IN_GAPS]:
            taken.add(int(line))
        for _ in range(IN_GAPS):
            taken.add_in_widest_gap()
        judged = np.isfinite(doubt)
        for line in left[judged][np.argsort(-doubt[judged], kind="stable")]:
            if len(taken.lines) == BATCH:
                break
            taken.add_if_alone(int(line))
        while len(taken.lines) < min(BATCH, len(left)):
            taken.add_in_widest_gap()
        return np.array(sorted(taken.lines))


def _spread(omega: FloatArray) -> IntArray:
    """Lines of the first batch, from the first to the last."""
    wanted = omega[0] + np.ptp(omega) * np.linspace(0.0, 1.0, START) ** CROWDED
    after = np.searchsorted(omega, wanted).clip(1, max(1, len(omega) - 1))
    nearer = wanted - omega[after - 1] < omega[after.clip(max=len(omega) - 1)] - wanted
    return np.unique(after - nearer)


class _Taken:
    """Lines as they are taken into a batch."""

    def __init__(self, solved: BoolArray) -> None:
        self._taken = solved.copy()
        self._crowded = solved.copy()
        self.lines: list[int] = []

    def add(self, line: int) -> None:
        """Take a line, and the half of its gap around it out of the choice."""
        if self._taken[line]:
            return
        others = np.flatnonzero(self._taken)
        i = int(np.searchsorted(others, line))
        before = others[i - 1] if i > 0 else 0
        after = others[i] if i < len(others) else len(self._taken) - 1
        self._crowded[(before + line + 1) // 2 : (line + after) // 2 + 1] = True
        self._taken[line] = True
        self.lines.append(line)

    def add_if_alone(self, line: int) -> None:
        """Take a line unless one near it has been."""
        if not self._crowded[line]:
            self.add(line)

    def add_in_widest_gap(self) -> None:
        """Take the middle of the longest row of lines that are not taken."""
        others = np.flatnonzero(self._taken)
        edges = np.concatenate([[-1], others, [len(self._taken)]])
        widest = int(np.argmax(np.diff(edges)))
        if edges[widest + 1] - edges[widest] > 1:
            self.add(int(edges[widest] + edges[widest + 1]) // 2)
