"""Going on with a run that was ended: only by the same program, and for the same case."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any

from tyrefrf.case import Case, case_hash, resolved_toml
from tyrefrf.case.axis import Axis
from tyrefrf.errors import CommandError, Key, Problem
from tyrefrf.results import Provenance, SweepResults
from tyrefrf.results.journal import Journal
from tyrefrf.results.left import Left, Responses, read_journal
from tyrefrf.results.lock import only_writer
from tyrefrf.study.choose import with_solver
from tyrefrf.study.spectrum import UNRECORDED, Record

MOST_SHOWN = 10
"""Differences between two cases in a message."""


def resumed(case: Case, left: Left) -> Case:
    """The case, with the solver that the run which left this has picked if it is left open.

    Raises CommandError, and shows the differences, where that run was of another case, by the hash
    of the resolved one, or by another version of the program.
    """
    origin = left.results.provenance
    if origin.version != version("tyrefrf"):
        raise CommandError(
            f"begun by tyrefrf {origin.version}, and this is {version('tyrefrf')}: lines of both "
            "in one file would not be one result"
        )
    if case.solver.name == "auto":
        case = with_solver(case, origin.solver)
    if case_hash(case) != origin.case_hash:
        raise CommandError("\n".join(_what_differs(origin, case)))
    return case


def check_kind(left: Left, kind: type[Responses]) -> None:
    """Raise CommandError where what was left is of another command."""
    if not isinstance(left.results, kind):
        raise CommandError("holds results of another command")


def check_axes(now: Sequence[Axis], left: Left) -> None:
    """Raise CommandError where the sweep that left this had other parameters or values."""
    assert isinstance(left.results, SweepResults)
    before = left.results.axes
    if before != tuple(now):
        raise CommandError(f"begun with other parameters: {_of(before)} -> {_of(now)}")


def _of(axes: Sequence[Axis]) -> str:
    """Parameters and their values."""
    texts = (
        f"{axis.name} = {', '.join(axis.text(i) for i in range(len(axis.values)))}" for axis in axes
    )
    return "; ".join(texts)


@contextmanager
def recorded(
    case: Case, file: str | Path | None, kind: type[Responses]
) -> Iterator[tuple[Case, Record, Left | None]]:
    """A journal at `file`, with what is there; the case as `resumed` decides it; and what was left.

    kind: of the results. Without a file nothing is recorded. Raises CommandError as `resumed`, and
    ResultsError where the file is no journal, or somebody else is writing it.
    """
    if file is None:
        yield case, UNRECORDED, None
        return
    path = Path(file)
    with only_writer(path):
        left = read_journal(path) if path.exists() else None
        if left is not None:
            check_kind(left, kind)
            case = resumed(case, left)
        with Journal(path, left.answered if left else ()) as journal:
            yield case, journal, left


def _what_differs(origin: Provenance, case: Case) -> Iterator[str]:
    before = dict(_values(tomllib.loads(origin.resolved_case)))
    now = dict(_values(tomllib.loads(resolved_toml(case))))
    places = [place for place in {**before, **now} if before.get(place) != now.get(place)]
    places = [place for place in places if place[0] != "sweep"]  # has no part in the hash
    if not places:
        yield "begun with other contents of the files that the case names"
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
