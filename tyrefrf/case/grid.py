"""A grid of cases: one for every combination of the values of some parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod
from typing import Any, TypeVar

from tyrefrf.case.axis import Axis
from tyrefrf.case.bounds import MAX_RESPONSES, n_responses
from tyrefrf.case.load import build_case
from tyrefrf.case.model import Case
from tyrefrf.case.parameters import Parameter, find_parameter, read_values
from tyrefrf.case.resolved import resolved
from tyrefrf.case.sweep import Values
from tyrefrf.errors import CaseError, Key, MeshError, Problem

MAX_POINTS = 10_000

Point = tuple[int, ...]
Made = TypeVar("Made")


@dataclass(frozen=True, slots=True)
class Grid:
    """A case at all its points; `cases` in the order of the axes, the last one fastest."""

    base: Case
    axes: tuple[Axis, ...]
    cases: tuple[Case, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Values along every axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def points(self) -> tuple[Point, ...]:
        """Indices along the axes of every case."""
        return _points(self.axes)

    def each(self, make: Callable[[Case], Made]) -> list[Made]:
        """make(case) at every point, or one CaseError with all points where it failed."""
        return _at_all(self.axes, self.cases, make, [])


def make_grid(case: Case, wanted: Mapping[str, Values | None]) -> Grid:
    """The cases that differ from this one by the wanted parameters' values.

    wanted: by place or short name, the values as [sweep] takes them; None for those of the
    case's own [sweep]. Raises CaseError with everything that is wrong with any of them.
    """
    problems: list[Problem] = []
    axes: list[tuple[Parameter, Axis]] = []
    for name, values in wanted.items():
        try:
            parameter = find_parameter(case, name)
            given = _own_values(case, parameter) if values is None else values
        except CaseError as error:
            problems.extend(error.problems)
            continue
        if parameter.key in [other.key for other, _ in axes]:
            problems.append(Problem((parameter.name,), "named twice; give it once"))
            continue
        right, faults = read_values(parameter, given)
        problems += [Problem((parameter.name,), fault.message) for fault in faults]
        axes.append((parameter, parameter.axis(right)))
    problems += (too_large := list(_too_large(case, [axis for _, axis in axes])))
    if too_large or (problems and not all(axis.values for _, axis in axes)):
        raise CaseError(problems)
    return _grid(case, axes, problems)


def _too_large(case: Case, axes: Sequence[Axis]) -> Iterator[Problem]:
    """Why these axes have too many points, or the case too many responses for them."""
    points = prod(len(axis.values) for axis in axes)
    responses = points * n_responses(case)
    if points > MAX_POINTS:
        yield Problem((), f"the grid has more than {MAX_POINTS} points; use fewer")
    elif responses > MAX_RESPONSES:
        made = f"the grid's {points} points make {responses} responses"
        yield Problem((), f"{made}; must be at most {MAX_RESPONSES}: use fewer points or lines")


def _own_values(case: Case, parameter: Parameter) -> Values:
    """The values of a parameter in the case's own [sweep]."""
    names = {find_parameter(case, name).key: name for name in case.sweep}
    if parameter.key in names:
        return case.sweep[names[parameter.key]]
    has = f"has {', '.join(case.sweep)}" if case.sweep else "is empty"
    message = f"no values; give --values, --range or --log (the case's [sweep] {has})"
    raise CaseError([Problem((parameter.name,), message)])


def _grid(case: Case, axes: list[tuple[Parameter, Axis]], problems: list[Problem]) -> Grid:
    plain = {key: value for key, value in resolved(case).items() if key != "sweep"}
    values = list(product(*(axis.values for _, axis in axes)))

    def changed(point: tuple[float, ...]) -> Case:
        data = plain
        for (parameter, _), value in zip(axes, point, strict=True):
            data = _with(data, parameter, value)
        return build_case(data, case.name).with_files_of(case)

    cases = _at_all([axis for _, axis in axes], values, changed, problems)
    return Grid(case, tuple(axis for _, axis in axes), tuple(cases))


def _with(data: dict[str, Any], parameter: Parameter, value: float) -> dict[str, Any]:
    """The case's data with another value in the parameter's place."""
    number = int(value) if parameter.whole else value

    def replaced(here: dict[str, Any], parts: Sequence[str | int]) -> dict[str, Any]:
        first, *rest = parts
        inner = replaced(here.get(str(first), {}), rest) if rest else number
        return {**here, str(first): inner}

    return replaced(data, parameter.key)


Item = TypeVar("Item")


def _at_all(
    axes: Sequence[Axis],
    items: Sequence[Item],
    make: Callable[[Item], Made],
    problems: Sequence[Problem],
) -> list[Made]:
    """make(item) at every point; one CaseError with these problems and all points' own."""
    made: list[Made] = []
    where: dict[tuple[Key, str], list[Point]] = {}
    for point, item in zip(_points(axes), items, strict=True):
        try:
            made.append(make(item))
        except CaseError as error:
            for problem in error.problems:
                where.setdefault((problem.key, problem.message), []).append(point)
        except MeshError as error:
            where.setdefault(((), str(error)), []).append(point)
    found = [
        Problem((), ": ".join(filter(None, (_common(axes, points), place, message))), at=key)
        for (key, message), points in where.items()
        for place in [Problem(key, "").words]
    ]
    if problems or found:
        raise CaseError([*problems, *found])
    return made


def _common(axes: Sequence[Axis], points: Sequence[Point]) -> str:
    """The values that all these points have in common: what is to blame."""
    shared = [
        (axis, indices[0])
        for axis, indices in zip(axes, zip(*points, strict=True), strict=True)
        if len(set(indices)) == 1
    ]
    telling = [(axis, index) for axis, index in shared if len(axis.values) > 1] or shared
    return ", ".join(axis.label(index) for axis, index in telling) or "at several points"


def _points(axes: Sequence[Axis]) -> tuple[Point, ...]:
    return tuple(product(*(range(len(axis.values)) for axis in axes)))
