"""Results as texts that can be kept beside a file and compared with what is read from it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass

import numpy as np


def told(what: object, name: str = "") -> dict[str, str]:
    """Everything in results by its name, numbers with all their digits.

    Of an array: shape, type, and the first, middle and last value. Of several results, such as the
    points of a sweep or the places of loads: the first and the last.
    """
    return dict(_told(what, name))


def _told(what: object, name: str) -> Iterator[tuple[str, str]]:
    if isinstance(what, np.ndarray):
        few = what.ravel()[[0, what.size // 2, -1]] if what.size else what
        yield name, f"{what.shape} {what.dtype.kind}: {few.tolist()}"
    elif is_dataclass(what):
        for field in fields(what):
            yield from _told(getattr(what, field.name), f"{name}.{field.name}".lstrip("."))
    elif isinstance(what, Mapping):
        for key, value in what.items():
            yield from _told(value, f"{name}[{key}]")
    elif isinstance(what, tuple) and what and is_dataclass(what[0]):
        for index in sorted({0, len(what) - 1}):
            yield from _told(what[index], f"{name}[{index}]")
    else:
        yield name, repr(what.item() if isinstance(what, np.generic) else what)
