"""`tyrefrf modes`: from a case file to its natural modes, their table and plots."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import typer

from tyrefrf.cli.report import as_json, number_text
from tyrefrf.cli.running import in_file, read_case
from tyrefrf.cli.target import new_target
from tyrefrf.errors import CommandError
from tyrefrf.results import Modes

SHOWN = 30
"""Modes in the printed table; the file has them all."""


def modes_to_files(
    case_file: Path | None,
    output: Path | None,
    count: int | None,
    below: float | None,
    at: float | None,
    formats: Sequence[str],
    *,
    vtk: int = 0,
    at_rest: bool,
    force: bool,
    json: bool,
) -> int:
    """Compute natural modes, write results and plots, print the table; the exit status, 0.

    vtk: of how many of the lowest modes the shapes are written as VTK files and drawn.
    Raises CommandError where both `count` and `below` are given, or shapes of mere matrices.
    """
    from tyrefrf.cli.fields import check_fields, shapes_to_files
    from tyrefrf.plots import draw_plots
    from tyrefrf.results import write_modes
    from tyrefrf.study.model import build_mesh
    from tyrefrf.study.modes import modes_of_case

    if count is not None and below is not None:
        raise CommandError("give either --count or --below, not both")
    start = time.perf_counter()
    case, text = read_case(case_file, None)
    if vtk and case.matrices is not None:
        raise CommandError("--vtk draws elements; a case with [matrices] has none")
    formats = formats or case.output.plots
    with new_target(output, f"{case.name}_modes", force=force) as target:
        if vtk:
            check_fields(target.parent, ["mode"], force=force)
        with in_file(case_file, text):
            found = modes_of_case(
                case, count=count, below=below, at=at, at_rest=at_rest, case_text=text
            )
        write_modes(target, found)
        drawn = draw_plots(found, target.parent / "plots", formats)
        if vtk:
            drawn += shapes_to_files(found, vtk, target.parent, formats, build_mesh(case))
    facts = modes_summary(found, [target, *drawn]) | {"seconds": time.perf_counter() - start}
    typer.echo(as_json(facts) if json else describe_modes(facts))
    return 0


def modes_summary(modes: Modes, files: Sequence[Path]) -> dict[str, Any]:
    """The facts that a script wants to know; modes by their place in ascending frequency."""
    origin = modes.provenance
    return {
        "case": origin.case_name,
        "title": origin.title,
        "cells": origin.n_cells,
        **origin.numbers,
        "pressure": 0.0 if modes.inflation is None else modes.inflation.pressure,
        "moduli_at": modes.moduli_at,
        "modes": modes.n_modes,
        "cutoff": modes.cutoff,
        "counted": modes.counted.tolist(),
        "largest_residual": float(modes.residual.max(initial=0.0)),
        "frequency": modes.frequency.tolist(),
        "order": modes.order.tolist(),
        "members": modes.members.tolist(),
        "diameters": modes.diameters.tolist(),
        "loss_factor": modes.loss_factor.tolist(),
        "kind": list(modes.kind),
        "files": [str(path) for path in files],
    }


def describe_modes(facts: dict[str, Any]) -> str:
    """The table of the lowest modes, and how it is known that none is missing."""
    N, own = facts["cells"], facts["moduli_at"] != facts["moduli_at"]
    moduli = "of each mode's own frequency" if own else f"of {facts['moduli_at']:g} Hz"
    pressure = facts["pressure"]
    numbers = range(min(SHOWN, len(facts["frequency"])))
    more = len(facts["frequency"]) - len(numbers)
    lines = [
        f"{facts['title']}",
        f"  tyre      {N} cells, {facts['ring_nodes']} nodes, {facts['ring_dofs']} dofs, "
        + (f"at {pressure / 1e5:.4g} bar" if pressure else "at rest"),
        f"  moduli    {moduli}",
        f"  modes     {facts['modes']} below {facts['cutoff']:.6g} Hz, both members of pairs "
        "counted; the inertia of every order counts as many",
        f"  order     h of {N} cells: n = h, {N} - h, {N} + h, ... nodal diameters, folded; a "
        f"motion with n > {N / 2:g} appears as h",
        "",
        "    no.    f [Hz]    h  members  loss factor  motion",
        *(_row(facts, i) for i in numbers),
        *([f"    ... and {more} more in the file"] if more else []),
        "",
        f"  time      {facts['seconds']:.1f} s",
        f"  residual  {number_text(facts['largest_residual'])} at most, "
        "||K phi - omega^2 M phi|| / ||(omega^2 + shift) M phi||",
        *(f"  wrote     {path}" for path in facts["files"]),
    ]
    return "\n".join(lines)


def _row(facts: dict[str, Any], i: int) -> str:
    """One line of the table."""
    h, n = facts["order"][i], facts["diameters"][i]
    alias = f" (n = {n})" if n != h else ""
    return (
        f"  {i + 1:5d}  {facts['frequency'][i]:8.2f}  {h:3d}  {facts['members'][i]:7d}  "
        f"{facts['loss_factor'][i]:11.4g}  {facts['kind'][i]}{alias}"
    )


def describe_modes_file(modes: Modes) -> str:
    """What a file of modes holds."""
    origin = modes.provenance
    facts = modes_summary(modes, [])
    made = f"  made      {origin.created} by tyrefrf {origin.version}, case {origin.case_hash[:12]}"
    title, *rest = describe_modes(facts).splitlines()
    return "\n".join([title, made, *rest])
