"""The journal of a run or sweep from the command line: taken up, and kept where the run is not."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefrf.cli.interrupt import Interrupted
from tyrefrf.errors import CommandError, ResultsError, TyreFRFError

if TYPE_CHECKING:
    from tyrefrf.case import Case
    from tyrefrf.results.journal import Journal
    from tyrefrf.results.left import Left, Responses


def take_up(target: Path, case: Case, kind: type[Responses]) -> tuple[Case, Left | None]:
    """What an earlier run has left of these results, and the case as that run decided it.

    kind: of the results. Raises CommandError where that run was of another case or kind.
    """
    from tyrefrf.results.reader import left_by
    from tyrefrf.study.resume import check_kind, resumed

    left = left_by(target)
    if left is None:
        return case, None
    with as_another(target):
        check_kind(left, kind)
        return resumed(case, left), left


@contextmanager
def as_another(target: Path) -> Iterator[None]:
    """Say what may be done about results that cannot be gone on with."""
    try:
        yield
    except CommandError as error:
        what = "--force begins anew, --output DIR writes somewhere else"
        raise CommandError(f"{target}: {error}\n{what}") from None


def is_done(target: Path, left: Left) -> bool:
    """Whether the results file itself has every line."""
    from tyrefrf.results.journal import journal_of

    return left.is_complete and not journal_of(target).exists()


@contextmanager
def journalled(target: Path, left: Left | None) -> Iterator[Journal]:
    """The journal that a run writes, with the lines that were there before.

    Where the run is interrupted, the results file is written with what there is, unless one stands
    there that has all its lines.
    """
    from tyrefrf.results.journal import Journal, journal_of

    with Journal(journal_of(target), left.answered if left else ()) as journal:
        try:
            yield journal
        except Interrupted as interrupt:
            journal.close()
            raise Interrupted(interrupt.number, _kept(target, journal)) from None
        except (TyreFRFError, OSError, MemoryError) as error:
            journal.close()
            if journal.path.exists():
                error.add_note(_in_journal(journal.path))
            raise


@contextmanager
def beside_results(target: Path) -> Iterator[None]:
    """Say of what fails after the results are written that they are not touched by it."""
    try:
        yield
    except Interrupted as interrupt:
        raise Interrupted(interrupt.number, _complete(target)) from None
    except (TyreFRFError, OSError, MemoryError) as error:
        error.add_note(_complete(target))
        raise


def _complete(target: Path) -> str:
    return f"{target} is complete; tyrefrf plot {target} draws it again"


def _kept(target: Path, journal: Journal) -> str:
    """Write what is there so far, if nothing is lost by it; where it is, in words."""
    from tyrefrf.results.left import read_journal
    from tyrefrf.results.writer import write_results

    if journal.is_over:
        return _complete(target)
    if not journal.path.exists():
        return "no line was solved"
    left = read_journal(journal.path)
    if not left.lines:
        journal.path.unlink()
        return "no line was solved"
    if not _may_be_replaced(target, left):
        return _in_journal(journal.path)
    try:
        write_results(target, left.results)
    except ResultsError as error:
        return f"{error}\n{_in_journal(journal.path)}"
    return f"{target} holds {left.n_there} of {left.n_lines} lines; --resume computes the rest"


def _may_be_replaced(target: Path, left: Left) -> bool:
    """Whether nothing is there but fewer lines of the same results."""
    from tyrefrf.results.reader import load_file

    if not target.exists():
        return True
    try:
        there = load_file(target)
    except TyreFRFError:
        return False
    return (
        isinstance(there, type(left.results))
        and there.provenance.case_hash == left.results.provenance.case_hash
        and there.n_missing >= left.results.n_missing > 0
    )


def _in_journal(journal: Path) -> str:
    from tyrefrf.results.left import read_journal

    left = read_journal(journal)
    there = f"{left.n_there} of {left.n_lines} lines"
    return f"{journal} holds {there}; --resume computes the rest"
