"""Run tasks with Dask, in threads of this process or on a cluster.

Tasks are pure functions of their arguments, and results are returned in the order of the tasks, so a result does not
depend on the number of workers. Workers read the files that a task names. If a worker dies, the scheduler runs its
tasks elsewhere. Without a cluster, tasks run in threads, or directly if there is only one worker. Each task uses one
thread for linear algebra: more threads would compete with other tasks and change the order of sums, and with it the
last bits of a result.
"""

from __future__ import annotations

import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from itertools import islice
from typing import Any, Protocol, TypeVar

from threadpoolctl import threadpool_limits

from pytest_tarl.errors import FleetError, SettingsError
from pytest_tarl.extras import install_command

REACHED = 10  # maximum time to wait for the scheduler (s)
RETRIES = 3  # maximum number of retries of a task whose worker dies
AHEAD = 2  # maximum number of waiting and running tasks per cluster thread; limits memory
WINDOW = 8  # number of tasks passed to Dask at a time per thread of this process

Result = TypeVar("Result")


class Engine(Protocol):
    """An engine that runs tasks."""

    def each(self, function: Callable[..., Result], tasks: Iterable[tuple[Any, ...]]) -> Iterator[Result]:
        """Yield the result of a function for each tuple of arguments, in order.

        Raise FleetError if a worker cannot run a task.
        """


@dataclass(frozen=True)
class Local:
    """Dask's scheduler in this process; it limits the number of running tasks, to limit memory."""

    workers: int
    threads: ThreadPoolExecutor | None  # None with one worker

    def each(self, function: Callable[..., Result], tasks: Iterable[tuple[Any, ...]]) -> Iterator[Result]:
        """Yield the results in order."""
        rest = iter(tasks)
        while window := [partial(function, *one) for one in islice(rest, WINDOW * self.workers)]:
            # `partial` hides the arguments from Dask, which would otherwise search them for task names
            yield from self._got({f"tarl-{number}": (one,) for number, one in enumerate(window)})

    def _got(self, graph: dict[str, tuple[Callable[[], Any]]]) -> list[Any]:
        from dask import local, threaded

        names = list(graph)
        if self.threads is None:
            return list(local.get_sync(graph, names))
        return list(threaded.get(graph, names, pool=self.threads, num_workers=self.workers))


@dataclass(frozen=True)
class Cluster:
    """The executor of a Dask cluster, and the cluster's number of threads."""

    executor: Executor
    workers: int

    def each(self, function: Callable[..., Result], tasks: Iterable[tuple[Any, ...]]) -> Iterator[Result]:
        """Yield the results in order, with AHEAD tasks per thread at a time."""
        waiting: deque[Future[Result]] = deque()
        try:
            for one in tasks:
                waiting.append(self._submitted(function, one))
                if len(waiting) >= AHEAD * self.workers:
                    yield _result(waiting.popleft())
            while waiting:
                yield _result(waiting.popleft())
        finally:
            for left in waiting:
                left.cancel()

    def _submitted(self, function: Callable[..., Result], arguments: tuple[Any, ...]) -> Future[Result]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # Dask warns about tasks with large arguments
            return self.executor.submit(_by_one_thread, function, *arguments)


def _by_one_thread(function: Callable[..., Result], *arguments: Any) -> Result:
    """Run a task on a worker of a cluster with one BLAS thread.

    The limit stays in force afterwards, because other threads of the worker may be running tasks.
    """
    threadpool_limits(1, user_api="blas")
    return function(*arguments)


def _result(future: Future[Result]) -> Result:
    try:
        return future.result()
    except CancelledError:
        raise FleetError("The cluster cancelled a task: check the scheduler's log, and run again.") from None
    except Exception as problem:
        if type(problem).__module__.split(".")[0] != "distributed":
            raise
        raise FleetError(
            f"The cluster could not run a task ({problem}): check the workers' logs and memory, and run the command "
            "again."
        ) from problem


@contextmanager
def local(workers: int) -> Iterator[Engine]:
    """Return an engine for this process, with single-threaded linear algebra."""
    with threadpool_limits(1, user_api="blas"):
        if workers == 1:
            yield Local(1, None)
            return
        threads = ThreadPoolExecutor(workers, thread_name_prefix="tarl-fleet")
        try:
            yield Local(workers, threads)
        finally:
            threads.shutdown(wait=True, cancel_futures=True)


@contextmanager
def cluster(address: str) -> Iterator[Engine]:
    """Run tasks on the workers of a Dask cluster that has the same version of tarl.

    Raise SettingsError if no scheduler answers, or if it has no workers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise SettingsError(f"--cluster needs Dask: run {install_command('cluster')}.") from None
    try:
        client = Client(address, timeout=REACHED, set_as_default=False)
    except (OSError, ValueError) as problem:
        raise SettingsError(
            f"--cluster: no Dask scheduler answers at {address} ({problem}). Start one with `dask scheduler`, and give "
            "its address, such as tcp://192.0.2.1:8786."
        ) from None
    with client, threadpool_limits(1, user_api="blas"):
        workers = sum(client.nthreads().values())
        if not workers:
            raise SettingsError(
                f"--cluster: the scheduler at {address} has no workers; start some: dask worker {address}."
            )
        executor = client.get_executor(retries=RETRIES, pure=False)
        try:
            yield Cluster(executor, workers)
        finally:
            with suppress(OSError, TimeoutError):
                executor.shutdown(wait=False)
