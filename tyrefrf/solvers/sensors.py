"""The mass of accelerometers, added to responses that were computed without it.

A sensor of mass m at a place where the tyre moves by u = P^T q, three directions, changes the
ring's D by -omega^2 m P P^T. With d = -omega^2 m the changed responses follow from those of the
tyre alone (Woodbury's identity; rank one for every direction):

    H' = H - H_P d (1 + P^T H_P d)^-1 P^T H,    H_P the responses to unit forces at the place,

exactly, from the sensor's own driving point P^T H_P and the responses to and from it. At the
sensor that is u' = (1 + P^T H_P d)^-1 u; in one direction, the well-known A' = A/(1 + m A_drive).

Source: Golub & Van Loan, Matrix Computations (2013), 2.1.4; Ewins, Modal Testing (2000), 3.8, on
the transducer's mass.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray, IntArray
from tyrefrf.errors import SolveError

DIRECTIONS = 3
"""In which a sensor's mass acts."""

SINGULAR = 1e10
"""Condition of 1 + P^T H_P d above which nothing is left of the response's digits: the tyre with
its sensor resonates undamped."""


@dataclass(frozen=True, slots=True, eq=False)
class Sensors:
    """Sensors of s masses (s,) [kg], each at the place of a probe, by the probe's number (s,).

    together: whether all are on the tyre at once, and seen by every probe; else each one is there
    alone, and seen by its own probe.
    """

    mass: FloatArray
    probe: IntArray
    together: bool

    @property
    def n_columns(self) -> int:
        """Loads, and as many probes, that the sensors' own places take."""
        return DIRECTIONS * len(self.mass)

    def seen(self, H: ComplexArray, omega: float) -> ComplexArray:
        """(p, l) responses with the sensors, from (p + 3 s, l + 3 s) without them.

        The last 3 s probes and loads are the sensors' places, in three directions each.
        Raises SolveError where the tyre with a sensor resonates undamped.
        """
        n_probes, n_loads = (size - self.n_columns for size in H.shape)
        changed = H[:n_probes, :n_loads].copy()
        to_probes, at_places = H[:n_probes, n_loads:], H[n_probes:]
        d = -(omega**2) * np.repeat(self.mass, DIRECTIONS)
        for rows, places in self._groups(n_probes):
            own = at_places[places]
            system = np.eye(len(places)) + d[places, None] * own[:, n_loads + places]
            if np.linalg.cond(system) > SINGULAR:
                raise SolveError("with a sensor's mass the tyre resonates undamped on this line")
            force = np.linalg.solve(system, d[places, None] * own[:, :n_loads])
            changed[rows] -= to_probes[np.ix_(rows, places)] @ force
        return changed

    def _groups(self, n_probes: int) -> Iterator[tuple[IntArray, IntArray]]:
        """Probes, and the columns of all sensors that they see."""
        if self.together:
            yield np.arange(n_probes), np.arange(self.n_columns)
            return
        for k, probe in enumerate(self.probe):
            yield np.array([probe]), DIRECTIONS * k + np.arange(DIRECTIONS)
