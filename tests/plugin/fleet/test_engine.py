"""Tasks run in order and a limited number at a time; each uses one thread for its linear algebra."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

pytest.importorskip("dask")

import numpy as np
from threadpoolctl import threadpool_info, threadpool_limits

from pytest_tarl.fleet import engine


def linear_algebra_threads() -> set[int]:
    """Return the numbers of threads that the linear algebra libraries currently use."""
    assert np.eye(2).shape == (2, 2)  # numpy loads a linear algebra library
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}


@pytest.mark.parametrize("workers", [1, 2, 7])
def test_linear_algebra_uses_one_thread_so_that_sums_keep_their_order(workers: int) -> None:
    with threadpool_limits(2, user_api="blas"):
        before = linear_algebra_threads()
        with engine.local(workers) as some:
            assert linear_algebra_threads() == {1}
            assert list(some.each(linear_algebra_threads, [()] * 10)) == [{1}] * 10
        assert linear_algebra_threads() == before


def test_a_cluster_task_uses_one_thread_for_linear_algebra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "2")
    with ProcessPoolExecutor(1, get_context("spawn")) as worker:
        assert list(engine.Cluster(worker, 1).each(linear_algebra_threads, [()])) == [{1}]


@pytest.mark.parametrize("workers", [1, 2, 7])
def test_a_limited_number_of_tasks_runs_at_a_time_and_results_keep_their_order(workers: int) -> None:
    ran: list[int] = []

    def tasks() -> Iterator[tuple[int]]:
        yield from ((number,) for number in range(100))

    def squared(number: int) -> int:
        ran.append(number)
        return number**2

    with engine.local(workers) as some:
        assert list(some.each(squared, tasks())) == [number**2 for number in range(100)]
        ran.clear()
        results = some.each(squared, tasks())
        next(results)
        results.close()  # type: ignore[attr-defined]
    assert 1 <= len(ran) <= engine.WINDOW * workers


@pytest.mark.parametrize(("workers", "threaded"), [(1, False), (2, True), (7, True)])
def test_several_workers_are_threads_and_one_worker_is_the_process_itself(
    workers: int, threaded: bool
) -> None:
    with engine.local(workers) as some:
        names = set(some.each(lambda: threading.current_thread().name, [()] * 20))
    assert some.workers == workers
    if threaded:
        assert {name.rpartition("_")[0] for name in names} == {"tarl-fleet"}
    else:
        assert names == {threading.current_thread().name}


def test_an_argument_that_equals_a_key_of_the_task_graph_is_passed_on_unchanged() -> None:
    odd = ["tarl-0", ("tarl-1", len), [print, ("tarl-0",)], {"tarl-0": 1}]
    with engine.local(1) as some:
        assert list(some.each(lambda one: one, ((one,) for one in odd))) == odd
