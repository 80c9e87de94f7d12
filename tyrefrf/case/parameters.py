"""What a sweep may change: every number of the case that belongs to the tyre itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from tyrefrf.case.axis import Axis, number_of
from tyrefrf.case.faults import Fault, did_you_mean, shown
from tyrefrf.case.geometry import Geometry
from tyrefrf.case.messages import problems_of
from tyrefrf.case.model import Case
from tyrefrf.case.sweep import Range, Values
from tyrefrf.case.units import Quantity
from tyrefrf.errors import CaseError, Key, Problem

FIXED = (
    *("name", "title", "frequency", "loads", "probes", "sensors", "measured"),
    *("solver", "output", "sweep"),
)
"""Tables of the case that are the same at every point: they make the results' other axes."""

_STRICT = ConfigDict(strict=True, allow_inf_nan=False)


@dataclass(frozen=True, slots=True)
class Parameter:
    """A number of the case, by its place: ("materials", "rubber", "E").

    shorts: names that may stand for the place where no other parameter has them.
    name: the first of these, or else the place.
    units: of a bare number. whole: whether only whole numbers will do.
    """

    key: Key
    shorts: tuple[str, ...]
    name: str
    units: str
    meaning: str
    whole: bool
    field: FieldInfo

    @property
    def place(self) -> str:
        """The key as an engineer writes it: `materials.rubber.E`."""
        return Problem(self.key, "").place

    def read(self, value: float | str) -> float:
        """The value in the case's unit. Raises CaseError, naming the parameter and the value.

        Rules between this number and others of the case are not checked.
        """
        if self.whole and isinstance(value, float) and value.is_integer():
            value = int(value)
        rules: Any = self.field.annotation
        for rule in self.field.metadata:
            rules = Annotated[rules, rule]
        try:
            return float(TypeAdapter[Any](rules, config=_STRICT).validate_python(value))
        except ValidationError as error:
            found = problems_of(error, ("value",))
            raise CaseError([Problem((self.name,), problem.message) for problem in found]) from None

    def axis(self, values: Sequence[float]) -> Axis:
        """These values along an axis of results."""
        return Axis(self.name, self.place, self.units, self.meaning, tuple(values))


def parameters(case: Case) -> tuple[Parameter, ...]:
    """Every parameter that a sweep of this case may name."""
    tables = [name for name in Case.model_fields if name not in FIXED]
    found = [p for table in tables for p in _inside((table,), getattr(case, table), "")]
    return tuple(replace(p, name=_shortest(p, found)) for p in found)


def find_parameter(case: Case, name: str) -> Parameter:
    """The parameter of a place, `materials.rubber.E`, or of a short name, `E_rubber`.

    Raises CaseError for a name that fits none or several, with those that there are.
    """
    known = parameters(case)
    for fits in _FITS:
        fitting = [p for p in known if fits(p, name)]
        if len(fitting) == 1:
            return fitting[0]
        if fitting:
            places = ", ".join(f"{p.place} ({p.name})" for p in fitting)
            raise CaseError([Problem((), f"{shown(name)} may be {places}; say which")])
    hint = did_you_mean(name, [word for p in known for word in (p.name, p.place)])
    if case.geometry is None and any(fits(p, name) for p in _sizes() for fits in _FITS):
        message = f"no parameter {shown(name)} in this case: its section has no [geometry]"
        raise CaseError([Problem((), f"{message}, but comes from a file, whose sizes are fixed")])
    there = ", ".join(p.name for p in known)
    message = f"no parameter {shown(name)} in this case; there are {there}{hint}"
    raise CaseError([Problem((), message)])


def _sizes() -> list[Parameter]:
    """The parameters of a full [geometry], which a case with a mesh file lacks."""
    layers = {name: {"material": "-"} for name in ("tread", "belt", "bead")}
    full = {"material": "-", "elements_through": 3, **layers}
    return list(_inside(("geometry",), Geometry.model_validate(full), ""))


_FITS: tuple[Callable[[Parameter, str], bool], ...] = (
    lambda p, name: p.place == name,
    lambda p, name: p.shorts[0] == name,
    lambda p, name: name in p.shorts[1:],
)
"""A place goes before a short name, and the last key alone before it with its table's name."""


def read_values(parameter: Parameter, values: Values) -> tuple[tuple[float, ...], list[Fault]]:
    """The values of a list or a range that are right, and what is wrong with the others."""
    faults: list[Fault] = []
    if isinstance(values, Range):
        ends = [_read(parameter, (), end, faults) for end in values.range]
        if faults:
            return (), faults
        low, high = (end for end in ends if end is not None)
        if values.spacing == "log" and min(low, high) <= 0:
            return (), [Fault((), "a log range needs both ends above 0")]
        found = [_read(parameter, (), value, faults) for value in _spaced(low, high, values)]
    else:
        found = [_read(parameter, (i,), value, faults) for i, value in enumerate(values)]
    for i, number in enumerate(found):
        if number is not None and number in found[:i]:
            text = parameter.axis([number]).text(0)
            faults.append(
                Fault(() if isinstance(values, Range) else (i,), f"{text} is there twice")
            )
    return tuple(dict.fromkeys(number for number in found if number is not None)), faults


def sweep_faults(case: Case) -> Iterator[Fault]:
    """Yield what is wrong in the `[sweep]` table of an otherwise right case."""
    named: dict[Key, str] = {}
    for name, values in case.sweep.items():
        try:
            parameter = find_parameter(case, name)
        except CaseError as error:
            yield from (Fault(("sweep", name), problem.message) for problem in error.problems)
            continue
        if named.setdefault(parameter.key, name) != name:
            message = f"is the same parameter as {shown(named[parameter.key])}; give it once"
            yield Fault(("sweep", name), message)
        for fault in read_values(parameter, values)[1]:
            yield Fault(("sweep", name, *fault.key), fault.message)


def _inside(key: Key, value: object, owner: str) -> Iterator[Parameter]:
    """The parameters in a table, or in a table of tables that have names of their own."""
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from _inside((*key, name), inner, name)
    elif isinstance(value, BaseModel):
        for name, field in type(value).model_fields.items():
            here = getattr(value, name)
            if isinstance(here, dict | BaseModel):
                yield from _inside((*key, name), here, owner)
            elif here is None or number_of(here) is not None:
                yield from _of_field((*key, name), field, owner)


def _of_field(key: Key, field: FieldInfo, owner: str) -> Iterator[Parameter]:
    """A field's parameter, if it takes a number."""
    for kind, metadata in _leaves(field.annotation, tuple(field.metadata)):
        if kind in (float, int):
            quantities = [item for item in metadata if isinstance(item, Quantity)]
            units = next(iter(quantities[0].units)) if quantities else "1"
            meaning = (field.description or "").partition(" [")[0]
            shorts = _shorts(key, owner)
            yield Parameter(key, shorts, "", units, meaning, kind is int, field)
            return


def _leaves(annotation: Any, metadata: tuple[Any, ...]) -> Iterator[tuple[Any, tuple[Any, ...]]]:
    """Every alternative of an annotation, with what it is annotated by."""
    origin = get_origin(annotation)
    if origin is Annotated:
        base, *more = get_args(annotation)
        yield from _leaves(base, (*more, *metadata))
    elif origin in (Union, UnionType):
        for alternative in get_args(annotation):
            yield from _leaves(alternative, metadata)
    else:
        yield annotation, metadata


def _shorts(key: Key, owner: str) -> tuple[str, ...]:
    """`E_rubber` in a table that has a name; else `width`, `belt_width`."""
    *tables, last = map(str, key)
    return (f"{last}_{owner}",) if owner else (last, f"{tables[-1]}_{last}")


def _shortest(parameter: Parameter, among: Sequence[Parameter]) -> str:
    """The first of a parameter's names by which it would be found, or else its place."""
    taken = [short for p in among if p.key != parameter.key for short in p.shorts]
    return next((short for short in parameter.shorts if short not in taken), parameter.place)


def _read(parameter: Parameter, key: Key, value: float | str, faults: list[Fault]) -> float | None:
    """One value, or None with its faults added."""
    try:
        return parameter.read(value)
    except CaseError as error:
        faults.extend(Fault(key, problem.message) for problem in error.problems)
        return None


def _spaced(low: float, high: float, values: Range) -> list[float]:
    """The range's values, with the twelve digits that their author would write."""
    shares = [k / (values.count - 1) for k in range(values.count)]
    if values.spacing == "log":
        exact = [low ** (1 - share) * high**share for share in shares]
    else:
        exact = [low * (1 - share) + high * share for share in shares]
    return [low, *(float(f"{value:.12g}") for value in exact[1:-1]), high]
