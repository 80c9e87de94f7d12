"""Measured responses in the file of a run: a group for each curve, `measured/0` and so on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numpy.typing import ArrayLike

from tyrefrf.results.field import Columns, Field, Kind
from tyrefrf.results.measured import Measured

GROUP = "measured"
_ATTRIBUTES = ("name", "load", "probe", "quantity")


def measured_fields(n_curves: int) -> tuple[Field, ...]:
    """The datasets of so many curves."""
    return tuple(field for k in range(n_curves) for field in _fields(k))


def _fields(k: int) -> tuple[Field, ...]:
    """The datasets of the k-th curve."""

    def field(
        name: str, axis: str, kind: Kind, units: str, words: str, value: Callable[[Measured], Any]
    ) -> Field:
        def of(results: Any) -> ArrayLike:
            found: ArrayLike = value(results.measured[k])
            return found

        return Field(_path(k, name), (_path(k, axis),), kind, units, words, of)

    return (
        field("curve", "curve", "int", "1", "the one curve", lambda _: [k]),
        field("name", "curve", "text", "", "name of the curve", lambda m: [m.name]),
        field("load", "curve", "text", "", "name of the load", lambda m: [m.load]),
        field("probe", "curve", "text", "", "name of the probe", lambda m: [m.probe]),
        field("quantity", "curve", "text", "", "what of H was measured", lambda m: [m.quantity]),
        field("line", "line", "float", "Hz", "measured line", lambda m: m.frequency),
        field(
            "response",
            "line",
            "complex",
            "m/N (receptance), m/(s N) (mobility), m/(s^2 N) (accelerance)",
            "measured response, in its quantity",
            lambda m: m.response,
        ),
    )


def _path(k: int, name: str) -> str:
    return f"{GROUP}/{k}/{name}"


def n_measured(file: Any) -> int:
    """How many curves an open file holds."""
    return len(file[GROUP]) if GROUP in file else 0


def measured_of(columns: Columns) -> tuple[Measured, ...]:
    """The curves, read back."""
    n_curves = sum(name.startswith(f"{GROUP}/") and name.endswith("/curve") for name in columns)
    return tuple(
        Measured(
            **{name: columns[_path(k, name)][0] for name in _ATTRIBUTES},
            frequency=columns[_path(k, "line")],
            response=columns[_path(k, "response")],
        )
        for k in range(n_curves)
    )
