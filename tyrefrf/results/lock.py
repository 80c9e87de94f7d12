"""One writer at a time of a results file."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import datetime
from pathlib import Path

from tyrefrf.errors import ResultsError
from tyrefrf.results.whole import unwritable


class InUseError(ResultsError):
    """Somebody else writes the same results."""


@contextmanager
def only_writer(target: Path) -> Iterator[None]:
    """Hold the lock beside a results file; it ends with the process, however that ends.

    Raises InUseError, which says who holds it, where somebody else does, and ResultsError where
    nothing can be written there.
    """
    from filelock import FileLock, Timeout

    path = target.with_name(f".{target.name}.lock")
    lock = FileLock(path, timeout=0)
    try:
        lock.acquire()
    except Timeout:
        raise InUseError(f"{target} is being written by {_holder(path)}") from None
    except OSError as error:
        raise unwritable(target.parent, error) from error
    try:
        with suppress(OSError):  # a full disk is told of where something is lost by it
            path.write_text(json.dumps(_this_process()), encoding="utf-8")
        yield
    finally:
        lock.release()


def _this_process() -> dict[str, object]:
    since = datetime.now().astimezone().isoformat(" ", "seconds")
    return {"process": os.getpid(), "host": platform.node(), "since": since}


def _holder(path: Path) -> str:
    """Who holds a lock, if that is known."""
    try:
        said = json.loads(path.read_text(encoding="utf-8"))
        return f"process {said['process']} on {said['host']}, since {said['since']}"
    except (OSError, ValueError, KeyError, TypeError):
        return "another process"
