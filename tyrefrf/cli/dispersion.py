"""`tyrefrf dispersion`: from a case file to the free waves of its cell, a summary and plots."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import typer

from tyrefrf.cli.report import as_json, number_text
from tyrefrf.cli.running import in_file, read_case, status_of, workers_of
from tyrefrf.cli.target import new_target
from tyrefrf.results import Dispersion
from tyrefrf.results.dispersion import NEPER

SHOWN = 6
"""Lines in the printed table of waves; the file has them all."""
SHORTEST = 8.0
"""Mean length of branches, in lines, below which they are likely to be broken: 3 where 12 lines
stand for 2 kHz of the layered tyre, 31 where 60 do for that of the homogeneous one."""
CUT_ONS = 12
"""Cut-on frequencies in the printed summary."""


def dispersion_to_files(
    case_file: Path | None,
    output: Path | None,
    lines: int,
    decay: float,
    jobs: int | None,
    scheduler: str | None,
    formats: Sequence[str],
    *,
    at_rest: bool,
    force: bool,
    json: bool,
) -> int:
    """Compute free waves, write results and plots, print the summary; the exit status, 0 or 1."""
    from tyrefrf.cli.progress import progress_of
    from tyrefrf.plots import draw_plots
    from tyrefrf.results import write_dispersion
    from tyrefrf.study.dispersion import dispersion_of

    start = time.perf_counter()
    case, text = read_case(case_file, None)
    with new_target(output, f"{case.name}_dispersion", force=force) as target:
        with (
            workers_of(jobs, scheduler, lines) as workers,
            progress_of(lines, case.name) as progress,
            in_file(case_file, text),
        ):
            found = dispersion_of(
                case,
                lines=lines,
                decay=decay,
                at_rest=at_rest,
                jobs=workers,
                case_text=text,
                progress=progress,
            )
        write_dispersion(target, found)
        drawn = draw_plots(found, target.parent / "plots", formats or case.output.plots)
    facts = dispersion_summary(found, [target, *drawn]) | {"seconds": time.perf_counter() - start}
    typer.echo(as_json(facts) if json else describe_dispersion(facts))
    return status_of(facts)


def dispersion_summary(dispersion: Dispersion, files: Sequence[Path]) -> dict[str, Any]:
    """The facts that a script wants to know."""
    origin, failed = dispersion.provenance, dispersion.failed
    cut_on = np.sort(dispersion.cut_on[~np.isnan(dispersion.cut_on)])
    return {
        "case": origin.case_name,
        "title": origin.title,
        "cells": origin.n_cells,
        **origin.numbers,
        "pressure": 0.0 if dispersion.inflation is None else dispersion.inflation.pressure,
        "decay_bound": dispersion.bound * NEPER,
        "lines": len(dispersion.frequency),
        "frequency": dispersion.frequency.tolist(),
        "waves": dispersion.waves.tolist(),
        "propagating": np.count_nonzero(dispersion.propagating, axis=0).tolist(),
        "branches": len(dispersion.order),
        "cut_on": cut_on.tolist(),
        "found": dispersion.found.tolist(),
        "counted": dispersion.counted.tolist(),
        "largest_residual": float(np.nanmax(dispersion.residual, initial=0.0)),
        "seconds_per_line": float(np.median(dispersion.solve_time)),
        "failed": [r for r, bad in zip(dispersion.remark, failed, strict=True) if bad],
        "files": [str(path) for path in files],
    }


def describe_dispersion(facts: dict[str, Any]) -> str:
    """How many waves there are, from where on they propagate, and that none is missing."""
    n, pressure, failed = facts["lines"], facts["pressure"], len(facts["failed"])
    cut_on = [f"{f:.4g}" for f in facts["cut_on"][:CUT_ONS]]
    more = len(facts["cut_on"]) - len(cut_on)
    return "\n".join(
        [
            f"{facts['title']}",
            f"  tyre      {facts['cells']} cells, {facts['section_nodes']} nodes in a section, "
            + (f"at {pressure / 1e5:.4g} bar" if pressure else "at rest"),
            f"  waves     all that decay by up to {facts['decay_bound']:.4g} dB/rad, on "
            f"{n - failed} of {n} lines; {facts['branches']} branches",
            f"  count     by the argument principle the same on {n - failed} of {n} lines",
            "",
            "      f [Hz]  waves  propagating (decay in Np/rad < order)",
            *(_row(facts, line) for line in _shown(n)),
            "",
            *_broken(facts),
            f"  cut-on    {', '.join(cut_on) or 'none'}" + (f", {more} more" * bool(more)) + " Hz",
            f"  residual  {number_text(facts['largest_residual'])} at most, "
            "||A q|| / (||A|| ||q||)",
            f"  time      {facts['seconds']:.1f} s, {facts['seconds_per_line']:.2g} s a line",
            *(f"  wrote     {path}" for path in facts["files"]),
        ]
    )


def _broken(facts: dict[str, Any]) -> list[str]:
    """A warning where branches are so short that they cannot have been followed."""
    length = sum(facts["waves"]) / max(facts["branches"], 1)
    if length >= SHORTEST or not facts["branches"]:
        return []
    return [
        f"  warning   branches are {length:.1f} lines long on average: too few lines to follow "
        "them; take more --lines"
    ]


def _shown(n_lines: int) -> list[int]:
    """A few lines, evenly spread, the last one included."""
    return sorted({round(x) for x in np.linspace(0, n_lines - 1, SHOWN + 1)[1:]})


def _row(facts: dict[str, Any], line: int) -> str:
    """One line of the table."""
    frequency, waves, runs = (facts[name][line] for name in ("frequency", "waves", "propagating"))
    return f"  {frequency:10.5g}  {waves:5d}  {runs:5d}"


def describe_dispersion_file(dispersion: Dispersion) -> str:
    """What a file of free waves holds."""
    origin = dispersion.provenance
    made = f"  made      {origin.created} by tyrefrf {origin.version}, case {origin.case_hash[:12]}"
    title, *rest = describe_dispersion(dispersion_summary(dispersion, [])).splitlines()
    return "\n".join([title, made, *rest])
