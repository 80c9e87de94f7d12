"""More than one machine: the workers of a dask scheduler, by its own futures.

joblib's dask backend would be less code, but waits for ever when a worker is killed. What a
process needs of a problem goes to the cluster as the result of a task, not scattered: scattered
data dies with the workers that hold it, a task is done again.
"""

from __future__ import annotations

import platform
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, InvalidStateError
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import lru_cache, partial
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from tyrefrf.errors import CommandError
from tyrefrf.study.local import KEPT, Make, one_blas_thread

if TYPE_CHECKING:
    from distributed import Client

ANSWER_WITHIN = 10.0  # seconds, for a scheduler, and for its first worker
WORKERS_BACK_WITHIN = 300.0  # seconds without any worker until what is left is given up
SECONDS_BETWEEN_COUNTS = 2.0  # of the workers: a cluster may grow and shrink
SAME = ("tyrefrf", "numpy", "scipy")  # packages whose versions decide results


@contextmanager
def cluster(address: str) -> Iterator[Cluster]:
    """The workers of the scheduler at an address (``tcp://host:8786``), or of its file.

    For `jobs` of `run`, `sweep` and `dispersion`. Raises CommandError if there is nobody, or
    somebody with other versions of what computes.
    """
    with _client(address) as client:
        try:
            client.wait_for_workers(1, timeout=ANSWER_WITHIN)
        except TimeoutError:
            raise CommandError(
                f"the scheduler at {address} has no worker; start some first "
                "(dask worker ADDRESS), then repeat the command"
            ) from None
        _check_versions(client, address)
        yield Cluster(client, address)


@contextmanager
def _client(address: str) -> Iterator[Client]:
    """A client of the scheduler, which ends with the context."""
    try:
        from distributed import Client
    except ImportError as error:
        raise CommandError(
            f'--scheduler needs dask.distributed ({error}): pip install "tyrefrf[cluster]"'
        ) from None

    where: dict[str, Any] = {"address": address}
    if Path(address).is_file():
        where = {"scheduler_file": address}
    elif "://" not in address and ("/" in address or address.endswith(".json")):
        raise CommandError(f"no scheduler file {address}; start the scheduler first")
    try:
        client = Client(**where, timeout=ANSWER_WITHIN, set_as_default=False, name="tyrefrf")
    except (OSError, ValueError) as error:  # TimeoutError is an OSError
        raise CommandError(
            f"no scheduler answers at {address} within {ANSWER_WITHIN:g} s "
            f"({str(error) or type(error).__name__}); give what `dask scheduler` says it "
            "listens at, such as tcp://host:8786"
        ) from None
    with client:
        yield client


def _check_versions(client: Client, address: str) -> None:
    """Raise CommandError where results could differ from worker to worker, naming the workers.

    The scheduler needs the packages too: it unpickles what it passes on.
    """
    wrong = _differing(
        _everywhere(client, platform.python_version), "Python", platform.python_version()
    )
    for name in SAME:
        wrong += _differing(_everywhere(client, version, name), name, version(name))
    if wrong:
        head = f"the cluster at {address} has other packages than this process:"
        raise CommandError("\n".join([head, *wrong, "install the same versions there"]))


def _everywhere(client: Client, function: Callable[..., str], *arguments: str) -> dict[str, Any]:
    """What a function says, or the exception that it raises, on the scheduler and every worker."""
    try:
        found = {"scheduler": client.run_on_scheduler(function, *arguments)}
    except Exception as error:
        found = {"scheduler": error}
    return found | client.run(function, *arguments, on_error="return")


def _differing(found: dict[str, Any], name: str, own: str) -> list[str]:
    """A line for every version that is not this process's, with the workers that have it."""
    has = {
        worker: f"no {name}" if isinstance(there, Exception) else f"{name} {there}"
        for worker, there in found.items()
    }
    others = sorted(set(has.values()) - {f"{name} {own}"})
    return [
        f"  {other}, here {own}: {', '.join(w for w, what in has.items() if what == other)}"
        for other in others
    ]


@dataclass(frozen=True, slots=True)
class Sent:
    """A maker, known by its token: a worker that fetches it again keeps what the first made."""

    token: str
    make: Make = field(compare=False)


class Cluster:
    """An executor of a scheduler's workers."""

    here = 0  # on this machine are, if any, workers of their own right

    def __init__(self, client: Client, address: str) -> None:
        self._client, self.address = client, address
        self._seen = self._counted = time.monotonic()
        self._n_threads = self._count()
        self._given_up = ""
        self._under_way: dict[Future[Any], Any] = {}
        self._tokens: weakref.WeakKeyDictionary[Make, str] = weakref.WeakKeyDictionary()
        self._last: tuple[Any, Any] = (None, None)  # a maker, and what holds it on the cluster

    @property
    def jobs(self) -> int:
        """Threads of all workers, at the last count."""
        return max(1, self._n_threads)

    def submit(self, make: Make, item: Any) -> Future[Any]:
        """On any worker; the maker is sent where it is not the one that was sent last."""
        if self._given_up or self._client.status != "running":
            return _cancelled(Future())
        if self._last[0] is not make:
            sent = Sent(self._tokens.setdefault(make, uuid4().hex), make)
            self._last = make, self._client.submit(_itself, sent, pure=False)
        here: Future[Any] = Future()
        self._under_way[here] = there = self._client.submit(_call, self._last[1], item, pure=False)
        there.add_done_callback(partial(self._answered, here))
        return here

    def _answered(self, here: Future[Any], there: Any) -> None:
        """Fetch the answer; distributed's own executor forgets those that fail to be fetched."""
        with suppress(InvalidStateError):  # given up meanwhile
            try:
                here.set_result(there.result())
            except CancelledError:
                _cancelled(here)
            except Exception as error:
                here.set_exception(error)
        self._under_way.pop(here, None)

    def look(self) -> None:
        """Count the workers, and give up where none has been there for long."""
        now = time.monotonic()
        if now - self._counted < SECONDS_BETWEEN_COUNTS:
            return
        self._counted, self._n_threads = now, self._count()
        if self._n_threads or not self._under_way:
            self._seen = now
        elif now - self._seen > WORKERS_BACK_WITHIN:
            self._given_up = f"no worker was left at {self.address} for {now - self._seen:.0f} s"
            self.stop()

    def _count(self) -> int:
        """Threads of all workers, as far as can be known."""
        if self._client.status == "running":
            with suppress(OSError):  # the line to the scheduler is broken
                return sum(self._client.nthreads().values())
        return 0

    def death(self, done: Future[Any]) -> str:
        """A worker's death is tried on others by the scheduler, until it says KilledWorker."""
        from distributed.scheduler import KilledWorker

        if done.cancelled():
            gone = self._client.status != "running"
            how = "has gone" if gone else "has cancelled it"
            return self._given_up or f"the scheduler at {self.address} {how}"
        error = done.exception()
        if isinstance(error, KilledWorker):
            return (
                f"KilledWorker: {error.allowed_failures + 1} workers died of it, twice, the last "
                f"at {error.last_worker.address}: killed, or out of memory?"
            )
        return ""

    def stop(self) -> None:
        """What is under way is cancelled."""
        for here, there in list(self._under_way.items()):
            there.cancel()
            _cancelled(here)


def _cancelled(future: Future[Any]) -> Future[Any]:
    """The future without a chance; who waits for it is told."""
    if not future.cancelled() and future.cancel():
        future.set_running_or_notify_cancel()
    return future


def _itself(sent: Sent) -> Sent:
    """The task whose result is the maker."""
    return sent


def _call(sent: Sent, item: Any) -> Any:
    """What a worker does."""
    return _kept.made(sent)(item)


def _make(sent: Sent) -> Callable[[Any], Any]:
    made = sent.make()
    one_blas_thread()  # of the libraries that this has loaded
    return made


class _Kept(threading.local):
    """What a thread has made."""

    def __init__(self) -> None:
        self.made = lru_cache(maxsize=KEPT)(_make)


_kept = _Kept()
