"""`tyrefrf export`: from a results file to files of other programs."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from tyrefrf.case.faults import did_you_mean
from tyrefrf.errors import CommandError, ResultsError, SolveError

if TYPE_CHECKING:
    from tyrefrf.cli.exporting_fields import Wanted
    from tyrefrf.results import Results, SweepResults
    from tyrefrf.results.results import Quantity


def export_to_files(
    file: Path,
    formats: Sequence[str],
    quantity: Quantity,
    output: Path | None,
    reference: str,
    wanted: Wanted,
    *,
    force: bool,
    json: bool,
) -> None:
    """Export a results file and print the files written.

    wanted: of the fields, where "vtk" is one of the formats.
    Raises CommandError for a wrong format or reference, and where a file exists and nothing may be
    replaced; ResultsError as `load_any` and `export`; as `plan_fields`; and SolveError, when all
    else is written, where a field has no answer.
    """
    from tyrefrf.cli.exporting_fields import VTK, plan_fields
    from tyrefrf.cli.report import as_json
    from tyrefrf.results import load_any
    from tyrefrf.results.derived import reference_of
    from tyrefrf.results.export import FORMATS, check_formats, export, planned_files

    known = (*FORMATS, VTK)
    for form in formats:
        if form not in known:
            hint = did_you_mean(form, known)
            raise CommandError(f"--to: no format {form!r}; there are {', '.join(known)}{hint}")
    if not formats:
        raise CommandError(f"--to: no format; there are {', '.join(known)}")
    wanted.refuse_without(formats)
    try:
        relative_to = reference_of(quantity, reference)
    except ResultsError as error:
        raise CommandError(f"--reference: {error}") from None
    tables = [form for form in formats if form != VTK]
    check_formats(tables)
    results = load_any(file)
    if missing := getattr(results, "n_missing", 0):
        print(f"warning: {missing} lines are not solved yet: they are NaN", file=sys.stderr)
    stem = (output or file.parent) / file.stem
    try:
        planned = planned_files(results, stem, tables, quantity) if tables else []
        fields = plan_fields(results, wanted, stem.parent) if VTK in formats else None
    except ResultsError as error:
        raise ResultsError(f"{file}: {error}") from None
    there = [path for path in (*planned, *(fields.files if fields else ())) if path.exists()]
    if there and not force:
        raise CommandError(
            f"{', '.join(map(str, there))} exists; --force replaces it, --output DIR writes "
            "somewhere else"
        )
    done, failed = fields.write() if fields else ([], [])
    if tables:
        done += export(results, stem, tables, quantity, relative_to)
    written = [str(path) for path in done]
    typer.echo(as_json({"files": written}) if json else "\n".join(written))
    if failed:
        raise SolveError("\n".join(failed))


def exported(results: Results | SweepResults, target: Path, formats: Sequence[str]) -> list[Path]:
    """The files that the case's `output.export` asks for, beside the results file."""
    from tyrefrf.results.export import export

    return export(results, target.with_name(target.stem), formats)


def check_exports(formats: Sequence[str]) -> None:
    """Raise ResultsError before anything is computed, where a format needs a missing library."""
    from tyrefrf.results.export import check_formats

    check_formats(formats)
