"""The tables and keys of case files in Markdown, from the models that read them."""

from __future__ import annotations

from collections.abc import Iterator
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt
from markup import Lines, plain, table
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from tyrefrf.case import Case, builtin_text, case_schema, parse_case, units
from tyrefrf.case.measured import Column
from tyrefrf.case.parameters import parameters
from tyrefrf.case.sweep import Written
from tyrefrf.case.units import Level, Quantity

Model = type[BaseModel]

DIMENSIONS = ("LENGTH", "STRESS", "DENSITY", "ANGLE", "FREQUENCY", "TIME", "RATE", "MASS")

NUMBER_OR_TEXT = [get_args(annotation)[0] for annotation in (Written, Column)]
"""Types of keys that take either as it is written."""


def case_keys() -> Lines:
    """A section for every table that a case may have."""
    return [line for model, places in tables().items() for line in section(model, places)]


def case_units() -> Lines:
    """A row for every dimension, the unit of a bare number first."""
    listed = [(name.lower(), getattr(units, name)) for name in DIMENSIONS]
    rows = [(name, next(iter(of)), ", ".join(of)) for name, of in listed]
    return table(("quantity", "bare number", "as text"), rows)


def sweep_parameters() -> Lines:
    """A row for every parameter of the built-in tyre."""
    case = parse_case(builtin_text(), "built-in tyre", "tyre")
    rows = [(f"`{p.name}`", f"`{p.place}`", p.units, p.meaning) for p in parameters(case)]
    return table(("name", "place", "unit", "what"), rows)


def tables() -> dict[Model, list[str]]:
    """Every table with the places where a case may have it, each before the tables within it."""
    found: dict[Model, list[str]] = {}

    def visit(model: Model, place: str) -> None:
        found.setdefault(model, []).append(place)
        for name, field in model.model_fields.items():
            for inner, suffix in _models_in(field.annotation):
                visit(inner, f"{place}.{name}{suffix}".lstrip("."))

    visit(Case, "")
    return found


def _models_in(annotation: Any, suffix: str = "") -> Iterator[tuple[Model, str]]:
    """The tables of a key's type, with what stands behind the key."""
    origin, parts = get_origin(annotation), get_args(annotation)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation, suffix
    elif origin is dict:
        yield from _models_in(parts[1], f"{suffix}.NAME")
    elif origin is tuple:
        yield from _models_in(parts[0], f"{suffix}[]")
    else:
        for part in parts[:1] if origin is Annotated else parts:
            yield from _models_in(part, suffix)


def section(model: Model, places: list[str]) -> Lines:
    """A table's section: where it stands, what it is, its keys."""
    kind = _kind(model)
    title = "Keys of the case itself" if model is Case else f"`{_header(places[0])}`"
    headers = dict.fromkeys(f"`{_header(place)}`" for place in places)
    also = ", ".join(list(headers)[1:])
    first = [f'With `kind = "{kind}"`.'] if kind else []
    first += [f"Also {also}."] if also else []
    words = plain(" ".join([*first, *(model.__doc__ or "").split()]))
    fields = sorted(model.model_fields.items(), key=lambda entry: entry[0] != "kind")
    rows = [
        (f"`{name}`", in_words(field), _default(model, name), plain(field.description or ""))
        for name, field in fields
    ]
    name = f"{title}: {kind}" if kind else title
    return [f"({anchor(model)})=", f"## {name}", "", words, "", *table(HEAD, rows)]


HEAD = ("key", "takes", "default", "meaning")


def anchor(model: Model) -> str:
    """The label of a table's section."""
    return f"case-{model.__name__.lower()}"


def _kind(model: Model) -> str:
    """The value of `kind` that chooses this table, or nothing."""
    if "kind" not in model.model_fields:
        return ""
    annotation = model.model_fields["kind"].annotation
    values = get_args(annotation) if get_origin(annotation) is Literal else ()
    return str(values[0]) if len(values) == 1 else ""


def _header(place: str) -> str:
    """How a place is written in TOML: `[[loads]]`, `[geometry.tread]`."""
    bare = place.replace("[]", "")
    return f"[[{bare}]]" if place.endswith("[]") else f"[{bare}]"


def _default(model: Model, name: str) -> str:
    """A key's default as TOML has it; nothing where its meaning says what is without it."""
    field = model.model_fields[name]
    if field.is_required():
        optional = model is Case and name not in case_schema()["required"]
        return "" if optional else "required"
    value = field.get_default(call_default_factory=True)
    match value:
        case None | BaseModel() | {}:
            return ""
        case bool():
            return f"`{str(value).lower()}`"
        case str():
            return f'`"{value}"`'
        case tuple():
            return f"`{list(value)}`".replace("'", '"')
        case _:
            return f"`{value:g}`"


def in_words(field: FieldInfo) -> str:
    """What a key takes."""
    return _words(field.annotation, tuple(field.metadata))


def _words(annotation: Any, rules: tuple[Any, ...] = ()) -> str:
    """A type with its rules, in words."""
    origin, parts = get_origin(annotation), get_args(annotation)
    if annotation in NUMBER_OR_TEXT:
        return "number or text"
    if origin is Annotated:
        return _words(parts[0], (*parts[1:], *rules))
    if origin in (Union, UnionType):
        written = [_words(part, rules) for part in parts if part is not NoneType]
        return " or ".join(dict.fromkeys(written))
    if origin is Literal:
        return ", ".join(f'`"{value}"`' for value in parts)
    if origin is tuple:
        return f"list of {_words(parts[0])}"
    if origin is dict:
        return f"tables by name: {_words(parts[1])}"
    if issubclass(annotation, BaseModel):
        return f"[{_kind(annotation) or 'table'}](#{anchor(annotation)})"
    quantity = next((rule for rule in rules if isinstance(rule, Quantity)), None)
    if quantity is not None:
        return _of_quantity(quantity)
    kinds = {float: "number", int: "whole number", str: "text", bool: "true or false"}
    return kinds[annotation] + "".join(_bounds(rules))


def _of_quantity(quantity: Quantity) -> str:
    """A number with a unit and bounds."""
    unit = "number, or text in dB" if isinstance(quantity, Level) else next(iter(quantity.units))
    limits = {"above": quantity.gt, "at least": quantity.ge, "at most": quantity.le}
    return unit + "".join(f", {word} {x:.10g}" for word, x in limits.items() if x is not None)


def _bounds(rules: tuple[Any, ...]) -> Iterator[str]:
    """The bounds of a number."""
    for rule in rules:
        for limit in getattr(rule, "metadata", [rule]):  # of a FieldInfo, or a rule itself
            match limit:
                case Ge(ge=x):
                    yield f", at least {x:.10g}"
                case Gt(gt=x):
                    yield f", above {x:.10g}"
                case Le(le=x):
                    yield f", at most {x:.10g}"
                case Lt(lt=x):
                    yield f", below {x:.10g}"
