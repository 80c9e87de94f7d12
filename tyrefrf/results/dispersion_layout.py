"""What a file of free waves holds, and how it is written and read back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from tyrefrf.results.dispersion import DIRECTIONS, Dispersion
from tyrefrf.results.field import Field, Kind
from tyrefrf.results.file import columns_of, provenance_of, write_file
from tyrefrf.results.tyre_layout import inflation_of, section_of, tyre_fields

Value = Callable[[Dispersion], ArrayLike]


def _axis(name: str, kind: Kind, units: str, long_name: str, value: Value) -> Field:
    return Field(name, (name,), kind, units, long_name, value)


def _lines(name: str, kind: Kind, units: str, long_name: str, value: Value) -> Field:
    """What each line has one of."""
    return Field(name, ("frequency",), kind, units, long_name, value)


def _waves(name: str, units: str, long_name: str, value: Value) -> Field:
    """What each wave has one of."""
    return Field(name, ("branch", "frequency"), "float", units, long_name, value)


DISPERSION = (
    _axis("frequency", "float", "Hz", "frequency", lambda d: d.frequency),
    _axis("branch", "int", "1", "number of the branch", lambda d: np.arange(1, len(d.order) + 1)),
    _axis("direction", "text", "", "direction of motion", lambda _: DIRECTIONS),
    _axis("bounds", "text", "", "what the waves are kept by", lambda _: ["decay"]),
    _waves("order", "1", "circumferential order: q ~ exp(-(decay + i order) t)", lambda d: d.order),
    _waves("decay", "Np/rad", "decay around the tyre; 1 Np is 8.686 dB", lambda d: d.decay),
    _waves("wavenumber", "rad/m", "order per outer radius", lambda d: d.wavenumber),
    _waves("velocity", "rad/s", "velocity of the energy around the tyre", lambda d: d.velocity),
    _waves("residual", "1", "||A q|| / (||A|| ||q||) of the cell", lambda d: d.residual),
    Field(
        "share",
        ("branch", "direction", "frequency"),
        "float",
        "1",
        "share of the section's kinetic energy",
        lambda d: d.share,
    ),
    _lines("found", "int", "1", "waves found; -1: the line failed", lambda d: d.found),
    _lines("counted", "int", "1", "waves by the argument principle", lambda d: d.counted),
    _lines("solve_time", "float", "s", "time spent on the line", lambda d: d.solve_time),
    _lines("remark", "text", "", "why the line failed", lambda d: d.remark),
    Field("bound", ("bounds",), "float", "Np/rad", "largest decay kept", lambda d: [d.bound]),
)


def write_dispersion(path: str | Path, dispersion: Dispersion) -> None:
    """Write free waves as `write_results` does a run."""
    table = DISPERSION + tyre_fields(with_inflation=dispersion.inflation is not None)
    datasets = [(field, field.of(dispersion)) for field in table]
    write_file(path, "dispersion", dispersion.provenance, datasets)


def read_dispersion(file: Any) -> Dispersion:
    """The free waves that an open file holds."""
    columns = columns_of(file, DISPERSION + tyre_fields(with_inflation="inflation" in file))
    return Dispersion(
        frequency=columns["frequency"],
        order=columns["order"],
        decay=columns["decay"],
        velocity=columns["velocity"],
        share=columns["share"],
        residual=columns["residual"],
        found=columns["found"],
        counted=columns["counted"],
        solve_time=columns["solve_time"],
        remark=tuple(columns["remark"]),
        bound=float(columns["bound"][0]),
        section=section_of(columns),
        provenance=provenance_of(file),
        inflation=inflation_of(columns),
    )
