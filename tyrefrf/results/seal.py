"""The seal of a results file: a digest of all of it, checked before HDF5 reads a byte.

HDF5 checks the arrays whose chunks it is asked to check, not labels, attributes and its own tables
of what is where; and what those say where they are damaged, it believes. So the digest stands in
front, in the block of a file that HDF5 leaves to its users: h5py, MATLAB and xarray pass over it.
"""

from __future__ import annotations

import hashlib
import re
from pathlib import Path
from typing import IO

from tyrefrf.errors import ResultsError

BLOCK = 512
"""Bytes of the user block, the least that HDF5 allows."""
WORDS = "Results of tyrefrf: HDF5 from byte 512 on, its SHA-256 and its size are"
_SEAL = re.compile(rf"{WORDS}\n([0-9a-f]{{64}})\n([0-9]+)\n".encode())
_AT_ONCE = 1 << 20  # bytes


def seal(file: IO[bytes]) -> None:
    """Write the seal of a finished HDF5 file, open as mere bytes, into its user block."""
    digest, size = _digest(file)
    file.seek(0)
    file.write(f"{WORDS}\n{digest}\n{size}\n".encode())


def check_seal(path: Path) -> None:
    """Raise ResultsError where a sealed file is not what was sealed.

    One without a seal is another program's, or older: the reader will see.
    """
    try:
        is_whole = _is_whole(path)
    except OSError as error:
        raise ResultsError(f"{path}: cannot be read: {error.strerror or error}") from error
    if not is_whole:
        raise ResultsError(
            f"{path}: truncated or damaged, or changed by another program: its content is not "
            "what tyrefrf wrote; run the case again"
        )


def _is_whole(path: Path) -> bool:
    """Whether a file is what its seal says; one without a seal counts as whole."""
    with path.open("rb") as file:
        begins = file.read(BLOCK)
        if not begins.startswith(WORDS[:20].encode()):
            return True
        written = _SEAL.match(begins)
        return written is not None and _digest(file) == (written[1].decode(), int(written[2]))


def _digest(file: IO[bytes]) -> tuple[str, int]:
    """SHA-256 of an open file behind its user block, and the bytes there."""
    found, size = hashlib.sha256(), 0
    file.seek(BLOCK)
    while some := file.read(_AT_ONCE):
        found.update(some)
        size += len(some)
    return found.hexdigest(), size
