"""Proof of what was computed: residual, passivity and reciprocity of every line.

A tyre at rest takes power and gives none: the forces F at the loads' own points put in
Re(F^H Y F)/2 >= 0 whatever they are, so Re Y >= 0 at every driving point, and the Hermitian part
(Y + Y^H)/2 of the loads' own block of mobilities is positive semidefinite. Its K, C and M are
symmetric, so the response at one load's point to another load is the same the other way round.

Source: Cremer, Heckl & Petersson, Structure-Borne Sound (2005), on mobilities.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, IntArray

if TYPE_CHECKING:
    from tyrefrf.results.results import Results

RESIDUAL_LIMIT = 1e-8
"""Residual above which a line, though it has its answer, breaches. Damped tyres stay below 4e-9
(`tyrefrf.solvers.problem.RESIDUAL_MAX`, above which there is no answer)."""

ROUNDING = 1e-10
"""Share of a response that may be rounding, whatever its residual."""

AMPLIFICATION = 1000.0
"""How many times its line's residual a response may be wrong, as a share of the load's largest
response. The error of H_ij is q_i^T (F_j - D q_j), the whole ring's motion against a response.
Measured where no loss hides it, on the homogeneous tyre with eta = 0, at 300 lines and at 84 from
1e-9 to 1e-3 beside resonances: up to 4 for Re Y, up to 39 for H_ij - H_ji."""

WRONG_AT_MOST = AMPLIFICATION * RESIDUAL_LIMIT
"""1e-5: by how much a response on a line that passes may be wrong, as a share of the load's largest
response. Rounding of the matrices themselves included, of the mesh's discretisation nothing.
Measured against 80-bit numbers (tests/solvers/test_digits.py) for cells from 0.0036 to 360 degrees,
walls down to a micrometre, steel beside rubber of 28 MPa down to 10 Pa, every brick, 0 to 300 Hz:
the error of the driven section is up to 190 times the residual. Sections that hardly move are less
right relative to themselves: up to 530 times the residual above 1e-9, 2000 times below.
Where a damped tyre's loads do not tell of a soft motion, up to 1e-5 whatever the residual
(`tyrefrf.solvers.problem.BLIND`)."""

DIFFERENCE_LIMIT = 1e-8
"""Difference of two solvers' responses, relative to their norm, above which one of them is wrong,
unless their residuals explain more."""

TRUNCATED = ("modal",)
"""Solvers that do not solve the ring's equations to rounding: reported, and not judged."""


@dataclass(frozen=True, slots=True)
class Worst:
    """The worst value of a measure, its line [Hz], and its load if it is a load's own."""

    value: float
    frequency: float
    load: str = ""


@dataclass(frozen=True, slots=True)
class Measure:
    """One thing that every line proves: how it is taken, and whether large or small is bad.

    of: results to (f,) or (l, f), NaN where there is nothing to say. worst: index of the worst.
    """

    of: Callable[[Results], FloatArray]
    worst: Callable[[FloatArray], Any]

    def worst_of(self, results: Results) -> Worst | None:
        """The worst of the lines that were solved; None where none says anything."""
        values = np.where(results.solved, self.of(results), np.nan)
        if np.isnan(values).all():
            return None
        index = np.unravel_index(self.worst(values), values.shape)
        load = results.loads[int(index[0])].name if values.ndim == 2 else ""
        return Worst(float(values[index]), float(results.frequency[index[-1]]), load)


def passivity(results: Results) -> FloatArray:
    """(l, f) Re Y / |Y| at every load's own point; NaN where nothing moves, as at 0 Hz."""
    loads, probes = own_points(results)
    share = np.full((len(results.loads), len(results.frequency)), np.nan)
    Y = results.mobility[loads, probes]
    share[loads] = _share(Y.real, np.abs(Y))
    return share


def power(results: Results) -> FloatArray:
    """(f,) smallest eigenvalue of (Y + Y^H)/2 over ||Y||, of the loads' own block."""
    Y = own_block(results, results.mobility)
    return _share(_least_power(Y), _size(Y))


def reciprocity(results: Results) -> FloatArray:
    """(f,) max |H_ij - H_ji| over ||H||, of the loads' own block; NaN with one load."""
    H = own_block(results, results.receptance)
    return _share(_lopsided(H), _size(H)) if len(H) > 1 else np.full(H.shape[-1], np.nan)


MEASURES = {
    "residual": Measure(lambda results: results.residual, np.nanargmax),
    "passivity": Measure(passivity, np.nanargmin),
    "power": Measure(power, np.nanargmin),
    "reciprocity": Measure(reciprocity, np.nanargmax),
}
"""What every line proves."""


def breaches(results: Results) -> tuple[str, ...]:
    """A sentence for every line that breaches its proof, and for a certificate that does.

    Judged are lines that were solved: one that failed has no answer to judge, and one that was
    fitted has the fit's error. A truncated solver is not judged.
    """
    if results.provenance.solver in TRUNCATED or not results.solved.any():
        return ()
    reasons: dict[int, list[str]] = {}
    for judge in JUDGES:
        for line, reason in judge(results):
            if results.solved[line]:
                reasons.setdefault(line, []).append(reason)
    lines = (f"{results.frequency[k]:.6g} Hz: {'; '.join(reasons[k])}" for k in sorted(reasons))
    return tuple(lines)


Reasons = Iterator[tuple[int, str]]
"""Lines by their numbers, and what is wrong with each."""


def _of_residual(results: Results) -> Reasons:
    for line in _where(results.residual > RESIDUAL_LIMIT):
        yield line, f"residual {results.residual[line]:.1e} is above {RESIDUAL_LIMIT:.0e}"


def _of_passivity(results: Results) -> Reasons:
    """Re Y of each driving point, against the load's largest response on the line."""
    mobility = results.mobility
    for i, j in zip(*own_points(results), strict=True):
        Y, size = mobility[i, j], np.abs(mobility[i]).max(axis=0)
        for line in _where(Y.real < -rounding(size, results)):
            share = Y[line].real / abs(Y[line])
            yield line, f"Re Y is {share:.1e} |Y| at {results.loads[i].name}: power comes out"


def _of_power(results: Results) -> Reasons:
    """The loads together; what shows at one of them alone is not said twice."""
    Y = own_block(results, results.mobility)
    alone = {line for line, _ in _of_passivity(results)}
    least = _least_power(Y)
    for line in _where(least < -rounding(_size(Y), results)):
        if line not in alone:
            share = least[line] / _size(Y)[line]
            yield line, f"loads together can draw power out: smallest eigenvalue {share:.1e} ||Y||"


def _of_reciprocity(results: Results) -> Reasons:
    H = own_block(results, results.receptance)
    lopsided, size = _lopsided(H), _size(H)
    for line in _where(lopsided > rounding(size, results)):
        share = lopsided[line] / size[line]
        yield line, f"responses differ by {share:.1e} when load and probe change places"


def _of_certificate(results: Results) -> Reasons:
    """The second solver's answers, beyond what both residuals explain."""
    certificate = results.certificate
    if certificate is None:
        return
    lines = np.searchsorted(results.frequency, certificate.frequency)
    explained = AMPLIFICATION * (certificate.residual + results.residual[lines])
    worst = certificate.difference.max(axis=0, initial=0.0)
    for k in _where(worst > np.maximum(DIFFERENCE_LIMIT, explained)):
        yield int(lines[k]), f"{certificate.solver} differs by {worst[k]:.1e}"


JUDGES = (_of_residual, _of_passivity, _of_power, _of_reciprocity, _of_certificate)


def rounding(size: FloatArray, results: Results) -> FloatArray:
    """(f,) what of responses of this size (f,) may be rounding.

    Where all of them are small, at an antiresonance, their error is not: it keeps the size that
    they have on most lines.
    """
    usual = np.median(size[results.solved])
    return ROUNDING * size + AMPLIFICATION * results.residual * np.maximum(size, usual)


def own_points(results: Results) -> tuple[IntArray, IntArray]:
    """The loads that have their driving point among the probes, and where it is."""
    probe = {place.name: k for k, place in enumerate(results.probes)}
    names = [f"{place.name}.drive" for place in results.loads]
    pairs = [(i, probe[name]) for i, name in enumerate(names) if name in probe]
    loads, probes = np.array(pairs, int).reshape(-1, 2).T
    return loads, probes


def own_block(results: Results, response: ComplexArray) -> ComplexArray:
    """(k, k, f) responses (l, p, f) at the loads' own points, load by load."""
    loads, probes = own_points(results)
    block: ComplexArray = response[np.ix_(loads, probes)]
    return block


def _least_power(Y: ComplexArray) -> FloatArray:
    """(f,) smallest eigenvalue of the Hermitian part of (k, k, f); NaN where there is any."""
    Y = np.moveaxis(Y, -1, 0)
    there = ~np.isnan(Y).any(axis=(1, 2))
    least = np.full(len(Y), np.nan)
    if Y.shape[1]:
        part = Y[there]
        least[there] = np.linalg.eigvalsh(part + part.conj().swapaxes(1, 2))[:, 0] / 2.0
    return least


def _lopsided(H: ComplexArray) -> FloatArray:
    """(f,) max |H_ij - H_ji| of (k, k, f)."""
    return np.abs(H - H.swapaxes(0, 1)).max(axis=(0, 1), initial=0.0)


def _size(block: ComplexArray) -> FloatArray:
    """(f,) Frobenius norm of (k, k, f)."""
    size: FloatArray = np.linalg.norm(block, axis=(0, 1))
    return size


def _share(part: FloatArray, whole: FloatArray) -> FloatArray:
    """The share part / whole, NaN where there is nothing to be a part of."""
    return part / np.where(whole == 0.0, np.nan, whole)


def _where(lines: BoolArray) -> list[int]:
    """Numbers of the lines that are true."""
    return [int(line) for line in np.flatnonzero(lines)]
