"""The datasets of results files in Markdown, from the tables that write and read them."""

from __future__ import annotations

from itertools import groupby

from markup import Lines, plain, table

from tyrefrf.results.comparison_layout import comparison_fields
from tyrefrf.results.dispersion_layout import DISPERSION
from tyrefrf.results.field import Field
from tyrefrf.results.file import attributes_of
from tyrefrf.results.modes_layout import MODES
from tyrefrf.results.results import Provenance
from tyrefrf.results.run_layout import run_fields
from tyrefrf.results.tyre_layout import tyre_fields

LAYOUTS: dict[str, tuple[Field, ...]] = {
    "run": run_fields(
        with_hub=True, with_inflation=True, with_certificate=True, with_sensors=True, n_measured=1
    ),
    "comparison": comparison_fields(with_inflation=False),
    "modes": MODES,
    "dispersion": DISPERSION,
}
"""Datasets by content; those of the tyre, which all of them share, stand with the run's."""

TYRE = {field.name for field in tyre_fields(with_inflation=True)}

KINDS = {
    "text": "text",
    "complex": "complex (r, i)",
    "float": "float64",
    "int": "int64",
    "bool": "bool",
}


HEAD = ("dataset", "axes", "type", "units", "what")


def datasets(content: str) -> Lines:
    """A table for the root of a file of that content, and one for each group."""
    shown = [field for field in LAYOUTS[content] if content == "run" or field.name not in TYRE]
    lines: Lines = []
    for group, fields in groupby(shown, key=lambda field: field.group):
        lines += [f"Group `{group}`:", ""] if group else []
        lines += [*table(HEAD, [row(field) for field in fields]), ""]
    return lines


def row(field: Field) -> tuple[str, ...]:
    """A dataset as a row."""
    axes = "axis" if field.is_scale else ", ".join(_near(axis, field) for axis in field.axes)
    return _near(field.name, field), axes, KINDS[field.kind], field.units, plain(field.long_name)


def _near(name: str, field: Field) -> str:
    """The name of a dataset within the group of another."""
    return f"`{name.removeprefix(f'{field.group}/')}`"


def root_attributes() -> Lines:
    """The names of the attributes of a file's root."""
    origin = Provenance(**dict.fromkeys(Provenance.__annotations__, ""))  # type: ignore[arg-type]
    return [", ".join(f"`{name}`" for name in attributes_of("run", origin))]
