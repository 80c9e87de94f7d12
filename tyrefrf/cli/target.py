"""Where a command writes: nothing that is there is lost, and nobody else writes there meanwhile."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tyrefrf.errors import CommandError, ResultsError


@contextmanager
def new_target(
    output: Path | None, name: str, *, force: bool, resume: bool | None = None
) -> Iterator[Path]:
    """The results file of that name, its directory made, and locked.

    resume: whether what is there is gone on with; None for a command that cannot.

    Raises CommandError where it exists, or a journal of it, and nothing may be replaced or gone on
    with, and where somebody else is writing it; ResultsError where nothing can be written.
    """
    from tyrefrf.results.journal import journal_of
    from tyrefrf.results.lock import InUseError, only_writer
    from tyrefrf.results.whole import remove_leftovers

    if force and resume:
        raise CommandError("--resume goes on with what is there, --force replaces it; give one")
    directory = output or Path("results") / name
    target = directory / f"{name}.h5"
    may_replace = force or bool(resume)
    if not may_replace:
        _refuse_a_file(target, or_resumed=resume is not None)
    if target.is_dir():
        raise CommandError(f"{target} is a directory; --output DIR writes somewhere else")
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"{directory}: cannot be made: {error.strerror}; --output DIR writes elsewhere"
        raise ResultsError(message) from error
    try:
        with only_writer(target):
            if not may_replace:  # by now, who has written there has ended
                _refuse_a_file(target, or_resumed=resume is not None)
                _refuse_a_journal(target)
            for path in (target, journal_of(target)):
                remove_leftovers(path)
            yield target
    except InUseError as error:
        raise CommandError(f"{error}; wait for it, or --output DIR writes somewhere else") from None


def _refuse_a_file(target: Path, *, or_resumed: bool) -> None:
    if target.exists():
        raise CommandError(
            f"{target} exists; {'--resume computes what it lacks, ' * or_resumed}--force replaces "
            "it, --output DIR writes somewhere else"
        )


def _refuse_a_journal(target: Path) -> None:
    from tyrefrf.results.journal import journal_of
    from tyrefrf.results.left import read_journal

    journal = journal_of(target)
    if journal.exists():
        left = read_journal(journal)
        raise CommandError(
            f"{journal} holds {left.n_there} of {left.n_lines} lines of a run that was ended; "
            "--resume computes the rest, --force begins anew"
        )
