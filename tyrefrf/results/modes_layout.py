"""The file of natural modes: one table that writing and reading share.

No axis has the name of one in the groups, which inherit these.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from tyrefrf.results.field import Field, Kind
from tyrefrf.results.file import columns_of, provenance_of, write_file
from tyrefrf.results.modes import DIRECTIONS, Modes
from tyrefrf.results.tyre_layout import inflation_of, section_of, tyre_fields


def _per_mode(
    name: str, kind: Kind, units: str, long_name: str, value: Callable[[Modes], ArrayLike]
) -> Field:
    """What each mode has one of."""
    return Field(name, ("mode",), kind, units, long_name, value)


def _axis(
    name: str, kind: Kind, units: str, long_name: str, value: Callable[[Modes], ArrayLike]
) -> Field:
    return Field(name, (name,), kind, units, long_name, value)


MODES = (
    _axis("mode", "int", "1", "number of the mode", lambda m: np.arange(1, len(m.order) + 1)),
    _axis("direction", "text", "", "direction of motion", lambda _: DIRECTIONS),
    _axis("cell_node", "int", "1", "node of the cell", lambda m: np.arange(len(m.points))),
    _axis("made_of", "text", "", "material", lambda m: m.section.materials),
    _axis("all_orders", "int", "1", "circumferential order", lambda m: np.arange(len(m.counted))),
    _axis("set", "int", "1", "the one set of modes", lambda _: [0]),
    _per_mode("frequency", "float", "Hz", "natural frequency", lambda m: m.frequency),
    _per_mode("order", "int", "1", "circumferential order, n modulo N, folded", lambda m: m.order),
    _per_mode("members", "int", "1", "2: h and N - h are a pair", lambda m: m.members),
    _per_mode("aliases", "text", "", "nodal diameters it may stand for", lambda m: m.aliases),
    _per_mode("diameters", "int", "1", "nodal diameters, as far as told", lambda m: m.diameters),
    _per_mode("loss_factor", "float", "1", "loss by the strain energy", lambda m: m.loss_factor),
    _per_mode("kind", "text", "", "where most kinetic energy is", lambda m: m.kind),
    _per_mode("residual", "float", "1", "||K phi - w^2 M phi||, relative", lambda m: m.residual),
    Field(
        "motion", ("mode", "direction"), "float", "1", "share of kinetic energy", lambda m: m.motion
    ),
    Field(
        "energy_share",
        ("mode", "made_of"),
        "float",
        "1",
        "share of the strain energy; the rest is the inflation's",
        lambda m: m.energy_share,
    ),
    Field(
        "loss_share",
        ("mode", "made_of"),
        "float",
        "1",
        "share of the loss; the rest is viscous",
        lambda m: m.loss_share,
    ),
    Field(
        "shape",
        ("mode", "direction", "cell_node"),
        "complex",
        "kg-1/2",
        "displacement for unit modal mass of a cell; cell j: times exp(2 pi i order j / N)",
        lambda m: m.shape.transpose(0, 2, 1),
    ),
    Field("points", ("cell_node", "direction"), "float", "m, m, rad", "place", lambda m: m.points),
    Field(
        "counted",
        ("all_orders",),
        "int",
        "1",
        "modes below the cut-off by inertia, one member of each pair",
        lambda m: m.counted,
    ),
    Field("cutoff", ("set",), "float", "Hz", "no mode below it is missing", lambda m: [m.cutoff]),
    Field(
        "moduli_at",
        ("set",),
        "float",
        "Hz",
        "frequency of the moduli; NaN: each mode's own",
        lambda m: [m.moduli_at],
    ),
)


def write_modes(path: str | Path, modes: Modes) -> None:
    """Write modes as `write_results` does a run."""
    table = MODES + tyre_fields(with_inflation=modes.inflation is not None)
    write_file(path, "modes", modes.provenance, [(field, field.of(modes)) for field in table])


def read_modes(file: Any) -> Modes:
    """The modes that an open file holds."""
    columns = columns_of(file, MODES + tyre_fields(with_inflation="inflation" in file))
    return Modes(
        frequency=columns["frequency"],
        order=columns["order"],
        members=columns["members"],
        loss_factor=columns["loss_factor"],
        diameters=columns["diameters"],
        motion=columns["motion"],
        energy_share=columns["energy_share"],
        loss_share=columns["loss_share"],
        shape=np.ascontiguousarray(columns["shape"].transpose(0, 2, 1)),
        residual=columns["residual"],
        points=columns["points"],
        cutoff=float(columns["cutoff"][0]),
        counted=columns["counted"],
        moduli_at=float(columns["moduli_at"][0]),
        section=section_of(columns),
        provenance=provenance_of(file),
        inflation=inflation_of(columns),
    )
