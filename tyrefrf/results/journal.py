"""The journal of a run or sweep: every line on disk as soon as it is solved.

A file of records, each with its length and a checksum. The first is the results file without a
line; every other is a line, in the order in which they were solved. It is only ever added to: what
a process was writing as it was killed stands at the end, and does not count.
"""

from __future__ import annotations

import os
import struct
import time
import zlib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Self

import numpy as np

from tyrefrf.errors import ResultsError
from tyrefrf.results.results import Results
from tyrefrf.results.sweep import SweepResults
from tyrefrf.results.whole import unwritable, whole_file
from tyrefrf.results.writer import image_of
from tyrefrf.solvers import Line, TimedLine

ENDING = ".journal"

NAME = b"tyrefrf journal "
MAGIC = NAME + b"1\n"
"""How a journal begins; another number where an older program would misread it."""

SECONDS_TO_DISK = 1.0
"""A record is the system's, and outlives the process, at once; it outlives a power cut after so
many seconds."""

_RECORD = struct.Struct("<QI")  # bytes of the record, and their CRC-32
_LINE = struct.Struct("<IIddI")  # number, index, residual, seconds, bytes of the remark


def journal_of(target: Path) -> Path:
    """The journal of the run that is going to write a results file."""
    return target.with_suffix(ENDING)


class Journal:
    """The journal of a run under way.

    path: of the file. known: lines that are solved already. is_over: whether all that was in it is
    in the results file.
    """

    def __init__(self, path: Path, known: Iterable[TimedLine] = ()) -> None:
        self.path = path
        self.known = {line.place: line for line in known}
        self.n_lines = len(self.known)
        self.is_over = False
        self._file: IO[bytes] | None = None
        self._size = 0
        self._synchronised = 0.0

    def begin(self, blank: Results | SweepResults) -> None:
        """Write the results without a line, and the lines that are known, and wait for others.

        An existing journal is replaced, once all that is known is in the new one.
        Raises ResultsError where it cannot be written.
        """
        with whole_file(self.path) as temporary, temporary.open("xb") as file:
            image = image_of(blank)
            file.write(MAGIC + _head(image))
            file.write(image)
            for record in map(_packed, self.known.values()):
                file.write(_head(record) + record)
        try:
            self._file = self.path.open("ab", buffering=0)
            self._size = self.path.stat().st_size
        except OSError as error:
            raise unwritable(self.path, error) from error

    def add(self, lines: Sequence[TimedLine]) -> None:
        """Add lines just solved. Raises ResultsError where there is no room for them."""
        assert self._file is not None  # begun
        records = b"".join(_head(line) + line for line in map(_packed, lines))
        self.n_lines += len(lines)
        try:
            self._write(self._file, records)
        except OSError as error:
            self.n_lines -= len(lines)
            with suppress(OSError):  # what is there of it does not count anyway
                self._file.truncate(self._size)
            raise unwritable(self.path, error) from error
        self._size += len(records)

    def _write(self, file: IO[bytes], records: bytes) -> None:
        left = memoryview(records)
        while left:
            left = left[file.write(left) :]
        if time.monotonic() - self._synchronised > SECONDS_TO_DISK:
            os.fsync(file.fileno())
            self._synchronised = time.monotonic()

    def __enter__(self) -> Self:
        """The journal; leaving the context closes it."""
        return self

    def __exit__(self, *what_happened: object) -> None:
        self.close()

    def close(self) -> None:
        """No more lines; the file stays if it has any."""
        if self._file is not None:
            self._file.close()
            self._file = None
            if not self.n_lines:
                self.remove()

    def remove(self) -> None:
        """All that was in it is in the results file."""
        self.is_over = self.n_lines > 0
        self.path.unlink(missing_ok=True)


def records_of(path: Path) -> Iterator[bytes]:
    """The records of a journal, up to what was being written as its process was killed.

    Raises ResultsError for what cannot be read, or is no journal of a known layout.
    """
    try:
        with path.open("rb") as file:
            _check_begin(path, file.read(len(MAGIC)))
            size = path.stat().st_size
            while len(head := file.read(_RECORD.size)) == _RECORD.size:
                length, checksum = _RECORD.unpack(head)
                record = file.read(length) if length <= size else b""
                if not length or len(record) != length or zlib.crc32(record) != checksum:
                    return  # zeros, which a power cut may leave, are a length of 0 with its CRC
                yield record
    except OSError as error:
        raise ResultsError(f"{path}: cannot be read: {error.strerror or error}") from error


def _check_begin(path: Path, begin: bytes) -> None:
    if begin == MAGIC:
        return
    if begin.startswith(NAME) and begin.endswith(b"\n"):
        raise ResultsError(
            f"{path}: a journal of a newer tyrefrf; go on with that, or --force begins anew"
        )
    raise ResultsError(f"{path}: not a journal of tyrefrf, or cut off; --force begins anew")


def line_of(record: bytes, n_loads: int) -> TimedLine:
    """A line, as it was packed."""
    number, index, residual, seconds, length = _LINE.unpack_from(record)
    end = _LINE.size + length
    remark = record[_LINE.size : end].decode()
    receptance = np.frombuffer(record, complex, offset=end).reshape(-1, n_loads)
    return TimedLine(number, index, Line(receptance, residual, remark), seconds)


def _head(record: bytes | memoryview) -> bytes:
    """What stands before a record."""
    return _RECORD.pack(len(record), zlib.crc32(record))


def _packed(done: TimedLine) -> bytes:
    remark = done.line.remark.encode()
    head = _LINE.pack(done.number, done.index, done.line.residual, done.seconds, len(remark))
    return head + remark + np.ascontiguousarray(done.line.receptance, complex).tobytes()
