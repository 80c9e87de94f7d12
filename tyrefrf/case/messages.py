"""Pydantic's errors in plain words: what was found, what is expected, what to try."""

from __future__ import annotations

import re
from collections.abc import Iterator
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError
from pydantic_core import ErrorDetails

from tyrefrf.case.faults import did_you_mean, number_text, shown
from tyrefrf.case.model import Case
from tyrefrf.errors import Key, Problem

_KINDS = {
    "float_type": "a number",
    "finite_number": "a finite number",
    "bool_type": "true or false",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "text in quotes",
    "tuple_type": "a list",
    "dict_type": "a table",
    "model_type": "a table",
}
_BOUNDS = {
    "greater_than": ("above", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("below", "lt"),
    "less_than_equal": ("at most", "le"),
}


def problems_of(error: ValidationError, at: Key = ()) -> Iterator[Problem]:
    """Yield a problem per thing wrong within a table of the case, or in a value `at` a key.

    What is wrong between tables is left to `cross_faults`, which sees the whole file.
    """
    for detail in error.errors(include_url=False):
        yield from _problems({**detail, "loc": at + detail["loc"]})


def _problems(detail: ErrorDetails) -> Iterator[Problem]:
    loc = detail["loc"]
    key, found, context = _without_tag(loc), detail["input"], detail.get("ctx", {})
    match detail["type"]:
        case "faults" if loc:
            for fault in context["faults"]:
                yield Problem(key + fault.key, fault.message)
        case "faults":
            return
        case "missing":
            yield Problem(key, f"missing: {_description(loc)}")
        case "extra_forbidden":
            yield Problem(key, _unknown_key(loc))
        case "union_tag_not_found" if isinstance(found, dict):
            yield Problem((*key, "kind"), f"missing: one of {', '.join(_kinds(_inside(loc)))}")
        case "union_tag_not_found":
            yield Problem(key, f"{shown(found)} is not a table")
        case "union_tag_invalid":
            message = _not_one_of(context["tag"], context["expected_tags"])
            yield Problem((*key, "kind"), message)
        case "literal_error":
            yield Problem(key, _not_one_of(found, context["expected"]))
        case "too_short" if len(found) >= context["min_length"]:
            return  # the entries that are there have errors of their own
        case "too_short" | "too_long" as kind:
            yield Problem(key, _wrong_length(kind, len(found), context))
        case kind if kind in _BOUNDS:
            words, bound = _BOUNDS[kind]
            limit = f"must be {words} {number_text(context[bound])}"
            yield Problem(key, f"{shown(found)} is out of range; {limit}")
        case kind if kind in _KINDS:
            yield Problem(key, f"{shown(found)} is not {_KINDS[kind]}")
        case _:
            yield Problem(key, f"{shown(found)} is not valid; expected: {_description(loc)}")


def _without_tag(loc: Key) -> Key:
    """Drop the kinds of tables, which pydantic puts behind their names or indices."""
    loc = loc[:-1] if loc[-1:] == ("[key]",) else loc
    return tuple(part for n, part in enumerate(loc) if not _kinds(_inside(loc[:n])))


def _not_one_of(found: object, expected: str) -> str:
    choices = re.findall(r"'([^']*)'", expected)  # pydantic writes 'r', 'y' or 'theta'
    hint = did_you_mean(found, choices) if isinstance(found, str) else ""
    return f"{shown(found)} is not one of {', '.join(choices)}{hint}"


def _wrong_length(kind: str, length: int, context: dict[str, Any]) -> str:
    if kind == "too_long":
        return f"{length} entries are too many; must be at most {context['max_length']}"
    found = f"has only {length}" if length else "is empty"
    return f"{found}; must have at least {context['min_length']}"


def _unknown_key(loc: Key) -> str:
    fields = _inside(loc[:-1]).model_fields
    here = f" for kind '{loc[-2]}'" if "kind" in fields else ""
    hint = did_you_mean(str(loc[-1]), fields) or f"; the keys here are {', '.join(fields)}"
    return f"unknown key{here}{hint}"


def _description(loc: Key) -> str:
    if loc[-1] == "[key]":  # a material's name
        return "one line of 1 to 100 characters"
    fields = getattr(_inside(loc[:-1]), "model_fields", None)
    if fields is None:  # an entry of a table of names, or one of its forms
        return _description(loc[:-1])
    return fields[str(loc[-1])].description or ""


def _inside(loc: Key) -> Any:
    """Return the type of the case's data at `loc`."""
    here: Any = Case
    for part in loc:
        here = _step(here, part)
    return _bare(here)


def _step(here: Any, part: str | int) -> Any:
    here = _bare(here)
    if isinstance(here, type) and issubclass(here, BaseModel):
        field = here.model_fields.get(str(part))
        return field.annotation if field else None
    kinds = _kinds(here)
    if kinds:
        return kinds[str(part)]
    args = get_args(here) or (None,)
    return args[-1] if get_origin(here) is dict else args[0]


def _kinds(here: Any) -> dict[str, Any]:
    """Return the tables that stand at a place by their `kind`; none if it takes only one."""
    here = _bare(here)
    if get_origin(here) not in (Union, UnionType):
        return {}
    return {
        tag.tag: get_args(kind)[0]
        for kind in get_args(here)
        for tag in getattr(kind, "__metadata__", ())
        if isinstance(tag, Tag)
    }


def _bare(here: Any) -> Any:
    """Return a type without its annotations, and without the None of a key that may be absent."""
    origin, args = get_origin(here), [arg for arg in get_args(here) if arg is not NoneType]
    if origin is Annotated or (origin in (Union, UnionType) and len(args) == 1):
        return _bare(args[0])
    return here
