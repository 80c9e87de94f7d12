"""The cores of this machine: this process, or clean interpreters that joblib's loky starts."""

from __future__ import annotations

import os
import queue
import re
import signal
import tempfile
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from functools import lru_cache, partial, wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar
from uuid import uuid4

from tyrefrf.errors import SolveError

P = ParamSpec("P")
Result = TypeVar("Result")

Make = Callable[[], Callable[[Any], Any]]
"""Makes a function in the process that is to call it; may be sent there."""

KEPT = 2
"""Functions that a process keeps, with their solvers: one that ends, one that begins."""

IDLE = 300.0  # seconds after which an idle process ends
SECONDS_ORPHANED = 1.0  # that a process works on whose parent was killed

HANDLES, HANDLES_PER_JOB = 20, 2
"""Open files of a pool of processes and of each of them, with some to spare: measured 7 and 1 while
they work, and two more as one starts."""

ONE_THREAD = dict.fromkeys(
    ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"), "1"
)


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def pinned(function: Callable[P, Result]) -> Callable[P, Result]:
    """The function, run with one BLAS thread: more only get in each other's way here."""

    @wraps(function)
    def with_one_thread(*args: P.args, **kwargs: P.kwargs) -> Result:
        from threadpoolctl import threadpool_limits

        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return with_one_thread


class Here:
    """No other process: a task is done where it is submitted."""

    jobs = here = 1

    def __init__(self) -> None:
        self._made = lru_cache(maxsize=KEPT)(_made_by)

    def submit(self, make: Make, item: Any) -> Future[Any]:
        """Done when this returns."""
        future: Future[Any] = Future()
        future.set_result(self._made(make)(item))
        return future

    def look(self) -> None:
        """Nobody is looked for."""

    def death(self, done: Future[Any]) -> str:
        """It would be everybody's."""
        return ""

    def stop(self) -> None:
        """Nothing is under way."""


def _made_by(make: Make) -> Callable[[Any], Any]:
    return make()


@lru_cache(maxsize=1)
def local(jobs: int) -> Local:
    """So many processes; those that there are, for whoever wants as many next."""
    return Local(jobs)


class Local:
    """Processes of this machine; they start, and import what is needed, as this is made.

    A pool of its own: the one that joblib and its users share would fail them once it has been
    asked for by `get_reusable_executor` (joblib 1.6: no attribute '_temp_folder_manager').
    """

    def __init__(self, jobs: int) -> None:
        """Raises SolveError where the system allows too few open files for them."""
        check_handles(jobs)
        self.jobs = jobs
        self._files: weakref.WeakKeyDictionary[Make, Path] = weakref.WeakKeyDictionary()
        self._processes: Any = None
        self._submit(_nothing)

    @property
    def here(self) -> int:
        """All of them."""
        return self.jobs

    def submit(self, make: Make, item: Any) -> Future[Any]:
        """In the first process that is free."""
        return self._submit(_call, self._file(make), item)

    def _submit(self, *work: Any) -> Future[Any]:
        """To the processes that there are, or to new ones where one has died."""
        with _deaf():
            if self._processes is not None:
                with suppress(BrokenProcessPool):
                    return self._processes.submit(*work)
            self._processes = _processes(self.jobs)
            return self._processes.submit(*work)

    def _file(self, make: Make) -> Path:
        """What `make` needs, written once; there for as long as somebody may want to call it."""
        if make not in self._files:
            import joblib

            path = _temporary_directory() / f"tyrefrf-{uuid4().hex}"
            _removed_in_any_case(path)
            weakref.finalize(make, _remove, path)
            try:
                joblib.dump(make, path)
            except OSError as error:
                raise _without_room(
                    f"{path}, for the processes, cannot be written", error
                ) from error
            self._files[make] = path
        return self._files[make]

    def look(self) -> None:
        """A process that dies breaks the pool, and who waits is told."""

    def death(self, done: Future[Any]) -> str:
        """The pool says that some process died, not whose."""
        error = done.exception()
        if not isinstance(error, BrokenProcessPool):
            return ""
        how = re.search(r"\{(.+)\}", str(error))
        how_many = "its worker process died twice"
        return f"{how_many} ({how[1] if how else error}): killed, or out of memory?"

    def stop(self) -> None:
        """The processes are killed; new ones come where there is more to do."""
        if self._processes is not None:
            _forget_waiting(self._processes)
            self._processes.shutdown(kill_workers=True)
            self._processes = None


@contextmanager
def _deaf() -> Iterator[None]:
    """Processes that start meanwhile do not hear the signals that end this one, who ends them.

    Nor does this one, until afterwards. A group of processes gets signals together: Ctrl-C, and
    the end of a terminal.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(
        signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
    )
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def check_handles(jobs: int) -> None:
    """Raise SolveError where so many processes need more open files than are allowed.

    Short of them, loky fails in ways of its own (joblib 1.6).
    """
    try:
        import resource
    except ImportError:  # Windows has no such limit
        return
    allowed, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    needed = len(list(Path("/dev/fd").iterdir())) + HANDLES + HANDLES_PER_JOB * jobs
    if allowed != resource.RLIM_INFINITY and needed > allowed:
        raise SolveError(
            f"{jobs} processes need {needed} open files, and {allowed} are allowed: raise that "
            "(ulimit -n), or use fewer --jobs; one needs none of its own"
        )


def _processes(jobs: int) -> Any:
    from joblib.externals.loky import ProcessPoolExecutor

    begin = partial(_begin, os.getpid())
    return ProcessPoolExecutor(jobs, timeout=IDLE, initializer=begin, env=ONE_THREAD)


def _forget_waiting(processes: Any) -> None:
    """Take back the tasks that no process has begun, before the processes are killed.

    Loky throws them away, then looks for them, and its thread dies of a KeyError that is printed
    (joblib 1.6).
    """
    with suppress(queue.Empty):
        while True:
            processes._work_ids.get_nowait()


def _begin(parent: int) -> None:
    """What a new process does first: import all that computes, beside the one that wants it.

    What it keeps would be taken for a leak by loky, which ends a process that has grown by 300 MB
    since its first task; without that it collects garbage every second, for which all that has
    been imported need not be looked through.
    """
    import gc

    for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # the parent's, who keeps what there is, and
        if hasattr(signal, name):  # then ends this; a group of processes gets them too
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()
    from joblib.externals.loky import process_executor

    import tyrefrf.study.spectrum  # noqa: F401

    process_executor._USE_PSUTIL = False
    one_blas_thread()
    gc.freeze()


def _end_with(parent: int) -> None:
    """End this process when the one that started it is there no more: nobody else would."""
    while os.getppid() == parent:
        time.sleep(SECONDS_ORPHANED)
    os._exit(1)


def one_blas_thread() -> None:
    """Limit this process, for good."""
    from threadpoolctl import threadpool_limits

    threadpool_limits(limits=1, user_api="blas")


def _nothing() -> None:
    """The first task, for which the processes are started."""


def _call(path: Path, item: Any) -> Any:
    """What a process does."""
    return _kept.made(path)(item)


def _read(path: Path) -> Callable[[Any], Any]:
    """The function; its arrays are those of the file, read-only, and shared by all who read."""
    import joblib

    return joblib.load(path, mmap_mode="r")()


class _Kept(threading.local):
    """What a thread has made."""

    def __init__(self) -> None:
        self.made = lru_cache(maxsize=KEPT)(_read)


_kept = _Kept()


def _temporary_directory() -> Path:
    try:
        return Path(tempfile.gettempdir())
    except OSError as error:
        raise _without_room("no directory for what processes share", error) from error


def _without_room(what: str, error: OSError) -> SolveError:
    return SolveError(
        f"{what}: {error.strerror or error}; TMPDIR names another directory, and --jobs 1 does "
        "without"
    )


def _removed_in_any_case(path: Path) -> None:
    """Have loky's tracker, which outlives this process, remove a file if this process is killed."""
    from joblib.externals.loky.backend import resource_tracker

    resource_tracker.register(str(path), "file")


def _remove(path: Path) -> None:
    from joblib.externals.loky.backend import resource_tracker

    with suppress(OSError):  # Windows keeps what is mapped
        path.unlink(missing_ok=True)
        resource_tracker.unregister(str(path), "file")
