"""Waves of successive frequency lines joined into branches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from tyrefrf.arrays import ComplexArray, FloatArray, IntArray

APART = 1.0
"""From this cost on two waves are no continuation of each other: shapes that have nothing in
common at the place expected, or the same shape two orders away from it."""
STRETCH = 2.0
"""Distance in order from the place expected that costs as much as another shape does."""
LONGEST_STEP = 1.0
"""The largest step in order that is expected from one line to the next: near a cut-on the group
velocity at the line tells little about what comes."""


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """The m waves of a line: exponent = decay + i order (m,), velocity (m,) [rad/s].

    shape: (n, m) of unit norm, weighted by the root of the mass, so that shapes of different
    waves are near to orthogonal.
    """

    omega: float
    exponent: ComplexArray
    velocity: FloatArray
    shape: ComplexArray


def branches(frames: Sequence[Frame], n_cells: int) -> list[IntArray]:
    """The number (m,) of the branch that each wave of each line belongs to.

    Frames are in the order of their frequency. Branches are numbered as they appear, from line
    to line and, in a line, by decay. A line without waves ends them all.
    """
    numbers: list[IntArray] = []
    begun = 0
    for line, frame in enumerate(frames):
        here = np.full(len(frame.exponent), -1)
        if line:
            before, now = continued(frames[line - 1], frame, n_cells)
            here[now] = numbers[-1][before]
        new = here < 0
        here[new] = begun + np.arange(np.count_nonzero(new))
        begun += int(np.count_nonzero(new))
        numbers.append(here)
    return numbers


def continued(a: Frame, b: Frame, n_cells: int) -> tuple[IntArray, IntArray]:
    """Which waves of a line go on as which of the next one, at the least cost together.

    A wave is expected at its order plus what its group velocity, d omega / d order, makes of the
    step in frequency. Its cost is what the shapes do not have in common, 1 - MAC, and the
    distance from there.
    """
    mac = np.abs(a.shape.conj().T @ b.shape) ** 2
    with np.errstate(divide="ignore"):
        step = np.clip((b.omega - a.omega) / np.abs(a.velocity), 0.0, LONGEST_STEP)
    away = b.exponent - (a.exponent + 1j * step)[:, None]
    order = np.remainder(away.imag + n_cells / 2.0, n_cells) - n_cells / 2.0
    cost = 1.0 - mac + np.abs(away.real + 1j * order) / STRETCH
    # the ends of branches are pairings too, at the cost APART: none is stretched to save another
    rows, columns = linear_sum_assignment(np.minimum(cost, APART))
    near = cost[rows, columns] < APART
    return rows[near], columns[near]
