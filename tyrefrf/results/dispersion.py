"""Free waves of the cell over frequency, in branches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tyrefrf.arrays import BoolArray, FloatArray, IntArray
from tyrefrf.errors import ResultsError
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results.results import Provenance, StaticState, expect_shape

DIRECTIONS = ("r", "y", "theta")
NEPER = 20.0 / np.log(10.0)
"""Decibels in a neper."""


@dataclass(frozen=True, slots=True, eq=False)
class Dispersion:
    """Waves q ~ exp(i omega t - (decay + i order) theta) at f lines, in b branches, read-only.

    Each runs, or dies away, in the sense of +theta; its partner of opposite sense has the same
    numbers with opposite signs. NaN where a branch decays by more than the bound, or the line
    failed.

    frequency: (f,) [Hz]. order: (b, f) circumferential order, a real number from -N/2 to N/2;
        negative where phase and energy run against each other. decay: (b, f) [Np/rad], >= 0.
    velocity: (b, f) of the energy [rad/s], which is the group velocity where nothing dissipates.
    share: (b, 3, f) of r, y and theta in the section's kinetic energy.
    residual: (b, f) ||A q|| / (||A|| ||q||) of the cell's equations.
    found, counted: (f,) waves within the bound, or slightly more, by the search and by the
        argument principle: the same, which proves that none is missing; -1 where a line failed.
    solve_time: (f,) [s]. remark: f texts, empty or why the line failed.
    bound: the largest decay that was asked for [Np/rad].
    Raises ResultsError where the shapes do not agree.
    """

    frequency: FloatArray
    order: FloatArray
    decay: FloatArray
    velocity: FloatArray
    share: FloatArray
    residual: FloatArray
    found: IntArray
    counted: IntArray
    solve_time: FloatArray
    remark: tuple[str, ...]
    bound: float
    section: SectionMesh
    provenance: Provenance
    inflation: StaticState | None = None

    def __post_init__(self) -> None:
        n_branches, n_lines = self.order.shape
        for name in ("order", "decay", "velocity", "residual"):
            expect_shape(self, name, (n_branches, n_lines))
        expect_shape(self, "share", (n_branches, len(DIRECTIONS), n_lines))
        for name in ("frequency", "found", "counted", "solve_time"):
            expect_shape(self, name, (n_lines,))
        if len(self.remark) != n_lines:
            raise ResultsError(f"{len(self.remark)} remarks for {n_lines} lines")

    @property
    def failed(self) -> BoolArray:
        """(f,) lines whose waves were not found, or not proved to be all."""
        return (self.counted < 0) | (self.found != self.counted)

    @property
    def radius(self) -> float:
        """The outer radius [m], at which wavenumbers and velocities in metres are given."""
        return float(self.section.points[:, 0].max())

    @property
    def wavenumber(self) -> FloatArray:
        """(b, f) order per outer radius [rad/m]."""
        return self.order / self.radius

    @property
    def propagating(self) -> BoolArray:
        """(b, f) whether a wave runs rather than dies away.

        Its order is further than its decay from 0 and from N/2, where cells move in step or
        against each other and nothing runs.
        """
        order = np.abs(self.order)
        return np.minimum(order, self.provenance.n_cells / 2.0 - order) > self.decay

    @property
    def cut_on(self) -> FloatArray:
        """(b,) the first line [Hz] on which a branch propagates; NaN where it never does."""
        first = np.argmax(self.propagating, axis=1)
        return np.where(self.propagating.any(axis=1), self.frequency[first], np.nan)

    @property
    def waves(self) -> IntArray:
        """(f,) how many waves of each line are within the bound."""
        return np.count_nonzero(~np.isnan(self.order), axis=0)
