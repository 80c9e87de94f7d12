"""The file of a sweep: a run's datasets, with the parameters as leading dimensions.

- What each line has one of is stacked, and so is what differs between points, as the places of
  loads and probes when the mesh changes.
- A group, such as `section`, is there once where all points share it; else `section_0`,
  `section_1`, ... are the different ones, and `section_index` says which one a point has; -1
  where it has none.
- `point` holds what else differs between points: the resolved case, its hash, sizes, times.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields as attributes
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefrf.case.axis import Axis
from tyrefrf.results.field import Columns, Dataset, Field, Kind
from tyrefrf.results.file import array_of, plain, provenance_of
from tyrefrf.results.results import Provenance
from tyrefrf.results.run_layout import fields_of, fields_read, results_of
from tyrefrf.results.sweep import SweepResults

POINT = "point"
NONE = -1

_KINDS: dict[type, Kind] = {str: "text", float: "float", int: "int"}


def sweep_datasets(sweep: SweepResults) -> list[Dataset]:
    """Every dataset of a sweep's file, axes first."""
    tables = [fields_of(point) for point in sweep.points]
    groups = dict.fromkeys(field.group for table in tables for field in table)
    root = [field for field in tables[0] if not field.group]
    taken = {
        field.name.rpartition("/")[2]
        for table in tables
        for field in table
        if field.is_scale or not field.group
    }
    names = _axis_names(sweep.axes, taken)
    datasets = [_axis_dataset(name, axis) for name, axis in zip(names, sweep.axes, strict=True)]
    datasets += [_stacked(sweep, names, field) for field in root]
    for group in filter(None, groups):
        members = [[field for field in table if field.group == group] for table in tables]
        datasets += _grouped(sweep, names, group, members)
    return datasets + list(_own_facts(sweep, names))


def read_sweep(file: Any) -> SweepResults:
    """The sweep that an open file holds."""
    axes = _axes_of(file)
    points = [
        results_of(_columns_at(file, point), _provenance_at(file, point))
        for point in product(*(range(len(axis.values)) for axis in axes))
    ]
    return SweepResults(axes, tuple(points), provenance_of(file))


def _axes_of(file: Any) -> tuple[Axis, ...]:
    """The parameters: what leads a run's own dimensions."""
    mobility = file["mobility"]
    return tuple(_axis_of(mobility.dims[n][0]) for n in range(mobility.ndim - 3))


def _axis_of(scale: Any) -> Axis:
    return Axis(
        name=scale.attrs["parameter"],
        place=scale.attrs["place"],
        units=scale.attrs["units"],
        meaning=scale.attrs["long_name"],
        values=tuple(scale[...].tolist()),
    )


def _columns_at(file: Any, point: tuple[int, ...]) -> Columns:
    """Every array of a point."""
    table = fields_read(file, with_inflation=has_group(file, "inflation", point))
    return {field.name: _column(file, field, point) for field in table}


def _column(file: Any, field: Field, point: tuple[int, ...]) -> NDArray[Any]:
    dataset = file[stored_name(file, field, point)]
    return array_of(dataset, field.kind, point if dataset.ndim > len(field.axes) else ...)


def has_group(file: Any, group: str, point: tuple[int, ...]) -> bool:
    """Whether a point has a group at all."""
    index = f"{group}_index"
    return int(file[index][point]) != NONE if index in file else group in file


def stored_name(file: Any, field: Field, point: tuple[int, ...]) -> str:
    """Where a file keeps a point's dataset: in its own group, if points differ in it."""
    index = f"{field.group}_index"
    if not field.group or index not in file:
        return field.name
    return _in_group(field.group, int(file[index][point]), field.name)


def _provenance_at(file: Any, point: tuple[int, ...]) -> Provenance:
    """The case's provenance with what is the point's own."""
    known = {attribute.name for attribute in attributes(Provenance)}
    own = {name: _value(dataset, point) for name, dataset in file[POINT].items()}
    numbers = {name: value for name, value in own.items() if name not in known}
    changed = {name: value for name, value in own.items() if name in known}
    return replace(provenance_of(file), numbers=numbers, **changed)


def _value(dataset: Any, point: tuple[int, ...]) -> Any:
    """One value of a dataset, as Python's own type."""
    value = dataset[point]
    return value.decode() if isinstance(value, bytes) else plain(value)


def _axis_names(axes: tuple[Axis, ...], taken: set[str]) -> tuple[str, ...]:
    """Names that HDF5 does not take for paths, and that are not taken by others.

    taken: datasets beside them, and axes in groups, which inherit these axes.
    """
    names: list[str] = []
    for axis in axes:
        name = axis.name.replace("/", "_").strip(".")
        while name in taken or name in names or name in (POINT, ""):
            name += "_"
        names.append(name)
    return tuple(names)


def _axis_dataset(name: str, axis: Axis) -> Dataset:
    more = (("parameter", axis.name), ("place", axis.place))
    field = Field(name, (name,), "float", axis.units, axis.meaning, _nothing, more)
    return field, np.array(axis.values)


def _stacked(sweep: SweepResults, names: tuple[str, ...], field: Field) -> Dataset:
    """A dataset with the parameters leading, or without them where it is always the same."""
    arrays = [field.of(point) for point in sweep.points]
    of_lines = "frequency" in field.axes and not field.is_scale
    if not of_lines and all(_same(array, arrays[0]) for array in arrays):
        return field, arrays[0]
    stacked = np.stack(arrays).reshape(*sweep.shape, *arrays[0].shape)
    return replace(field, axes=names + field.axes), stacked


def _grouped(
    sweep: SweepResults, names: tuple[str, ...], group: str, members: list[list[Field]]
) -> list[Dataset]:
    """A group's datasets once for every different one, and which one each point has.

    members: the group's datasets at every point, none where a point lacks the group.
    """
    different: list[list[Dataset]] = []
    index = []
    for point, present in zip(sweep.points, members, strict=True):
        datasets = [(field, field.of(point)) for field in present]
        same = (k for k, other in enumerate(different) if _all_same(datasets, other))
        index.append(next(same, len(different)) if present else NONE)
        if index[-1] == len(different):
            different.append(datasets)
    if set(index) == {0}:
        return different[0]
    meaning = f"number n of the group {group}_n that belongs to the point; {NONE}: none"
    which = Field(f"{group}_index", names, "int", "1", meaning, _nothing)
    found: list[Dataset] = [(which, np.array(index).reshape(sweep.shape))]
    for k, datasets in enumerate(different):
        for field, array in datasets:
            name = _in_group(group, k, field.name)
            axes = tuple(_in_group(group, k, axis) for axis in field.axes)
            found.append((replace(field, name=name, axes=axes), array))
    return found


def _own_facts(sweep: SweepResults, names: tuple[str, ...]) -> Iterator[Dataset]:
    """What provenance the points have of their own."""
    of_case = sweep.provenance
    for attribute in attributes(Provenance):
        values = [getattr(point.provenance, attribute.name) for point in sweep.points]
        if attribute.name != "numbers" and set(values) != {getattr(of_case, attribute.name)}:
            yield _own(sweep, names, attribute.name, values)
    for name in sweep.points[0].provenance.numbers:
        yield _own(sweep, names, name, [point.provenance.numbers[name] for point in sweep.points])


def _own(sweep: SweepResults, names: tuple[str, ...], name: str, values: list[Any]) -> Dataset:
    kind = _KINDS[type(values[0])]
    words = name.replace("_", " ")
    field = Field(f"{POINT}/{name}", names, kind, _UNITS.get(name, ""), words, _nothing)
    return field, np.array(values, dtype=object if kind == "text" else None).reshape(sweep.shape)


_UNITS = {"sector_angle": "rad", "n_cells": "1", "seconds": "s"}

_nothing: Callable[[Any], Any] = lambda _: ()  # noqa: E731  a field whose array is given


def _in_group(group: str, k: int, name: str) -> str:
    """`section/points` in the k-th of the groups."""
    return f"{group}_{k}{name.removeprefix(group)}"


def _all_same(some: list[Dataset], others: list[Dataset]) -> bool:
    return all(_same(one, other) for (_, one), (_, other) in zip(some, others, strict=True))


def _same(one: NDArray[Any], other: NDArray[Any]) -> bool:
    """Equal to the bit, NaN included."""
    return np.array_equal(one, other, equal_nan=one.dtype.kind in "fc")
