"""Measured responses, as they are kept with the computed ones and held against them.

Criterion: frequency response assurance, W. Heylen & S. Lammens, FRAC: a consistent way of
comparing frequency response functions, Int. Conf. on Identification in Engineering Systems (1996).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, frozen
from tyrefrf.errors import ResultsError

if TYPE_CHECKING:
    from tyrefrf.results.results import Quantity, Results

LEAST = 2
"""Lines that a criterion needs: with one, any two curves agree."""


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """A measured response of a probe to a load, both by name; its arrays are read-only.

    quantity: "receptance" [m/N], "mobility" [m/(s N)] or "accelerance" [m/(s^2 N)].
    frequency: (f,) [Hz], increasing. response: (f,) in the quantity's unit.
    Raises ResultsError where the shapes do not agree.
    """

    name: str
    load: str
    probe: str
    quantity: Quantity
    frequency: FloatArray
    response: ComplexArray

    def __post_init__(self) -> None:
        if self.response.shape != self.frequency.shape:
            shapes = f"{self.response.shape} for frequencies {self.frequency.shape}"
            raise ResultsError(f"measured {self.name!r}: a response of shape {shapes}")
        frozen(self.frequency)
        frozen(self.response)

    @property
    def mobility(self) -> ComplexArray:
        """(f,) velocity per force [m/(s N)]; NaN where an accelerance at 0 Hz says nothing."""
        s = 2j * np.pi * self.frequency
        power = 1 - ("receptance", "mobility", "accelerance").index(self.quantity)
        if power >= 0:
            return np.asarray(self.response * s**power)
        nowhere = np.full(s.shape, complex(np.nan, np.nan))
        return np.divide(self.response, s, out=nowhere, where=s != 0.0)


@dataclass(frozen=True, slots=True)
class Agreement:
    """How far a computed response agrees with a measured one, in the measured quantity.

    frac: |sum H_m* H_c|^2 / (sum |H_m|^2 sum |H_c|^2), from 0 to 1, blind to a factor; NaN where
        fewer than two lines are common, or one of the two is zero.
    level: mean of 20 log10 |H_c| / |H_m| over the common lines [dB].
    first, last: [Hz], of the n_lines measured lines at which the computed response is known.
    """

    name: str
    load: str
    probe: str
    quantity: Quantity
    frac: float
    level: float
    first: float
    last: float
    n_lines: int


def agreements(results: Results) -> tuple[Agreement, ...]:
    """Every measured response of the results against the computed one."""
    return tuple(_agreement(results, measured) for measured in results.measured)


def _agreement(results: Results, measured: Measured) -> Agreement:
    computed = results.response(measured.load, measured.probe, measured.quantity)
    common = within(measured.frequency, results.frequency, ~np.isnan(computed))
    f, H_m = measured.frequency[common], measured.response[common]
    H_c = interpolated(f, results.frequency, computed)
    many = len(f) >= LEAST
    return Agreement(
        name=measured.name,
        load=measured.load,
        probe=measured.probe,
        quantity=measured.quantity,
        frac=frac(H_m, H_c) if many else float("nan"),
        level=level(H_m, H_c) if many else float("nan"),
        first=float(f[0]) if len(f) else float("nan"),
        last=float(f[-1]) if len(f) else float("nan"),
        n_lines=len(f),
    )


def frac(H_m: ComplexArray, H_c: ComplexArray) -> float:
    """The frequency response assurance criterion of two responses (f,) at the same lines."""
    sizes = np.vdot(H_m, H_m).real * np.vdot(H_c, H_c).real
    return float(abs(np.vdot(H_m, H_c)) ** 2 / sizes) if sizes > 0.0 else float("nan")


def level(H_m: ComplexArray, H_c: ComplexArray) -> float:
    """Mean level of H_c over H_m [dB], over the lines where neither is zero."""
    both = (H_m != 0.0) & (H_c != 0.0)
    if not both.any():
        return float("nan")
    return float(np.mean(20.0 * np.log10(np.abs(H_c[both] / H_m[both]))))


def within(f: FloatArray, lines: FloatArray, answered: BoolArray) -> BoolArray:
    """Which frequencies f lie on an answered line, or between two neighbours that both are."""
    after = np.searchsorted(lines, f)
    before = np.searchsorted(lines, f, side="right") - 1
    inside = (before >= 0) & (after < len(lines))
    ends = (index.clip(0, len(lines) - 1) for index in (before, after))
    return np.logical_and.reduce([inside, *(answered[end] for end in ends)])


def interpolated(f: FloatArray, lines: FloatArray, H: ComplexArray) -> ComplexArray:
    """A computed response (lines,) at frequencies f, by a cubic spline through answered lines.

    The computed curve goes to the measured lines and not the other way round: it is smooth, and
    its lines may crowd where an adaptive choice or a logarithmic range put them, which would give
    those frequencies a weight that the measurement does not.
    """
    from scipy.interpolate import CubicSpline

    answered = ~np.isnan(H)
    if answered.sum() < LEAST:
        return np.asarray(np.full(len(f), H[answered][0] if answered.any() else np.nan))
    return np.asarray(CubicSpline(lines[answered], H[answered])(f))
