"""From results to a file."""

from __future__ import annotations

from pathlib import Path

from tyrefrf.results.file import write_file
from tyrefrf.results.results import Results
from tyrefrf.results.run_layout import fields_of
from tyrefrf.results.sweep import SweepResults
from tyrefrf.results.sweep_layout import sweep_datasets


def write_results(path: str | Path, results: Results) -> None:
    """Write results to an HDF5 file that appears whole or not at all.

    An existing file is replaced. Raises ResultsError where the file cannot be written.
    """
    datasets = [(field, field.of(results)) for field in fields_of(results)]
    write_file(path, "run", results.provenance, datasets)


def write_sweep(path: str | Path, sweep: SweepResults) -> None:
    """Write a sweep as `write_results` does a run: the same datasets, parameters leading."""
    write_file(path, "sweep", sweep.provenance, sweep_datasets(sweep))
