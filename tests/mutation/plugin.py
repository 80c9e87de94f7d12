"""What pytest does for mutmut: says which tests reach a function, and runs the fastest first.

mutmut notes the functions that a test calls, but what a fixture or a cache keeps is called in one
test alone. So while it takes notes, every test is given the calls of its fixtures, and caches are
emptied between the tests.
"""

from __future__ import annotations

import functools
import gc
import json
import os
import sys
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest

_called_by_fixture: dict[Any, set[str]] = {}
_properties: list[tuple[dict[str, Any], str, Any]] = []
_caches: dict[int, list[Any]] = {}
_property_of = functools.cached_property.__get__


def _noted(self: Any, instance: Any, owner: Any = None) -> Any:
    value = _property_of(self, instance, owner)
    if instance is not None and _taking_notes():
        _properties.append((instance.__dict__, self.attrname, value))
    return value


functools.cached_property.__get__ = _noted  # type: ignore[method-assign]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put a mutant's tests in order, the fastest first.

    Without a mutant mutmut runs all once more that passed while it took notes: one is enough.
    """
    notes, mutant = Path("mutmut-stats.json"), os.environ.get("MUTANT_UNDER_TEST")
    if mutant == "" and notes.exists():
        del items[1:]
    elif "__mutmut_" in (mutant or ""):
        seconds = json.loads(notes.read_text(encoding="utf-8"))["duration_by_test"]
        items.sort(key=lambda item: seconds.get(item.nodeid, 0.0))


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef: Any) -> Generator[None, Any, Any]:
    """Note what a fixture calls."""
    if not _taking_notes():
        return (yield)
    calls = _calls()
    before = set(calls)
    calls.clear()
    try:
        return (yield)
    finally:
        _called_by_fixture.setdefault(fixturedef, set()).update(calls)
        calls.update(before)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_teardown(item: Any) -> None:
    """Give a test the calls of its fixtures, and the next one empty caches."""
    if not _taking_notes():
        return
    for definitions in item._fixtureinfo.name2fixturedefs.values():
        for fixture in definitions:
            _calls().update(_called_by_fixture.get(fixture, ()))
    for attributes, name, value in _properties:
        if attributes.get(name) is value:
            del attributes[name]
    _properties.clear()
    for cache in _all_caches():
        cache.cache_clear()


def _taking_notes() -> bool:
    return os.environ.get("MUTANT_UNDER_TEST") == "stats"


def _calls() -> set[str]:
    """The functions called in the present test, as mutmut keeps them."""
    from mutmut.state import state

    return state()._stats


def _all_caches() -> list[Any]:
    """The functions of the package and of the tests that keep what they return."""
    if len(sys.modules) not in _caches:
        found = (x for x in gc.get_objects() if isinstance(x, functools._lru_cache_wrapper))
        ours = ("tyrefrf", "tests", "rings", "blocks")
        _caches[len(sys.modules)] = [x for x in found if (x.__module__ or "").startswith(ours)]
    return _caches[len(sys.modules)]
