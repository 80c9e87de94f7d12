"""The file of a comparison: a run's datasets with the solvers leading, and what these took."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from tyrefrf.results.comparison import Comparison
from tyrefrf.results.field import Field, Kind
from tyrefrf.results.file import columns_of, provenance_of, write_file
from tyrefrf.results.run_layout import RESPONSES, results_of
from tyrefrf.results.tyre_layout import tyre_fields


def _is_a_solver_s(field: Field) -> bool:
    """Whether every solver has its own of a run's dataset: of what depends on the line."""
    return "frequency" in field.axes and not field.is_scale


def _of_run(field: Field) -> Field:
    """A run's dataset, with the solvers leading where they differ."""
    if _is_a_solver_s(field):
        return replace(
            field,
            axes=("solver", *field.axes),
            value=lambda comparison: np.stack([field.of(run) for run in comparison.runs]),
        )
    return replace(field, value=lambda comparison: field.value(comparison.runs[0]))


def _cost(name: str, units: str, long_name: str, value: Callable[[Comparison], ArrayLike]) -> Field:
    """What every solver has one of."""
    return Field(name, ("solver",), "float", units, long_name, value)


def _axis(
    name: str, kind: Kind, units: str, long_name: str, value: Callable[[Comparison], ArrayLike]
) -> Field:
    return Field(name, (name,), kind, units, long_name, value)


COMPARED = (
    _axis("solver", "text", "", "solver, in a process of its own", lambda c: c.solvers),
    _axis("against", "text", "", "solver that another is compared with", lambda c: c.solvers),
    _axis("sample", "float", "Hz", "line of whole sections", lambda c: c.frequency[c.samples]),
    _axis("fact", "text", "", "what `machine` says", lambda c: list(c.machine)),
    *map(_of_run, RESPONSES),
    _cost("prepare_time", "s", "CPU time before the first line", lambda c: c.prepare_seconds),
    _cost("peak_memory", "bytes", "peak resident memory of the process", lambda c: c.peak_memory),
    _cost("base_memory", "bytes", "the same, until the tyre is assembled", lambda c: c.base_memory),
    _cost("disk", "bytes", "size of the results file", lambda c: c.disk),
    Field(
        "difference",
        ("solver", "frequency"),
        "float",
        "1",
        "largest difference of a response to the reference's (direct, if that has answers, else "
        "the first), relative to the norm over the probes",
        lambda c: c.difference,
    ),
    Field(
        "section_error",
        ("solver", "against", "sample"),
        "float",
        "1",
        "largest ||q - q_against|| / ||q_against|| over a section's displacement",
        lambda c: c.section_error,
    ),
    Field("failure", ("solver",), "text", "", "why it has no answers", lambda c: c.failure),
    Field("machine", ("fact",), "text", "", "computed on", lambda c: list(c.machine.values())),
)


def comparison_fields(*, with_inflation: bool) -> tuple[Field, ...]:
    """Every dataset of a file."""
    return COMPARED + tyre_fields(with_inflation=with_inflation)


def write_comparison(path: str | Path, comparison: Comparison) -> None:
    """Write a comparison as `write_results` does a run."""
    table = comparison_fields(with_inflation=comparison.inflation is not None)
    datasets = [(field, field.of(comparison)) for field in table]
    write_file(path, "comparison", comparison.provenance, datasets)


def read_comparison(file: Any) -> Comparison:
    """The comparison that an open file holds."""
    columns = columns_of(file, comparison_fields(with_inflation="inflation" in file))
    first = {field.name: columns[field.name][0] for field in RESPONSES if _is_a_solver_s(field)}
    run = results_of({**columns, **first}, provenance_of(file))
    frequency = columns["frequency"]
    return Comparison(
        frequency=frequency,
        solvers=tuple(columns["solver"]),
        loads=run.loads,
        probes=run.probes,
        receptance=columns["receptance"],
        seconds=columns["solve_time"],
        prepare_seconds=columns["prepare_time"],
        peak_memory=columns["peak_memory"],
        base_memory=columns["base_memory"],
        disk=columns["disk"],
        residual=columns["residual"],
        difference=columns["difference"],
        samples=frequency.searchsorted(columns["sample"]),
        section_error=columns["section_error"],
        remark=tuple(map(tuple, columns["remark"])),
        failure=tuple(columns["failure"]),
        machine=dict(zip(columns["fact"], columns["machine"], strict=True)),
        section=run.section,
        provenance=run.provenance,
        inflation=run.inflation,
    )
