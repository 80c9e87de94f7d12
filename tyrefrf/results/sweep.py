"""What a sweep computed: the results of every point of a grid of parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from itertools import product
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray
from tyrefrf.case.axis import Axis
from tyrefrf.errors import ResultsError
from tyrefrf.mesh.place import Place
from tyrefrf.results.results import Provenance, Quantity, Results, index_of

SAME_VALUE = 1e-9
"""How near, relatively, a value that is asked for has to be to one that was computed."""


@dataclass(frozen=True, slots=True, eq=False)
class SweepResults:
    """Results at every combination of the values of some parameters.

    axes: the parameters and their values; shape: how many values each has.
    points: the results by point, the last parameter's values fastest. Frequency lines, and the
        names of loads and probes, are the same at every point.
    provenance: of the case whose parameters were changed.
    Arrays have the parameters as leading dimensions, written (...) below.
    """

    axes: tuple[Axis, ...]
    points: tuple[Results, ...]
    provenance: Provenance

    def __post_init__(self) -> None:
        if len(self.points) != prod(self.shape):
            raise ResultsError(f"{len(self.points)} points; expected {prod(self.shape)}")
        first = self.points[0]
        for point in self.points:
            if not np.array_equal(point.frequency, first.frequency):
                raise ResultsError("the points have different frequency lines")
            if point.pairs != first.pairs or point.hub != first.hub:
                raise ResultsError("the points have different loads or probes")

    @property
    def shape(self) -> tuple[int, ...]:
        """Values of every parameter."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def indices(self) -> tuple[tuple[int, ...], ...]:
        """Where every point stands on the axes."""
        return tuple(product(*map(range, self.shape)))

    @property
    def labels(self) -> tuple[str, ...]:
        """Every point in words: `E_rubber = 28 MPa, pressure = 220 kPa`."""
        return tuple(
            ", ".join(axis.label(i) for axis, i in zip(self.axes, index, strict=True))
            for index in self.indices
        )

    @property
    def frequency(self) -> FloatArray:
        """(f,) [Hz], the same at every point."""
        return self.points[0].frequency

    @property
    def loads(self) -> tuple[Place, ...]:
        """The loads at the first point; their places may shift with the mesh."""
        return self.points[0].loads

    @property
    def probes(self) -> tuple[Place, ...]:
        """The probes at the first point."""
        return self.points[0].probes

    @property
    def hub(self) -> tuple[str, ...]:
        """Names of the blocked force's components, or none."""
        return self.points[0].hub

    @property
    def receptance(self) -> ComplexArray:
        """(..., l, p, f) displacement per force [m/N]."""
        return self.stacked(lambda point: point.receptance)

    @property
    def mobility(self) -> ComplexArray:
        """(..., l, p, f) velocity per force [m/(s N)]."""
        return self.stacked(lambda point: point.mobility)

    @property
    def accelerance(self) -> ComplexArray:
        """(..., l, p, f) acceleration per force [m/(s^2 N)]."""
        return self.stacked(lambda point: point.accelerance)

    @property
    def blocked_force(self) -> ComplexArray:
        """(..., l, h, f) force and moment on the blocked hub per unit load."""
        return self.stacked(lambda point: point.blocked_force)

    @property
    def solved(self) -> BoolArray:
        """(..., f) false where a line failed, was fitted or is missing."""
        return self.stacked(lambda point: point.solved)

    @property
    def residual(self) -> FloatArray:
        """(..., f) of the ring's equations."""
        return self.stacked(lambda point: point.residual)

    @property
    def solve_time(self) -> FloatArray:
        """(..., f) [s]."""
        return self.stacked(lambda point: point.solve_time)

    @property
    def n_missing(self) -> int:
        """How many lines of all points a sweep has not come to; 0 of one that ended."""
        return sum(point.n_missing for point in self.points)

    @property
    def failed(self) -> BoolArray:
        """(..., f) true where a line was tried and has no answer."""
        return self.stacked(lambda point: point.failed)

    @property
    def n_failed(self) -> int:
        """How many lines of all points have no answer."""
        return int(self.failed.sum())

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """The names of every load with every probe."""
        return self.points[0].pairs

    @property
    def has_one_section(self) -> bool:
        """Whether all points have the same mesh of the section."""
        sections = [point.section for point in self.points]
        return all(
            np.array_equal(getattr(section, field.name), getattr(sections[0], field.name))
            for section in sections[1:]
            for field in fields(section)
        )

    def response(self, load: str, probe: str, quantity: Quantity = "mobility") -> ComplexArray:
        """(..., f) the response of a probe to a load, both by name.

        Raises ResultsError for a name that is not in the results.
        """
        return self.stacked(lambda point: point.response(load, probe, quantity))

    def driving_point(self, load: str, quantity: Quantity = "mobility") -> ComplexArray:
        """(..., f) the response of a load's own point in its own direction."""
        return self.stacked(lambda point: point.driving_point(load, quantity))

    def point(self, **values: float) -> Results:
        """The results at one value of every parameter: `point(E_rubber=28e6)`.

        A parameter with one value may be left out. Values are in the axis's units.
        Raises ResultsError for a parameter or a value that is not in the results.
        """
        names = [axis.name for axis in self.axes]
        wanted = {names[index_of(name, names, "parameter")]: values[name] for name in values}
        index = tuple(_index(axis, wanted) for axis in self.axes)
        return self.points[self.indices.index(index)]

    def level(self, load: str) -> FloatArray:
        """(...) mean level of a driving point's mobility over the lines [dB re 1 m/(s N)].

        Lines without an answer, and those where nothing moves, as at 0 Hz, do not count.
        """
        magnitude = np.abs(self.driving_point(load))
        counts = magnitude > 0.0  # NaN does not
        decibels = 20.0 * np.log10(magnitude, where=counts, out=np.zeros(magnitude.shape))
        n: FloatArray = np.where(counts.any(axis=-1), counts.sum(axis=-1), np.nan)
        return decibels.sum(axis=-1) / n

    def stacked(self, value: Callable[[Results], NDArray[Any]]) -> NDArray[Any]:
        """(..., *shape of a value): what every point has, along the parameters' axes."""
        arrays = np.stack([value(point) for point in self.points])
        return arrays.reshape(*self.shape, *arrays.shape[1:])


def _index(axis: Axis, wanted: dict[str, float]) -> int:
    """Where on the axis the wanted value is."""
    if axis.name not in wanted and len(axis.values) == 1:
        return 0
    there = ", ".join(f"{value:.6g}" for value in axis.values)
    if axis.name not in wanted:
        raise ResultsError(f"no value for {axis.name}; there are {there} [{axis.units}]")
    value = wanted[axis.name]
    near = [i for i, x in enumerate(axis.values) if abs(x - value) <= SAME_VALUE * abs(x)]
    if not near:
        raise ResultsError(f"no {axis.name} = {value:.6g}; there are {there} [{axis.units}]")
    return near[0]
