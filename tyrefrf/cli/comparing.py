"""`tyrefrf compare`: the same lines by several solvers, in a table like the paper's table 2."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from tyrefrf.results import Comparison
    from tyrefrf.study.compare import Cost

HEADER = (
    "solver",
    "CPU time per line",
    "preparation",
    "peak memory",
    "on disk",
    "largest residual",
    "largest difference",
)

NOT_SHOWN = """\
Every solver solved the same lines, one after another, each in a process of its own with one BLAS
thread. Time per line: CPU time, the median, and in brackets what 8 lines of 10 lie between.
Preparation: what is done once, before the first line (`modal`: its modes). Peak memory: most that
was resident until the last line was solved; in brackets what of it came after the tyre was
assembled. On disk: the results file, as `tyrefrf run` writes it: the responses asked for, not the
motion of the whole tyre. Residual: ||F - D q|| / ||F|| of the ring's equations. Difference: norm
of the difference over a section's displacement, relative to the norm of that displacement by
`{reference}`; the largest over all sections, loads and {samples} lines.

Not shown: starting Python, meshing and assembling (the same for all), writing, plots, and what
more cores would do. What else kept the machine busy is not in CPU times, but slows them a little.
Solvers that agree, agree on the mesh, not on the tyre: `tyrefrf check` says how fine that is.

The paper's table 2, for its layered tyre of 60 cells in 2011 (Core 2 Quad, 4 GB): Ansys direct
133 s per frequency and 26 GB, Ansys with 1000 modes 3 s and 28 GB, recursion 10 s and 2 MB. Its
figure 5: recursion and full model differ by 4e-6."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What the command line asks for: solvers by name, lines (None: all), where files go."""

    solvers: tuple[str, ...]
    lines: int | None
    output: Path | None
    formats: tuple[str, ...]
    force: bool
    json: bool


def compare_to_files(case_file: Path | None, asked: Asked) -> int:
    """Compare solvers, write results, table and plots, print the table; the exit status."""
    from tyrefrf.cli.progress import progress_of
    from tyrefrf.cli.report import as_json
    from tyrefrf.cli.running import in_file, read_case, status_of
    from tyrefrf.cli.target import new_target
    from tyrefrf.plots import draw_plots
    from tyrefrf.results import write_comparison
    from tyrefrf.study.compare import known_solvers, run_comparison, with_lines

    start = time.perf_counter()
    solvers = known_solvers(asked.solvers)
    case, text = read_case(case_file, None)
    n_lines = len(with_lines(case, asked.lines).frequency.lines())
    directory = asked.output or Path("results") / case.name
    with new_target(directory, f"{case.name}_comparison", force=asked.force) as target:
        with in_file(case_file, text):
            comparison = run_comparison(
                case,
                solvers,
                lines=asked.lines,
                case_text=text,
                tell=partial(say_costs, case.name, n_lines),
                watch=lambda solver: progress_of(n_lines, f"{case.name}, {solver}"),
            )
        write_comparison(target, comparison)
        table = write_table(target.with_suffix(".md"), comparison)
        drawn = draw_plots(comparison, target.parent / "plots", asked.formats or case.output.plots)
    facts = comparison_summary(comparison, [target, table, *drawn])
    facts["seconds"] = time.perf_counter() - start
    typer.echo(as_json(facts) if asked.json else describe_comparison(facts))
    return status_of(facts)


def say_costs(case: str, n_lines: int, costs: Mapping[str, Cost]) -> None:
    """Say what a comparison is going to take, by solver, before it begins."""
    each = "; ".join(
        f"{name} {cost.seconds:.0f} s, {cost.memory / 1e6:.0f} MB" for name, cost in costs.items()
    )
    total = sum(cost.seconds for cost in costs.values())
    said = f"{case}: {n_lines} lines, about {total:.0f} s in all ({each})"
    print(said, file=sys.stderr, flush=True)


def comparison_summary(comparison: Comparison, files: Sequence[Path]) -> dict[str, Any]:
    """The facts of a comparison that a script wants to know; times [s], memory and disk [bytes]."""
    from tyrefrf.cli.report import probe_labels

    origin, names = comparison.provenance, comparison.solvers
    return {
        "case": origin.case_name,
        "title": origin.title,
        "created": origin.created,
        "cells": origin.n_cells,
        **origin.numbers,
        "lines": len(comparison.frequency),
        "first_frequency": float(comparison.frequency[0]),
        "last_frequency": float(comparison.frequency[-1]),
        "loads": [place.label for place in comparison.loads],
        "probes": probe_labels(comparison.probes),
        "machine": comparison.machine,
        "reference": comparison.reference,
        "compared_sections_at": comparison.frequency[comparison.samples].tolist(),
        "solvers": [_of_solver(comparison, i) for i in range(len(names))],
        "differences": {
            name: dict(zip(names, row, strict=True))
            for name, row in zip(names, comparison.pair_error.tolist(), strict=True)
        },
        "failed": [
            *(f"{name}: {why}" for name, why in zip(names, comparison.failure, strict=True) if why),
            *_remarks(comparison, failed=True),
        ],
        "remarks": _remarks(comparison, failed=False),
        "files": [str(path) for path in files],
    }


def _of_solver(comparison: Comparison, i: int) -> dict[str, Any]:
    """A row of the table, in numbers."""
    import numpy as np

    from tyrefrf.results.comparison import largest

    low, median, high = np.quantile(comparison.seconds[i], (0.1, 0.5, 0.9)).tolist()
    return {
        "solver": comparison.solvers[i],
        "seconds_per_line": median,
        "seconds_per_line_range": [low, high],
        "prepare_seconds": float(comparison.prepare_seconds[i]),
        "peak_memory": float(comparison.peak_memory[i]),
        "base_memory": float(comparison.base_memory[i]),
        "disk": float(comparison.disk[i]),
        "largest_residual": float(largest(comparison.residual[i])),
        "largest_difference": float(comparison.error[i]),
        "largest_response_difference": float(largest(comparison.difference[i])),
        "failed_lines": int(comparison.failed[i].sum()),
        "failure": comparison.failure[i],
    }


def _remarks(comparison: Comparison, *, failed: bool) -> list[str]:
    """Remarks on single lines that failed, or did not, of solvers that answered at all."""
    return [
        f"{name}: {remark}" if failed else f"{name}: {frequency:.6g} Hz: {remark}"
        for name, why, run in zip(
            comparison.solvers, comparison.failure, comparison.runs, strict=True
        )
        for frequency, remark, here in zip(run.frequency, run.remark, run.failed, strict=True)
        if remark and here == failed and not why
    ]


def describe_comparison(facts: dict[str, Any]) -> str:
    """The table and what belongs to it, in plain text."""
    n_failed = sum(row["failed_lines"] for row in facts["solvers"] if not row["failure"])
    lines = [
        facts["title"],
        f"  tyre      {facts['cells']} cells, {facts['ring_nodes']} nodes, "
        f"{facts['ring_dofs']} dofs",
        f"  lines     {facts['lines']}, {facts['first_frequency']:g} to "
        f"{facts['last_frequency']:g} Hz" + (f", {n_failed} FAILED" if n_failed else ""),
        "",
        *(f"  {row}" for row in aligned(table_of(facts))),
        "",
        *(f"  remark    {remark}" for remark in facts["remarks"]),
        *(f"  failed    {failed}" for failed in facts["failed"]),
        *(f"  wrote     {path}" for path in facts["files"]),
    ]
    return "\n".join(lines).rstrip()


def write_table(path: Path, comparison: Comparison) -> Path:
    """Write the table as Markdown, with the machine and what it does not show."""
    from tyrefrf.results.whole import whole_file

    with whole_file(path) as temporary:
        temporary.write_text(markdown(comparison_summary(comparison, [])), encoding="utf-8")
    return path


def markdown(facts: dict[str, Any]) -> str:
    """The table and what belongs to it, in Markdown."""
    machine = ", ".join(f"{name} {value}" for name, value in facts["machine"].items())
    samples = len(facts["compared_sections_at"])
    notes = [f"- {text}" for text in (*facts["failed"], *facts["remarks"])]
    parts = [
        f"# {facts['title']}: solvers compared",
        f"`tyrefrf compare`, {facts['created']}; {machine}.",
        f"{facts['cells']} cells, {facts['ring_nodes']} nodes, {facts['ring_dofs']} dofs; "
        f"{facts['lines']} lines, {facts['first_frequency']:g} to {facts['last_frequency']:g} Hz; "
        f"{len(facts['loads'])} load(s), {len(facts['probes'])} probes.",
        in_markdown(table_of(facts)),
        "Largest difference of the solver of the row to that of the column:",
        in_markdown(pair_table(facts)),
        NOT_SHOWN.format(reference=facts["reference"], samples=samples),
        *(["Lines and solvers to mention:\n\n" + "\n".join(notes)] if notes else []),
    ]
    return "\n\n".join(parts) + "\n"


def table_of(facts: dict[str, Any]) -> list[list[str]]:
    """The table, its header first."""
    header = [*HEADER[:-1], f"{HEADER[-1]} to {facts['reference']}"]
    return [header, *(_row(solver) for solver in facts["solvers"])]


def pair_table(facts: dict[str, Any]) -> list[list[str]]:
    """Differences of every solver to every other, the names first."""
    differences = facts["differences"]
    return [
        ["", *differences],
        *([name, *map(_small, row.values())] for name, row in differences.items()),
    ]


def _row(solver: dict[str, Any]) -> list[str]:
    """A solver in words; one without answers has dashes, and its reason stands below."""
    from tyrefrf.results.comparison import time_text

    if solver["failure"]:
        return [solver["solver"], "no answer", *"-----"]
    low, high = solver["seconds_per_line_range"]
    peak, added = solver["peak_memory"], solver["peak_memory"] - solver["base_memory"]
    return [
        solver["solver"],
        f"{time_text(solver['seconds_per_line'])} ({time_text(low)} to {time_text(high)})",
        time_text(solver["prepare_seconds"]),
        f"{peak / 1e6:.0f} MB ({added / 1e6:.0f} MB)",
        f"{solver['disk'] / 1e6:.2f} MB",
        _small(solver["largest_residual"]),
        _small(solver["largest_difference"]),
    ]


def _small(value: float) -> str:
    """A small number, or a dash where there is none."""
    return "-" if value != value else f"{value:.1e}" if value else "0"


def aligned(table: list[list[str]]) -> list[str]:
    """A table's rows in columns, its header underlined."""
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    rows = [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in table
    ]
    return [rows[0], "  ".join("-" * width for width in widths), *rows[1:]]


def in_markdown(table: list[list[str]]) -> str:
    """A Markdown table."""
    header, *rows = table
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
