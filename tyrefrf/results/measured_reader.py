"""From the measured files that a case names to measured responses."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tyrefrf.case import MeasuredFile, unreadable
from tyrefrf.errors import CaseError, Problem, ResultsError
from tyrefrf.results.measured import Measured
from tyrefrf.results.measured_csv import read_csv
from tyrefrf.results.measured_uff import read_uff


def read_measured(tables: Sequence[MeasuredFile], directory: Path) -> tuple[Measured, ...]:
    """Every measured response of a case whose files are in a directory.

    Raises CaseError with all that cannot be read, or are not what the case says.
    """
    curves, problems = [], []
    for i, table in enumerate(tables):
        path = directory / table.file
        try:
            curves.append(read_one(table, path))
        except OSError as error:
            problems.append(Problem(("measured", i, "file"), unreadable(path, error)))
        except ResultsError as error:
            problems.append(Problem(("measured", i, "file"), str(error)))
    if problems:
        raise CaseError(problems)
    return tuple(curves)


def read_one(table: MeasuredFile, path: Path) -> Measured:
    """A measured response. Raises ResultsError, and OSError where there is no file."""
    if table.is_uff:
        said, frequency, response = read_uff(path, table.record, table.response, table.reference)
    else:
        said, (frequency, response) = None, read_csv(path, table.columns)
    quantity = table.quantity or said
    if quantity is None:
        choices = "receptance, mobility or accelerance"
        raise ResultsError(f"{path}: the record does not say its quantity; give {choices}")
    return Measured(
        name=table.label,
        load=table.load,
        probe=table.probe,
        quantity=quantity,
        frequency=frequency,
        response=table.scale * response,
    )
