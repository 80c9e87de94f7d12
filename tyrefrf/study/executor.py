"""Work spread over processes: one interface, results as they come, death survived."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass
from itertools import islice
from typing import Any, Generic, Protocol, TypeVar

from tyrefrf.study.local import Here, Make, local

Item = TypeVar("Item")
Result = TypeVar("Result")

AHEAD = 2  # tasks submitted per job: nobody waits for the next one, and memory is bounded
SECONDS_BETWEEN_LOOKS = 5.0  # at whether there is still anybody at work


class Executor(Protocol):
    """Processes that work: of this machine (`Here`, `Local`), or of a cluster (`Cluster`)."""

    @property
    def jobs(self) -> int:
        """Tasks that are worked at at the same time."""
        ...

    @property
    def here(self) -> int:
        """How many of them on this machine, sharing its memory."""
        ...

    def submit(self, make: Make, item: Any) -> Future[Any]:
        """make()(item), some time, in some process, with one BLAS thread."""
        ...

    def look(self) -> None:
        """Called now and then; where nobody is left to work, what was submitted is cancelled."""
        ...

    def death(self, done: Future[Any]) -> str:
        """Why a task's process died, for good; "" where it has an answer, or an error."""
        ...

    def stop(self) -> None:
        """Nobody waits any more for what was submitted."""
        ...


Workers = int | Executor
"""Processes of this machine, by their number, or an executor."""


@dataclass(frozen=True, slots=True, eq=False)
class Task(Generic[Item, Result]):
    """make()(item). A process gets `make` and calls it once, and keeps what it gives."""

    make: Callable[[], Callable[[Item], Result]]
    item: Item


Lost = Callable[[Task[Item, Result], str], Result]
"""What stands for the result of a task that kills its process, and why."""

Parts = Callable[[Task[Item, Result]], Sequence[Task[Item, Result]]]
"""The pieces in which a task is tried again."""


def _whole(task: Task[Item, Result]) -> Sequence[Task[Item, Result]]:
    return [task]


def map_unordered(
    tasks: Iterable[Task[Item, Result]],
    workers: Workers,
    lost: Lost[Item, Result],
    parts: Parts[Item, Result] = _whole,
) -> Iterator[Result]:
    """Yield the results of all tasks in the order of completion.

    Tasks are taken as they are needed; those of one `make` stand best together. Every process uses
    one BLAS thread, this one included, so that results do not depend on the workers. An error that
    a task raises ends the work. What was in a process that died, or waited for it, is tried
    once more at the end, by its parts, each alone; what then kills its process again gives
    lost(part, reason).
    """
    from threadpoolctl import threadpool_limits

    executor = executor_of(workers)
    suspects: list[Task[Item, Result]] = []
    try:
        with threadpool_limits(limits=1, user_api="blas"):
            for task, done in _finished(tasks, executor, AHEAD):
                if executor.death(done):
                    suspects.append(task)
                else:
                    yield done.result()
            again = (part for task in suspects for part in parts(task))
            for task, done in _finished(again, executor, 0):
                reason = executor.death(done)
                yield lost(task, reason) if reason else done.result()
    except BaseException:  # an error, Ctrl-C, or results that nobody wants: work is under way
        executor.stop()
        raise


def _finished(
    tasks: Iterable[Task[Item, Result]], executor: Executor, ahead: int
) -> Iterator[tuple[Task[Item, Result], Future[Result]]]:
    """Tasks that are done with, well or not; so many per job are submitted, or one alone."""
    left = iter(tasks)
    waiting: dict[Future[Result], Task[Item, Result]] = {}
    while True:
        most = max(1, ahead * executor.jobs) if executor.jobs > 1 else 1
        for task in islice(left, max(0, most - len(waiting))):  # a cluster may shrink
            waiting[executor.submit(task.make, task.item)] = task
        if not waiting:
            return
        finished, _ = wait(waiting, SECONDS_BETWEEN_LOOKS, FIRST_COMPLETED)
        executor.look()
        for done in finished:
            yield waiting.pop(done), done


def executor_of(workers: Workers, n_tasks: int = 2) -> Executor:
    """The executor, or so many processes of this machine, which start now.

    A single task is done in this process.
    """
    if not isinstance(workers, int):
        return workers
    return local(workers) if workers > 1 and n_tasks > 1 else Here()
