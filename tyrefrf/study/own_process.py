"""Work done in a process of its own: its memory is its own, and its death is survived.

A new interpreter, started as a program: a fork would begin with its parent's memory, and
multiprocessing's "spawn" would run the caller's script a second time. The work goes in as a
pickle on standard input, what it says comes back as pickles on standard output.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import traceback
from collections.abc import Callable
from contextlib import closing, suppress
from pathlib import Path
from typing import IO, Any, TypeVar

from tyrefrf.errors import SolveError, TyreFRFError
from tyrefrf.study.local import ONE_THREAD

Result = TypeVar("Result")

Say = Callable[[object], None]
"""Tells the parent something while the work goes on."""

START = (
    "import pickle, sys; sys.path[:] = pickle.load(sys.stdin.buffer); "
    "from tyrefrf.study.own_process import answer_parent; answer_parent()"
)


def in_own_process(work: Callable[[Say], Result], listen: Callable[[Any], None]) -> Result:
    """work(say) in a process of its own, with one BLAS thread; ends only with the process.

    work: can be pickled, and so can its result. listen: called with whatever work says, at once.
    Raises SolveError with the reason if the work fails or its process dies; what was not
    foreseen leaves its traceback on stderr.
    """
    command = [sys.executable, "-c", START]
    environment = os.environ | ONE_THREAD
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, env=environment) as process:
        try:
            _give(process, sys.path, work)
            assert process.stdout is not None
            while True:
                kind, what = pickle.load(process.stdout)
                if kind == "done":
                    return what
                if kind == "failed":
                    raise SolveError(what)
                listen(what)
        except (EOFError, pickle.UnpicklingError):  # it died, perhaps in mid-sentence
            raise SolveError(_last_words(process.wait())) from None
        finally:
            process.kill()


def _give(process: subprocess.Popen[bytes], *things: object) -> None:
    """Write to a process's standard input; that it died already is seen when it is listened to."""
    assert process.stdin is not None
    with suppress(BrokenPipeError), closing(process.stdin) as listens:
        for thing in things:
            listens.write(pickle.dumps(thing))


def _last_words(status: int) -> str:
    """Why a process ended that has not finished its work."""
    if status >= 0:
        return f"its process ended with status {status} before it was done"
    name = signal.Signals(-status).name
    return f"its process was killed ({name}); was that the user, or was memory short?"


def answer_parent() -> None:
    """What the new interpreter runs: the work that it reads, with its answer to the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's, who then ends this
    with os.fdopen(os.dup(1), "wb") as out:
        os.dup2(2, 1)  # what libraries print, in C too, is no answer
        _tell(out, *_outcome(lambda what: _tell(out, "said", what)))


def _outcome(say: Say) -> tuple[str, Any]:
    try:
        return "done", pickle.load(sys.stdin.buffer)(say)
    except TyreFRFError as error:
        return "failed", str(error)
    except MemoryError as error:
        return "failed", f"too little memory: {error}"
    except Exception as error:
        traceback.print_exc()
        return "failed", f"{type(error).__name__}: {error}"


def _tell(out: IO[bytes], kind: str, what: object) -> None:
    out.write(pickle.dumps((kind, what)))
    out.flush()


def peak_memory() -> float:
    """Most memory that this process has had resident so far [bytes]; NaN if nobody counts it.

    On Linux the high-water mark of the process's own memory. Its `ru_maxrss` would not do: that
    outlives exec, so a bare interpreter of 9 MB that a process of 483 MB starts says 483 MB.
    """
    status = Path("/proc/self/status")
    if status.exists():
        facts = dict(row.split(":", 1) for row in status.read_text().splitlines())
        if "VmHWM" in facts:
            return 1024.0 * float(facts["VmHWM"].split()[0])
    try:
        import resource
    except ImportError:  # Windows
        return float("nan")
    unit = 1.0 if sys.platform == "darwin" else 1024.0
    return unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
