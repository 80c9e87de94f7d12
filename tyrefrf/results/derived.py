"""What engineers quote of a response: mean squares in bands and over a region, and levels in dB.

All of them are of |X|^2, where X is a receptance, mobility or accelerance per unit force:

- Bands are one-third octaves, base ten (IEC 61260-1:2014, 5.2 to 5.5): exact mid-band frequencies
  f_m = 1000 G^(x/3) with G = 10^(3/10), edges f_m G^(-1/6) and f_m G^(+1/6), and nominal
  frequencies to call them by. A band's value is the mean of |X|^2 over its width,
  1/(f_2 - f_1) times the integral from f_1 to f_2: the mean square response per mean square force
  where the force's spectrum is flat in the band. It is not the sum, which grows with the width.
- Over a region it is the mean of |X|^2 over the area that its points stand for (Cremer, Heckl &
  Petersson, Structure-Borne Sound (2005), on spatial means; ISO 7626-1 has the mobilities).
- A level is 10 lg of a mean square over the square of a reference, which is always named.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

import numpy as np

from tyrefrf.arrays import FloatArray, IntArray, frozen
from tyrefrf.errors import ResultsError
from tyrefrf.mesh.place import REGION, Place
from tyrefrf.results.results import Quantity, Results, index_of
from tyrefrf.results.sweep import SweepResults

UNITS: dict[Quantity, str] = {
    "receptance": "m/N",
    "mobility": "m/(s N)",
    "accelerance": "m/(s^2 N)",
}
"""Of each response per unit force (ISO 7626-1)."""

G = 10.0**0.3
"""The octave, base ten."""

NOMINAL = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)
"""What the bands of a decade are called (IEC 61260-1, annex E)."""


@dataclass(frozen=True, slots=True)
class Reference:
    """What a level is relative to: a value in the quantity's SI units, and what to call it."""

    value: float
    name: str

    def __post_init__(self) -> None:
        if not 0.0 < self.value < np.inf:
            raise ResultsError(f"{self.value:g} is no reference of a level; give a positive number")


ISO_1683: dict[Quantity, Reference] = {
    "receptance": Reference(1e-6, "1e-06 m/N (ISO 1683: 1 pm, 1 uN)"),
    "mobility": Reference(1e-3, "0.001 m/(s N) (ISO 1683: 1 nm/s, 1 uN)"),
    "accelerance": Reference(1.0, "1 m/(s^2 N) (ISO 1683: 1 um/s^2, 1 uN)"),
}
"""References of displacement, velocity and acceleration over that of force, 1 uN. ISO 1683:2015 has
these, and none for a mobility itself: a level re 1 nm/s minus the force's level re 1 uN is a level
re their ratio."""


def reference_of(quantity: Quantity, value: float | str = 1.0) -> Reference:
    """A reference by its value in SI, or "iso1683".

    Raises ResultsError where it is neither a positive number nor that name.
    """
    if value == "iso1683":
        return ISO_1683[quantity]
    try:
        number = float(value)
    except ValueError:
        message = f"{value!r} is no reference; give iso1683 or a number in {UNITS[quantity]}"
        raise ResultsError(message) from None
    return Reference(number, f"{number:g} {UNITS[quantity]}")


def level(mean_square: FloatArray, reference: Reference) -> FloatArray:
    """10 lg of a mean square over the reference's square [dB]; NaN where nothing moves."""
    ratio = mean_square / reference.value**2
    decibels = np.full(ratio.shape, np.nan)
    np.log10(ratio, where=ratio > 0.0, out=decibels)
    return 10.0 * decibels


@dataclass(frozen=True, slots=True, eq=False)
class Bands:
    """Frequency bands; arrays (b,) [Hz], read-only.

    nominal: what they are called. centre: exact mid-band frequencies. lower, upper: exact edges.
    """

    nominal: FloatArray
    centre: FloatArray
    lower: FloatArray
    upper: FloatArray

    def __post_init__(self) -> None:
        for array in (self.nominal, self.centre, self.lower, self.upper):
            frozen(array)

    def __len__(self) -> int:
        return len(self.centre)


def third_octaves(first: float, last: float) -> Bands:
    """The one-third-octave bands whose nominal or exact centre is from first to last [Hz]."""
    if not 0.0 < first <= last:
        raise ResultsError(f"no bands from {first:g} to {last:g} Hz; give 0 < first <= last")
    around = np.log10(np.array([first, last]) / 1000.0) * 10.0
    x = np.arange(np.floor(around[0]) - 1, np.ceil(around[1]) + 2).astype(int)
    centre = 1000.0 * G ** (x / 3.0)
    nominal = np.array([NOMINAL[k % 10] * 10.0 ** (3 + k // 10) for k in x.tolist()])
    inside = (np.maximum(centre, nominal) >= first) & (np.minimum(centre, nominal) <= last)
    centre, nominal = centre[inside], nominal[inside]
    return Bands(nominal, centre, centre * G ** (-1.0 / 6.0), centre * G ** (1.0 / 6.0))


def bands_of(frequency: FloatArray) -> Bands:
    """The bands with their centres among the lines (f,) [Hz]; 0 Hz is in none."""
    positive = frequency[frequency > 0.0]
    if not len(positive):
        return Bands(*np.empty((4, 0)))
    return third_octaves(float(positive[0]), float(positive[-1]))


def lines_in(bands: Bands, frequency: FloatArray) -> IntArray:
    """(b,) how many of the lines (f,) are within each band."""
    within = np.searchsorted(frequency, [bands.lower, bands.upper])
    return within[1] - within[0]


def band_mean_square(frequency: FloatArray, square: FloatArray, bands: Bands) -> FloatArray:
    """(..., b) means over the bands of squares (..., f) at lines (f,), evenly spaced or not.

    Between two lines the square is taken as linear: with lines a fifth of the half-power width
    apart, the band of a resonance with a loss factor of 0.02 to 0.1 is right to 0.03 dB, with a
    half to 0.2 dB. NaN for a band that the lines do not cover from edge to edge, that has no line
    of its own, or that needs a line without an answer.
    """
    means = np.full((*square.shape[:-1], len(bands)), np.nan)
    counts = lines_in(bands, frequency)
    for b, (lower, upper) in enumerate(zip(bands.lower, bands.upper, strict=True)):
        if counts[b] and frequency[0] <= lower and upper <= frequency[-1]:
            inside = (frequency > lower) & (frequency < upper)
            at = np.concatenate([[lower], frequency[inside], [upper]])
            ends = [_between(frequency, square, edge)[..., None] for edge in (lower, upper)]
            values = np.concatenate([ends[0], square[..., inside], ends[1]], axis=-1)
            means[..., b] = np.trapezoid(values, at, axis=-1) / (upper - lower)
    return means


def _between(frequency: FloatArray, square: FloatArray, at: float) -> FloatArray:
    """(...) squares (..., f) at a frequency within the lines, linear between two of them."""
    k = int(np.searchsorted(frequency, at, side="right")) - 1
    if frequency[k] == at:
        return square[..., k]
    share = (at - frequency[k]) / (frequency[k + 1] - frequency[k])
    value: FloatArray = (1.0 - share) * square[..., k] + share * square[..., k + 1]
    return value


def in_bands(
    results: Results | SweepResults, load: str, probe: str, quantity: Quantity = "mobility"
) -> tuple[Bands, FloatArray]:
    """One-third octaves, and the mean squares (..., b) of a response in them.

    probe: the name of a probe or of a region.

    Raises ResultsError for an unknown name.
    """
    bands = bands_of(results.frequency)
    if probe in regions_of(results.probes):
        i = index_of(load, [place.name for place in results.loads], "load")
        square = space_mean_square(results, probe, quantity)[..., i, :]
    else:
        square = np.abs(results.response(load, probe, quantity)) ** 2
    return bands, band_mean_square(results.frequency, square, bands)


def regions_of(probes: Sequence[Place]) -> dict[str, list[int]]:
    """Regions by name, each with the numbers of the probes that sample it."""
    regions: dict[str, list[int]] = {}
    for j, probe in enumerate(probes):
        if probe.kind == REGION:
            regions.setdefault(probe.name.rpartition(".")[0], []).append(j)
    return regions


def single_probes(probes: Sequence[Place]) -> list[int]:
    """Numbers of the probes that sample no region."""
    return [j for j, probe in enumerate(probes) if probe.kind != REGION]


def space_mean_square(
    results: Results | SweepResults, region: str | Sequence[str], quantity: Quantity = "mobility"
) -> FloatArray:
    """(..., l, f) mean of |X|^2 over a region, per load; the parameters of a sweep lead.

    region: the name of a region, or names of probes. A region's points are evenly spread in arc
    length and angle, so that each stands for an area in proportion to its distance from the axle:
    that is its weight. Probes by name count equally. Raises ResultsError for an unknown name.
    """
    index_of(quantity, get_args(Quantity), "quantity")
    if isinstance(region, str):
        regions = regions_of(results.probes)
        index_of(region, tuple(regions), "region")
        probes = regions[region]
        weights = np.array([results.probes[j].r for j in probes])
    else:
        names = [probe.name for probe in results.probes]
        probes = [index_of(name, names, "probe") for name in region]
        weights = np.ones(len(probes))
    if not probes:
        raise ResultsError("no probes to average over; name at least one")
    square = np.abs(getattr(results, quantity)[..., probes, :]) ** 2
    mean: FloatArray = np.einsum("...pf,p->...f", square, weights / weights.sum())
    return mean
