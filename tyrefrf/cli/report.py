"""Results in words, and as JSON for scripts."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from tyrefrf.arrays import FloatArray
from tyrefrf.case import Case
from tyrefrf.mesh.place import Place
from tyrefrf.results import Results, StaticState, agreements
from tyrefrf.results.derived import regions_of, single_probes
from tyrefrf.results.measured import LEAST
from tyrefrf.results.proof import MEASURES, TRUNCATED, Worst, breaches
from tyrefrf.results.results import MISSING
from tyrefrf.study.estimate import Estimate

MOST_NAMED = 10  # breaches, or pairs of load and probe, on the screen; JSON has all


def as_json(data: object) -> str:
    """One JSON object; what is not finite becomes null."""
    return json.dumps(_finite(data), indent=2)


def summary(results: Results, files: Sequence[Path]) -> dict[str, Any]:
    """The facts of a run that a script wants to know."""
    from tyrefrf.study.inflate import strained

    origin = results.provenance
    solved = results.solved
    return {
        "case": origin.case_name,
        "title": origin.title,
        "solver": origin.solver,
        "cells": origin.n_cells,
        **origin.numbers,
        "lines": len(results.frequency),
        "missing_lines": results.n_missing,
        "first_frequency": float(results.frequency[0]),
        "last_frequency": float(results.frequency[-1]),
        "loads": [place.label for place in results.loads],
        "probes": probe_labels(results.probes),
        "blocked_force": list(results.hub),
        "inflation": _inflation(results.inflation),
        "largest_residual": float(np.max(results.residual[solved])) if solved.any() else None,
        "proof": {name: _worst(measure.worst_of(results)) for name, measure in MEASURES.items()},
        "breaches": list(breaches(results)),
        "certificate": _certificate(results),
        "measured": [asdict(one) for one in agreements(results)],
        "adaptive": adaptive_words(origin.numbers, len(results.frequency)),
        "seconds_per_line": median(results.solve_time),
        "failed": [
            remark for remark, failed in zip(results.remark, results.failed, strict=True) if failed
        ],
        "remarks": [
            *strained(origin.numbers.get("inflation_strain", np.nan)),
            *(
                f"{frequency:.6g} Hz: {remark}"
                for frequency, remark, failed in zip(
                    results.frequency, results.remark, results.failed, strict=True
                )
                if remark and not failed and remark != MISSING
            ),
        ],
        "files": [str(path) for path in files],
    }


def probe_labels(probes: Sequence[Place]) -> list[str]:
    """The places of the probes in words; one line for all points of a region."""
    regions = {
        f"{name}: {probes[points[0]].direction} at {len(points)} points of a region"
        for name, points in regions_of(probes).items()
    }
    return [*(probes[j].label for j in single_probes(probes)), *sorted(regions)]


def _worst(found: Worst | None) -> dict[str, Any] | None:
    return None if found is None else asdict(found)


def _certificate(results: Results) -> dict[str, Any] | None:
    """How far a second look differs; None where none was asked for."""
    certificate = results.certificate
    if certificate is None:
        return None
    change = np.abs(certificate.level_change)
    named = ((i, j) for i in range(len(results.loads)) for j in range(len(results.probes)))
    return {
        "solver": certificate.solver,
        "lines": len(certificate.frequency),
        "unanswered": int(np.isnan(certificate.residual).sum()),
        "difference": _largest(certificate.difference),
        "cell_difference": _largest(certificate.cell_difference),
        "refined_cells": certificate.n_cells,
        "refined_lines": len(certificate.refined_frequency),
        "level_change": [
            {
                "load": results.loads[i].name,
                "probe": results.probes[j].name,
                "median": median(change[i, j]),
                "largest": _largest(change[i, j]),
            }
            for i, j in named
        ],
        "median_level_change": median(change),
        "largest_level_change": _largest(change),
        "left_out": certificate.left_out,
    }


def _largest(values: FloatArray) -> float | None:
    """The largest that is a number."""
    values = values[~np.isnan(values)]
    return float(values.max()) if values.size else None


def median(values: FloatArray) -> float | None:
    """Of those that are numbers; None where there is none."""
    values = values[~np.isnan(values)]
    return float(np.median(values)) if values.size else None


def adaptive_words(numbers: dict[str, float | int], n_lines: int) -> str:
    """How many adaptive lines were solved and how wrong the others are, or why none is fitted.

    Empty where all lines were to be solved.
    """
    if "solved_lines" not in numbers:
        return ""
    n, error = numbers["solved_lines"], numbers["fit_error"]
    found = f"error on held-back lines {error:.0e} of the peak"
    if n < n_lines:
        return f"{n} solved, the others fitted: {found}"
    if numbers["narrow_lines"] == n_lines:
        return "all solved: too few to be fitted, or the modes could not be counted"
    if np.isnan(error):
        return f"all solved: {numbers['narrow_lines']} stand at resonances too narrow to be fitted"
    return f"all solved: the fit was not trusted ({found})"


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
        *([f"  adaptive  {facts['adaptive']}"] if facts["adaptive"] else []),
        *resumed_lines(facts),
        time_line(facts),
        *picked_lines(facts),
        *proof_lines(facts),
        *_certificate_lines(facts),
        *_deflection_lines(facts.get("deflections")),
        *_measured_lines(facts),
        *(f"  remark    {remark}" for remark in facts["remarks"]),
        *(f"  wrote     {path}" for path in facts["files"]),
    ]
    return "\n".join(lines)


def _deflection_lines(found: dict[str, Any] | None) -> list[str]:
    """How many deflections were made beside the lines, and what their equations say."""
    if found is None:
        return []
    n, n_failed = len(found["frequencies"]), len(found["failed"])
    if n + n_failed == 0:
        return []
    worst = f", residual {number_text(found['largest_residual'])} at most" if n else ""
    failed = f", {n_failed} FAILED" if n_failed else ""
    return [f"  fields    of all loads on {n} line(s){worst}{failed}"]


def picked_lines(facts: dict[str, Any]) -> list[str]:
    """Why a solver was picked, where the case left it open."""
    expected = {name: facts.get(f"expected_{name}") for name in ("recursive", "cyclic")}
    texts = [f"{1e3 * s:.3g} ms by {name}" for name, s in expected.items() if s is not None]
    if not texts:
        return []
    return [f"  solver    {facts['solver']}, picked: a line is expected to take {', '.join(texts)}"]


def proof_lines(facts: dict[str, Any]) -> list[str]:
    """The worst of every proof of a run or sweep, with its line, and what breaches."""
    n_breaches = len(facts["breaches"])
    lines = [
        f"  residual  {_worst_text(facts, 'residual', '{} at most, ||F - D q|| / ||F||')}",
        f"  passivity {_worst_text(facts, 'passivity', 'Re Y / |Y| {} at least')}",
    ]
    if len(facts["loads"]) > 1:
        lines += [
            f"            {_worst_text(facts, 'power', 'of all loads together {} at least')}",
            f"  symmetry  {_worst_text(facts, 'reciprocity', '|H_ij - H_ji| {} at most')}",
        ]
    if facts["solver"] in TRUNCATED:
        lines.append(f"  judged    by none of them: `{facts['solver']}` is truncated")
    if n_breaches:
        lines.append(f"  BREACHED  on {n_breaches} line(s)")
    return lines


def _worst_text(facts: dict[str, Any], measure: str, words: str) -> str:
    """A worst value in words, with its line, load and point of a sweep."""
    worst = facts["proof"][measure]
    if worst is None:
        return words.format("-")
    where = [worst.get("load"), worst.get("point"), f"{worst['frequency']:.6g} Hz"]
    return f"{words.format(number_text(worst['value']))} ({', '.join(filter(None, where))})"


def _certificate_lines(facts: dict[str, Any]) -> list[str]:
    """What the second look found."""
    found = facts["certificate"]
    if found is None:
        return []
    again = (
        f"  certified by `{found['solver']}` on {found['lines']} lines: responses differ by "
        f"{number_text(found['difference'])} at most, whole cells by "
        f"{number_text(found['cell_difference'])}"
        + (f"; {found['unanswered']} without an answer" if found["unanswered"] else "")
    )
    if not found["refined_cells"]:
        return [again, f"  refined   not: {found['left_out']}"]
    pairs = [
        f"{pair['load']} to {pair['probe']}: {_decibels(pair['median'])}, "
        f"{_decibels(pair['largest'])} at most"
        for pair in found["level_change"]
        if pair["median"] is not None
    ]
    finer = f"{found['refined_cells']} cells instead of {facts['cells']}"
    if found["refined_cells"] == facts["cells"]:
        finer = "twice the elements around in every cell"
    return [
        again,
        f"  refined   {finer}, on {found['refined_lines']} lines: levels change by "
        f"{_decibels(found['median_level_change'])} (median), "
        f"{_decibels(found['largest_level_change'])} at most",
        *(f"            {pair}" for pair in first_of(pairs)),
        "            (by finer cells around the axle alone: a change, no bound of the error)",
    ]


def _measured_lines(facts: dict[str, Any]) -> list[str]:
    """How far the measured responses agree, each in its own quantity."""
    return [
        f"  measured  {one['name']}, {one['load']} to {one['probe']}: {_agreement(one)}"
        for one in facts["measured"]
    ]


def _agreement(one: dict[str, Any]) -> str:
    """The criterion and the level with the lines that they are of, or why there is none."""
    if one["n_lines"] < LEAST:
        return f"no FRAC, with {one['n_lines']} of its lines within those computed"
    return (
        f"FRAC {one['frac']:.3f} of {one['quantity']}, level {one['level']:+.1f} dB computed over "
        f"measured ({one['n_lines']} lines, {one['first']:g} to {one['last']:g} Hz)"
    )


def _decibels(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f} dB"


def time_line(facts: dict[str, Any]) -> str:
    """What a run or sweep took, if it has ended, and what its lines did."""
    each, in_all = facts["seconds_per_line"], facts.get("seconds")
    per_line = "-" if each is None else f"{1e3 * each:.3g} ms"
    words = "" if in_all is None else f"{in_all:.1f} s in all, "
    return f"  time      {words}{per_line} per line ({facts['solver']})"


def resumed_lines(facts: dict[str, Any]) -> list[str]:
    """How many lines an earlier run had solved, if one was gone on with."""
    n_lines = facts.get("resumed_lines")
    return [f"  resumed   {n_lines} lines were there"] if n_lines else []


def missing_lines(n_missing: int) -> list[str]:
    """How much is missing of a run that was ended, if anything."""
    again = "--resume computes them"
    return [f"  MISSING   {n_missing} lines, not solved yet; {again}"] if n_missing else []


def first_of(texts: Sequence[str]) -> list[str]:
    """The first of many lines, and how many more there are."""
    rest = len(texts) - MOST_NAMED
    return [*texts[:MOST_NAMED], *([f"and {rest} more"] if rest > 0 else [])]


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
        *missing_lines(facts["missing_lines"]),
        *([f"  adaptive  {facts['adaptive']}"] if facts["adaptive"] else []),
        *proof_lines(facts),
        *_certificate_lines(facts),
        *_measured_lines(facts),
        *([f"  pressure  {facts['inflation']['words']}"] if facts["inflation"] else []),
        *(f"  load      {label}" for label in facts["loads"]),
        *(f"  probe     {label}" for label in facts["probes"]),
        *([f"  hub       {', '.join(results.hub)}"] if results.hub else []),
        *(f"  failed    {reason}" for reason in facts["failed"]),
        *(f"  breach    {reason}" for reason in first_of(facts["breaches"])),
    ]
    return "\n".join(lines)


def describe_estimate(case: Case, found: Estimate, jobs: int) -> str:
    """What a case would compute."""
    lines = [
        f"{case.title or case.name}: {case.name}",
        *(f"  mesh      {line}" for line in found.mesh_file),
        f"  section   {found.section_nodes} nodes, "
        + (f"{found.section_elements} {case.cell.element} elements, " * (not found.matrices))
        + f"{found.free_section_dofs} dofs that move",
        f"  cell      {found.cell_nodes} nodes, {found.cell_dofs} dofs, "
        f"{case.cell.sector_angle:g} degrees",
        f"  ring      {found.n_cells} cells, {found.ring_nodes} nodes, {found.ring_dofs} dofs",
        *([f"  tread     {found.grooves}"] if found.grooves else []),
        f"  mass      {found.mass:.2f} kg"
        + (f": {_shares(found.masses)}" if len(found.masses) > 1 else ""),
        f"  lines     {found.n_lines}, up to {found.top_frequency:g} Hz"
        + (", solved as far as a fit of the others needs" if case.frequency.adaptive else ""),
        f"  columns   {found.n_loads} loads, {found.n_probes} probes (driving points included)"
        + (f", {3 * found.n_sensors} loads for sensors" if found.n_sensors else ""),
        *(f"  matrices  {fact}" for fact in found.matrices),
        *(
            f"  waves     {r.material} at {found.top_frequency:g} Hz: "
            f"shear {1e3 * r.shear:.3g} mm, bending {1e3 * r.bending:.3g} mm "
            f"(of a {1e3 * r.thickness:.3g} mm wall), "
            f"elements up to {1e3 * r.size:.3g} mm: "
            f"{r.per_wavelength:.1f} per wavelength ({r.enough:g} recommended)"
            for r in found.resolution
        ),
        f"  cost      {'at most' if case.frequency.adaptive else 'about'} "
        f"{found.seconds:.0f} s and {found.memory / 1e6:.0f} MB "
        f"with --jobs {jobs} ({found.solver})",
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
