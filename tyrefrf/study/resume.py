"""Whether a run that was ended can be gone on with: only by the same program, for the same case."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from importlib.metadata import version
from typing import Any

from tyrefrf.case import Case, case_hash, resolved_toml
from tyrefrf.errors import CommandError, Key, Problem
from tyrefrf.results import Provenance
from tyrefrf.results.left import Left
from tyrefrf.study.choose import with_solver

MOST_SHOWN = 10
"""Differences between two cases in a message."""

BEGIN_ANEW = "--force begins anew, --output DIR writes somewhere else"


def resumed(case: Case, left: Left) -> Case:
    """The case, with the solver that the run which left this has picked if it is left open.

    Raises CommandError, and shows the differences, where that run was of another case, by the hash
    of the resolved one, or by another version of the program.
    """
    origin = left.results.provenance
    if origin.version != version("tyrefrf"):
        raise CommandError(
            f"begun by tyrefrf {origin.version}, and this is {version('tyrefrf')}: lines of both "
            f"in one file would not be one result; {BEGIN_ANEW}"
        )
    if case.solver.name == "auto":
        case = with_solver(case, origin.solver)
    if case_hash(case) != origin.case_hash:
        raise CommandError("\n".join([*_what_differs(origin, case), BEGIN_ANEW]))
    return case


def _what_differs(origin: Provenance, case: Case) -> Iterator[str]:
    before = dict(_values(tomllib.loads(origin.resolved_case)))
    now = dict(_values(tomllib.loads(resolved_toml(case))))
    places = [place for place in {**before, **now} if before.get(place) != now.get(place)]
    places = [place for place in places if place[0] != "sweep"]  # has no part in the hash
    if not places:
        yield "begun with other contents of the files that the case names:"
        return
    yield "begun with another case:"
    for place in places[:MOST_SHOWN]:
        words = " -> ".join(_shown(values, place) for values in (before, now))
        yield f"  {Problem(place, '').place}: {words}"
    if len(places) > MOST_SHOWN:
        yield f"  and {len(places) - MOST_SHOWN} more"


def _values(data: Any, place: Key = ()) -> Iterator[tuple[Key, object]]:
    """Every value of a case with its place."""
    if isinstance(data, dict | list) and data:
        parts = data.items() if isinstance(data, dict) else enumerate(data)
        for part, inner in parts:
            yield from _values(inner, (*place, part))
    else:
        yield place, data


def _shown(values: dict[Key, object], place: Key) -> str:
    return repr(values[place]) if place in values else "not there"
