"""Results in words, and as JSON for scripts."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tyrefrf.case import Case
from tyrefrf.results import Results, StaticState
from tyrefrf.study.estimate import Estimate


def as_json(data: object) -> str:
    """One JSON object; what is not finite becomes null."""
    return json.dumps(_finite(data), indent=2)


def summary(results: Results, files: Sequence[Path]) -> dict[str, Any]:
    """The facts of a run that a script wants to know."""
    origin = results.provenance
    solved = results.solved
    return {
        "case": origin.case_name,
        "title": origin.title,
        "solver": origin.solver,
        "cells": origin.n_cells,
        **origin.numbers,
        "lines": len(results.frequency),
        "first_frequency": float(results.frequency[0]),
        "last_frequency": float(results.frequency[-1]),
        "loads": [place.label for place in results.loads],
        "probes": [place.label for place in results.probes],
        "blocked_force": list(results.hub),
        "inflation": _inflation(results.inflation),
        "largest_residual": float(np.max(results.residual[solved])) if solved.any() else None,
        "seconds_per_line": float(np.median(results.solve_time)),
        "failed": [
            remark for remark, failed in zip(results.remark, results.failed, strict=True) if failed
        ],
        "remarks": [
            f"{frequency:.6g} Hz: {remark}"
            for frequency, remark, failed in zip(
                results.frequency, results.remark, results.failed, strict=True
            )
            if remark and not failed
        ],
        "files": [str(path) for path in files],
    }


def _inflation(state: StaticState | None) -> dict[str, Any] | None:
    """How the tyre was inflated, and whether that converged; None without pressure."""
    if state is None:
        return None
    grown = 1e3 * float(np.linalg.norm(state.displacement, axis=1).max())
    steps, iterations = len(state.share), int(state.iterations.sum())
    return {
        "pressure": state.pressure,
        "largest_displacement": grown / 1e3,
        "steps": steps,
        "iterations": iterations,
        "residual": float(state.lack[-1]),
        "resultant": state.resultant.tolist(),
        "words": f"{state.pressure / 1e5:.4g} bar moves the section by up to {grown:.3g} mm and "
        f"pushes a cell outwards by {state.resultant[0]:.4g} N "
        f"({steps} step(s), {iterations} iteration(s), residual {state.lack[-1]:.0e})",
    }


def describe_run(facts: dict[str, Any]) -> str:
    """The summary at the end of a run."""
    n_failed = len(facts["failed"])
    lines = [
        f"{facts['title']}",
        f"  tyre      {facts['cells']} cells, {facts['ring_nodes']} nodes, "
        f"{facts['ring_dofs']} dofs",
        *([f"  pressure  {facts['inflation']['words']}"] if facts["inflation"] else []),
        f"  lines     {facts['lines']}, {facts['first_frequency']:g} to "
        f"{facts['last_frequency']:g} Hz" + (f", {n_failed} FAILED" if n_failed else ""),
        f"  time      {facts['seconds']:.1f} s in all, "
        f"{1e3 * facts['seconds_per_line']:.3g} ms per line ({facts['solver']})",
        f"  residual  {number_text(facts['largest_residual'])} at most, ||F - D q|| / ||F||",
        *(f"  remark    {remark}" for remark in facts["remarks"]),
        *(f"  wrote     {path}" for path in facts["files"]),
    ]
    return "\n".join(lines)


def describe(results: Results) -> str:
    """What a results file holds."""
    origin = results.provenance
    facts = summary(results, [])
    lines = [
        f"{origin.title}",
        f"  case      {origin.case_name}, {origin.case_hash[:12]}, solver {origin.solver}",
        f"  made      {origin.created} by tyrefrf {origin.version}",
        f"  tyre      {origin.n_cells} cells of {np.rad2deg(origin.sector_angle):.6g} degrees",
        f"  lines     {facts['lines']}, {facts['first_frequency']:g} to "
        f"{facts['last_frequency']:g} Hz, {results.n_failed} failed",
        f"  residual  {number_text(facts['largest_residual'])} at most",
        *([f"  pressure  {facts['inflation']['words']}"] if facts["inflation"] else []),
        *(f"  load      {label}" for label in facts["loads"]),
        *(f"  probe     {label}" for label in facts["probes"]),
        *([f"  hub       {', '.join(results.hub)}"] if results.hub else []),
        *(f"  failed    {reason}" for reason in facts["failed"]),
    ]
    return "\n".join(lines)


def describe_estimate(case: Case, found: Estimate, jobs: int) -> str:
    """What a case would compute."""
    lines = [
        f"{case.title or case.name}: {case.name}",
        f"  section   {found.section_nodes} nodes, {found.section_elements} {case.cell.element} "
        f"elements, {found.free_section_dofs} dofs that move",
        f"  cell      {found.cell_nodes} nodes, {found.cell_dofs} dofs, "
        f"{case.cell.sector_angle:g} degrees",
        f"  ring      {found.n_cells} cells, {found.ring_nodes} nodes, {found.ring_dofs} dofs",
        f"  mass      {found.mass:.2f} kg"
        + (f": {_shares(found.masses)}" if len(found.masses) > 1 else ""),
        f"  lines     {found.n_lines}, up to {found.top_frequency:g} Hz",
        f"  columns   {found.n_loads} loads, {found.n_probes} probes (driving points included)",
        *(
            f"  waves     {r.material} at {found.top_frequency:g} Hz: "
            f"shear {1e3 * r.shear:.3g} mm, bending {1e3 * r.bending:.3g} mm "
            f"(of a {1e3 * r.thickness:.3g} mm wall), "
            f"elements up to {1e3 * r.size:.3g} mm: "
            f"{r.per_wavelength:.1f} per wavelength ({r.enough:g} recommended)"
            for r in found.resolution
        ),
        f"  cost      about {found.seconds:.0f} s and {found.memory / 1e6:.0f} MB "
        f"with --jobs {jobs} ({case.solver.name})",
        *(f"  warning   {warning}" for warning in found.warnings),
    ]
    return "\n".join(lines)


def _shares(masses: dict[str, float]) -> str:
    """Masses by material: `rubber 4.79, steel 0.75`."""
    return ", ".join(f"{name} {mass:.2f}" for name, mass in masses.items())


def number_text(value: float | None) -> str:
    """A number in few digits, or a dash where there is none."""
    return "-" if value is None else f"{value:.1e}"


def _finite(data: object) -> object:
    """The same data with None for NaN and infinities, which JSON does not know."""
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    if isinstance(data, float) and not np.isfinite(data):
        return None
    return data
