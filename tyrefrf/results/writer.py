"""From results to a file."""

from __future__ import annotations

from pathlib import Path

from tyrefrf.results.field import Dataset
from tyrefrf.results.file import file_image, write_file
from tyrefrf.results.results import Results
from tyrefrf.results.run_layout import fields_of
from tyrefrf.results.sweep import SweepResults
from tyrefrf.results.sweep_layout import sweep_datasets


def write_results(path: str | Path, results: Results | SweepResults) -> None:
    """Write results to an HDF5 file that appears whole or not at all.

    An existing file is replaced. Raises ResultsError where the file cannot be written.
    """
    content, datasets = content_of(results)
    write_file(path, content, results.provenance, datasets)


def write_sweep(path: str | Path, sweep: SweepResults) -> None:
    """Write a sweep as `write_results` does a run: the same datasets, parameters leading."""
    write_results(path, sweep)


def image_of(results: Results | SweepResults) -> memoryview:
    """The bytes of the file that these results would be written to."""
    content, datasets = content_of(results)
    return file_image(content, results.provenance, datasets)


def content_of(results: Results | SweepResults) -> tuple[str, list[Dataset]]:
    """What a file of these results holds, in a word and in datasets."""
    if isinstance(results, SweepResults):
        return "sweep", sweep_datasets(results)
    return "run", [(field, field.of(results)) for field in fields_of(results)]
