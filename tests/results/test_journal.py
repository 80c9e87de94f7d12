"""A journal keeps every line that it was given, to the bit, and never another number."""

from __future__ import annotations

import resource
from collections import deque
from dataclasses import replace

import numpy as np
import pytest
import synthetic

from tyrefrf.errors import ResultsError
from tyrefrf.results import load_any, load_results, write_results
from tyrefrf.results.journal import MAGIC, Journal, records_of
from tyrefrf.results.left import left_in, read_journal

ARRAYS = (
    "frequency",
    "receptance",
    "mobility",
    "blocked_force",
    "solved",
    "residual",
    "solve_time",
)
LINES = 30
HEAD = 12  # bytes before a record


@pytest.fixture
def made():
    """Results of thirty lines, of which the eighth failed and the tenth has a remark."""
    made = synthetic.with_failed(synthetic.results(), 7)
    remark = ["solved by `cyclic`" if k == 9 else text for k, text in enumerate(made.remark)]
    short = {
        name: getattr(made, name)[..., :LINES].copy()
        for name in ("frequency", "receptance", "blocked_force", "solved", "residual", "solve_time")
    }
    return replace(made, remark=tuple(remark[:LINES]), **short)


@pytest.fixture
def blank(made):
    """The same results before the first line."""
    nothing = np.full(LINES, np.nan)
    return replace(
        made,
        receptance=made.receptance * np.nan,
        blocked_force=made.blocked_force * np.nan,
        solved=np.zeros(LINES, bool),
        residual=nothing,
        solve_time=nothing.copy(),
        remark=("",) * LINES,
    )


@pytest.fixture
def lines(made):
    """Its lines, the last first."""
    return left_in(made).lines[::-1]


@pytest.fixture
def path(blank, lines, tmp_path):
    """The journal of a run that was killed with the last line to do."""
    return journal_with(tmp_path / "made_up.journal", blank, lines[1:])


def journal_with(path, blank, lines):
    with Journal(path) as journal:
        journal.begin(blank)
        for line in lines:
            journal.add([line])
    return path


def assert_same_but(results, expected, missing):
    """Equal to the bit on all lines but these, which are missing."""
    there = np.setdiff1d(np.arange(LINES), missing)
    for name in ARRAYS:
        found, wanted = (getattr(one, name)[..., there] for one in (results, expected))
        np.testing.assert_array_equal(found, wanted, strict=True)
    assert [results.remark[k] for k in there] == [expected.remark[k] for k in there]
    assert np.flatnonzero(results.missing).tolist() == sorted(missing)
    assert np.isnan(results.receptance[..., missing]).all()


def test_lines_come_back_to_the_bit_and_the_rest_is_missing(path, made):
    assert_same_but(load_any(path), made, [LINES - 1, 7])  # the eighth was never solved


def test_a_line_that_failed_comes_back_with_its_reason(blank, lines, tmp_path):
    failed = replace(
        lines[0].line, receptance=lines[0].line.receptance * np.nan, remark="420 Hz: no"
    )
    path = journal_with(tmp_path / "j.journal", blank, [replace(lines[0], line=failed)])
    left = read_journal(path)
    assert left.results.remark[LINES - 1] == "420 Hz: no"
    assert left.results.failed.nonzero()[0].tolist() == [LINES - 1]
    assert (left.n_there, left.n_lines) == (0, LINES)


def test_a_later_answer_replaces_a_failure(blank, lines, tmp_path):
    failed = replace(lines[0], line=replace(lines[0].line, remark="died"))
    path = journal_with(tmp_path / "j.journal", blank, [failed, lines[0]])
    assert read_journal(path).results.remark[LINES - 1] == ""
    assert read_journal(path).n_there == 1


def test_whatever_a_kill_cuts_off_only_the_line_under_way_is_lost(path, made):
    whole, records = path.read_bytes(), list(records_of(path))
    of_last = HEAD + len(records[-1])
    for cut in range(1, of_last + 1):
        path.write_bytes(whole[:-cut])
        assert list(records_of(path)) == records[:-1]
    assert_same_but(read_journal(path).results, made, [LINES - 1, 7, 0])
    path.write_bytes(whole[: -of_last - 1])
    assert list(records_of(path)) == records[:-2]


def test_a_damaged_byte_is_never_a_wrong_number(path, made):
    whole, records = path.read_bytes(), list(records_of(path))
    begin = len(whole) - sum(HEAD + len(record) for record in records[1:])
    for place in range(begin, len(whole), 7):
        damaged = bytearray(whole)
        damaged[place] ^= 0x10
        path.write_bytes(damaged)
        found = list(records_of(path))
        assert found == records[: len(found)]
        assert len(found) < len(records)
    results = read_journal(path).results
    assert_same_but(results, made, np.flatnonzero(results.missing).tolist())


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "not a journal of tyrefrf"),
        (b"frequency,real,imag\n", "not a journal of tyrefrf"),
        (b"tyrefrf journal 2\n", "of a newer tyrefrf"),
        (MAGIC + b"\x07" * 30, "damaged where it begins"),
    ],
)
def test_what_is_no_journal_is_refused(tmp_path, content, message):
    path = tmp_path / "odd.journal"
    path.write_bytes(content)
    with pytest.raises(ResultsError, match=message):
        load_any(path)


def test_a_new_journal_holds_what_is_known_before_it_takes_the_old_one_s_place(
    path, made, blank, lines
):
    with Journal(path, lines[1:]) as journal:
        journal.begin(blank)
        journal.add(lines[:1])
    assert_same_but(read_journal(path).results, made, [7])
    assert list(path.parent.iterdir()) == [path]


def test_a_journal_without_a_line_leaves_no_file(blank, tmp_path):
    journal_with(tmp_path / "empty.journal", blank, [])
    assert list(tmp_path.iterdir()) == []


def test_where_room_ends_all_earlier_lines_are_kept(path, made, blank, lines, file_sizes_up_to):
    of_a_line = HEAD + len(list(records_of(path))[-1])
    with Journal(path) as journal:
        journal.begin(blank)
        file_sizes_up_to(path.stat().st_size + int(2.5 * of_a_line))
        with pytest.raises(ResultsError, match=r"made_up\.journal: cannot be written: File too la"):
            deque(map(journal.add, ([line] for line in lines)))
        size = path.stat().st_size
    assert journal.n_lines == 2
    assert sum(HEAD + len(record) for record in records_of(path)) + len(MAGIC) == size
    assert_same_but(read_journal(path).results, made, [*range(LINES - 2)])


@pytest.fixture
def file_sizes_up_to():
    """A function that limits files to so many bytes, as a full disk would."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    yield lambda size: resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_the_results_so_far_are_read_where_the_file_is_not_there_yet(path, made):
    assert_same_but(load_results(path.with_suffix(".h5")), made, [LINES - 1, 7])


def test_the_journal_is_read_where_the_file_has_fewer_lines(path, made, blank, lines):
    target = path.with_suffix(".h5")
    write_results(target, read_journal(journal_with(path, blank, lines[5:])).results)
    assert load_results(target).n_missing == 6
    journal_with(path, blank, lines[1:])
    assert_same_but(load_results(target), made, [LINES - 1, 7])


def test_a_complete_file_stands_whatever_journal_lies_beside(path, made):
    write_results(path.with_suffix(".h5"), made)
    assert load_results(path.with_suffix(".h5")).n_missing == 0


def test_missing_lines_outlast_the_results_file(path, made):
    write_results(path.with_name("other.h5"), load_any(path))
    assert_same_but(load_results(path.with_name("other.h5")), made, [LINES - 1, 7])


@pytest.mark.parametrize("n_zeros", [1, HEAD, 100, 4096])
def test_zeros_that_a_power_cut_leaves_at_the_end_are_no_lines(n_zeros, path, made):
    with path.open("ab") as file:
        file.write(bytes(n_zeros))
    assert_same_but(load_any(path), made, [LINES - 1, 7])


def test_a_line_that_is_being_synchronised_counts(tmp_path, blank, lines, monkeypatch):
    def interrupted(number):
        raise KeyboardInterrupt

    with Journal(tmp_path / "j.journal") as journal:
        journal.begin(blank)
        monkeypatch.setattr("tyrefrf.results.journal.os.fsync", interrupted)
        with pytest.raises(KeyboardInterrupt):
            journal.add(lines[:1])
    assert read_journal(journal.path).n_there == 1


def test_a_run_that_ends_while_its_journal_is_read_is_read_from_its_file(path, made, monkeypatch):
    def ended(journal):
        write_results(path.with_suffix(".h5"), made)
        journal.unlink()
        return read_journal(journal)

    monkeypatch.setattr("tyrefrf.results.reader.read_journal", ended)
    assert load_any(path.with_suffix(".h5")).n_missing == 0
