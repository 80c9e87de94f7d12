"""From a file to results."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from tyrefrf.errors import ResultsError
from tyrefrf.results.comparison import Comparison
from tyrefrf.results.comparison_layout import read_comparison
from tyrefrf.results.dispersion import Dispersion
from tyrefrf.results.dispersion_layout import read_dispersion
from tyrefrf.results.file import open_file
from tyrefrf.results.journal import ENDING, journal_of
from tyrefrf.results.left import Left, left_in, read_journal
from tyrefrf.results.modes import Modes
from tyrefrf.results.modes_layout import read_modes
from tyrefrf.results.origin import content_of
from tyrefrf.results.results import Results
from tyrefrf.results.run_layout import read_run
from tyrefrf.results.sweep import SweepResults
from tyrefrf.results.sweep_layout import read_sweep

Content = Results | SweepResults | Comparison | Dispersion | Modes
"""Whatever a results file may hold."""

READERS: dict[str, Callable[[Any], Content]] = {
    "run": read_run,
    "sweep": read_sweep,
    "comparison": read_comparison,
    "modes": read_modes,
    "dispersion": read_dispersion,
}
"""How each content of a file is read."""

LOADERS = {
    "run": "load_results",
    "sweep": "load_sweep",
    "comparison": "load_comparison",
    "modes": "load_modes",
    "dispersion": "load_dispersion",
}

Wanted = TypeVar("Wanted", bound=Content)


def load_results(path: str | Path) -> Results:
    """Read the results that `write_results` wrote.

    Raises ResultsError for what is no file, no HDF5, damaged, of another program, or of a
    layout newer than this program knows; and for a sweep.
    """
    return _load(path, Results)


def load_sweep(path: str | Path) -> SweepResults:
    """Read the sweep that `write_sweep` wrote. Raises ResultsError as `load_results`."""
    return _load(path, SweepResults)


def load_comparison(path: str | Path) -> Comparison:
    """Read what `write_comparison` wrote. Raises ResultsError as `load_results`."""
    return _load(path, Comparison)


def load_modes(path: str | Path) -> Modes:
    """Read the modes that `write_modes` wrote. Raises ResultsError as `load_results`."""
    return _load(path, Modes)


def load_dispersion(path: str | Path) -> Dispersion:
    """Read what `write_dispersion` wrote. Raises ResultsError as `load_results`."""
    return _load(path, Dispersion)


def load_any(path: str | Path) -> Content:
    """Read whatever a file of tyrefrf holds, a journal too. Raises ResultsError as `load_results`.

    Where a run has not ended, what it has solved so far is read from the journal beside its file.
    """
    return _read(Path(path))[1]


def load_file(path: Path) -> Content:
    """Read what a results file itself holds. Raises ResultsError as `load_results`."""
    return _read_file(path)[1]


def left_by(target: Path) -> Left | None:
    """What an earlier run of the same results file has left; None where there is nothing.

    Its journal is asked first, then the file itself. Raises ResultsError where they cannot be read,
    or hold something else than a run or a sweep.
    """
    journal = journal_of(target)
    if journal.is_file():
        return read_journal(journal)
    if not target.exists():
        return None
    content, found = _read(target)
    if not isinstance(found, Results | SweepResults):
        raise ResultsError(f"{target}: holds a {content}, which cannot be gone on with")
    return left_in(found)


def _load(path: str | Path, wanted: type[Wanted]) -> Wanted:
    content, found = _read(Path(path))
    if not isinstance(found, wanted):
        raise ResultsError(f"{path}: holds a {content}; read it with {LOADERS[content]}")
    return found


def _read(path: Path) -> tuple[str, Content]:
    """What a file holds; what its run has added since to the journal, where it is not complete."""
    journal = path if path.suffix == ENDING else journal_of(path)
    if path == journal or (journal.is_file() and not path.exists()):
        try:
            return _so_far(read_journal(journal).results)
        except ResultsError:
            if journal.exists() or not path.exists():
                raise  # else its run has ended meanwhile
    content, found = _read_file(path)
    if journal.is_file() and isinstance(found, Results | SweepResults) and found.n_missing:
        newer = read_journal(journal).results
        if newer.provenance.case_hash == found.provenance.case_hash:
            return _so_far(newer)
    return content, found


def _so_far(results: Results | SweepResults) -> tuple[str, Content]:
    return ("run" if isinstance(results, Results) else "sweep"), results


def _read_file(path: Path) -> tuple[str, Content]:
    with open_file(path) as file:
        content = content_of(path, file, READERS)
        return content, READERS[content](file)
