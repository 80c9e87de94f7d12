"""Work spread over the cores: one interface, results as they come."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from tyrefrf.errors import SolveError

Item = TypeVar("Item")
Result = TypeVar("Result")


def map_unordered(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int
) -> Iterator[Result]:
    """Yield function(item) of every item in the order of completion.

    jobs: processes; 1 works here and now, without any. Every process uses one BLAS thread, this
    one included, so that results do not depend on the number of jobs.
    Raises SolveError if a process dies, killed or out of memory.
    """
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1, user_api="blas"):
        if jobs == 1 or len(items) == 1:
            yield from map(function, items)
            return
        yield from _map_loky(function, items, jobs)


def _map_loky(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int
) -> Iterator[Result]:
    """The same in joblib's loky processes, which are clean interpreters."""
    from concurrent.futures.process import BrokenProcessPool

    from joblib import Parallel, delayed, parallel_config

    with parallel_config(backend="loky", inner_max_num_threads=1):
        parallel = Parallel(n_jobs=jobs, return_as="generator_unordered", pre_dispatch="2*n_jobs")
        try:
            yield from parallel(delayed(function)(item) for item in items)
        except BrokenProcessPool as error:
            raise SolveError(
                f"a worker process died ({error}); was it killed, or out of memory? "
                "--jobs 1 works in one process"
            ) from error
