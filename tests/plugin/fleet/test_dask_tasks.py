"""Tasks run in order and a limited number at a time; each uses one thread for its linear algebra."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import pytest

pytest.importorskip("dask")

import numpy as np
from threadpoolctl import threadpool_info, threadpool_limits

from pytest_tarl.errors import FleetError
from pytest_tarl.fleet import dask_tasks


def linear_algebra_threads() -> set[int]:
    """Return the numbers of threads that the linear algebra libraries currently use."""
    assert np.eye(2).shape == (2, 2)  # numpy loads a linear algebra library
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}


@pytest.mark.parametrize("workers", [1, 2, 7])
def test_linear_algebra_uses_one_thread(workers: int) -> None:
    with threadpool_limits(2, user_api="blas"):
        before = linear_algebra_threads()
        with dask_tasks.local(workers) as some:
            assert linear_algebra_threads() == {1}
            assert list(some.each(linear_algebra_threads, [()] * 10)) == [{1}] * 10
        assert linear_algebra_threads() == before


def test_a_cluster_task_uses_one_thread_for_linear_algebra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "2")
    with ProcessPoolExecutor(1, get_context("spawn")) as worker:
        assert list(dask_tasks.Cluster(worker, 1).each(linear_algebra_threads, [()])) == [{1}]


@pytest.mark.parametrize("workers", [1, 2, 7])
def test_limited_tasks_run_at_a_time_in_order(workers: int) -> None:
    ran: list[int] = []

    def tasks() -> Iterator[tuple[int]]:
        yield from ((number,) for number in range(100))

    def squared(number: int) -> int:
        ran.append(number)
        return number**2

    with dask_tasks.local(workers) as some:
        assert list(some.each(squared, tasks())) == [number**2 for number in range(100)]
        ran.clear()
        results = some.each(squared, tasks())
        next(results)
        results.close()  # type: ignore[attr-defined]
    assert 1 <= len(ran) <= dask_tasks.WINDOW * workers


@pytest.mark.parametrize(("workers", "threaded"), [(1, False), (2, True), (7, True)])
def test_single_worker_is_the_process_itself(workers: int, threaded: bool) -> None:
    with dask_tasks.local(workers) as some:
        names = set(some.each(lambda: threading.current_thread().name, [()] * 20))
    assert some.workers == workers
    if threaded:
        assert {name.rpartition("_")[0] for name in names} == {"tarl-fleet"}
    else:
        assert names == {threading.current_thread().name}


class Executor:
    """Runs a task when its result is needed; warns about each argument, as Dask does about large ones."""

    def __init__(self) -> None:
        self.submitted: list[Future[Any]] = []

    def submit(self, function: Any, *arguments: Any) -> Any:
        warnings.warn("large argument", UserWarning, stacklevel=1)
        future = Future[Any]()
        future.result = lambda timeout=None: function(*arguments)  # type: ignore[method-assign]
        self.submitted.append(future)
        return future


def test_two_tasks_per_thread_wait_on_a_cluster(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    executor: Any = Executor()
    limits: list[int] = []
    monkeypatch.setattr(dask_tasks, "threadpool_limits", lambda limit, user_api: limits.append(limit))
    results = dask_tasks.Cluster(executor, 3).each(lambda a, b: a - b, ((n, 1) for n in range(20)))
    assert [next(results), next(results)] == [-1, 0]
    assert (len(executor.submitted), limits) == (dask_tasks.AHEAD * 3 + 1, [1, 1])
    results.close()  # type: ignore[attr-defined]
    assert [one.cancelled() for one in executor.submitted] == [False] * 2 + [True] * (
        dask_tasks.AHEAD * 3 - 1
    )
    every = dask_tasks.Cluster(Executor(), 3).each(lambda a, b: a - b, ((n, 1) for n in range(20)))  # type: ignore[arg-type]
    assert list(every) == list(range(-1, 19))


def test_cluster_errors_differ_from_task_errors() -> None:
    def failing(problem: BaseException) -> Future[None]:
        future = Future[None]()
        future.set_exception(problem)
        return future

    lost = type("KilledWorker", (Exception,), {"__module__": "distributed.scheduler"})("worker died")
    with pytest.raises(FleetError, match=r"could not run a task \(worker died\)"):
        dask_tasks._result(failing(lost))
    with pytest.raises(ValueError, match="own"):
        dask_tasks._result(failing(ValueError("own")))
    cancelled = Future[None]()
    cancelled.cancel()
    with pytest.raises(FleetError, match="cancelled a task"):
        dask_tasks._result(cancelled)


def test_argument_equal_to_a_graph_key_is_unchanged() -> None:
    odd = ["tarl-0", ("tarl-1", len), [print, ("tarl-0",)], {"tarl-0": 1}]
    with dask_tasks.local(1) as some:
        assert list(some.each(lambda one: one, ((one,) for one in odd))) == odd
