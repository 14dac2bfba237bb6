"""Starting episodes ahead of their request does not change the results, and is limited in number."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import pytest

from pytest_tarl.rollout import AHEAD, KEPT, Ahead, Deferred, EpisodePlan, in_order


@dataclass
class Answer:
    """An episode whose result is its seed."""

    executor: FakeExecutor
    seed: int

    def result(self) -> Any:
        return self.seed

    def cancel(self) -> bool:
        self.executor.cancelled.append(self.seed)
        return True


@dataclass
class FakeExecutor:
    """An executor that stores which episodes were started and cancelled."""

    workers: int
    begun: list[int] = field(default_factory=list)
    cancelled: list[int] = field(default_factory=list)

    def begin(self, plan: EpisodePlan) -> Any:
        self.begun.append(plan.seed)
        return Answer(self, plan.seed)

    def __call__(self, plan: EpisodePlan) -> Any:
        return self.begin(plan).result()


def plans(*seeds: int) -> Iterator[tuple[int, EpisodePlan]]:
    return ((seed, EpisodePlan(seed)) for seed in seeds)


@pytest.mark.parametrize("workers", [1, 2, 5])
def test_results_ignore_episodes_started_ahead(workers: int) -> None:
    ahead: Any = Ahead(FakeExecutor(workers))
    got = []
    for seed in (3, 1, 4, 1, 5):
        ahead.foresee(plans(9, seed, 2, 6))
        got.append(ahead(seed, EpisodePlan(seed)))
    assert got == [3, 1, 4, 1, 5]


def test_one_worker_starts_no_episode_ahead() -> None:
    executor = FakeExecutor(1)
    ahead: Any = Ahead(executor)
    ahead.foresee(plans(1, 2, 3))
    assert executor.begun == []
    ahead(2, EpisodePlan(2))
    assert executor.begun == [2]


def test_started_episodes_keep_workers_busy() -> None:
    executor = FakeExecutor(2)
    ahead: Any = Ahead(executor)
    ahead.foresee(plans(*range(20)))
    assert executor.begun == list(range(AHEAD * 2))
    for seed in range(3):
        ahead(seed, EpisodePlan(seed))
    assert executor.begun == list(range(AHEAD * 2 + 3))


def test_unrequested_runs_are_cancelled() -> None:
    executor = FakeExecutor(2)
    ahead: Any = Ahead(executor)
    ahead.foresee(plans(1, 2, 3))
    ahead.foresee(plans(11, 12))
    ahead(11, EpisodePlan(11))
    ahead(1, EpisodePlan(1))
    assert executor.begun.count(1) == 1
    for start in range(100, 400, 10):
        ahead.foresee(plans(*range(start, start + 4)))
    assert {2, 3, 12} <= set(executor.cancelled)
    assert len(executor.begun) - len(executor.cancelled) <= KEPT * 2 + 2


@pytest.mark.parametrize(("workers", "ahead"), [(1, 0), (2, 4), (3, 6)])
def test_episodes_are_yielded_in_order(workers: int, ahead: int) -> None:
    executor: Any = FakeExecutor(workers)
    found: Any = in_order(executor, (EpisodePlan(seed) for seed in range(10)))
    assert executor.begun == []
    assert next(found).result() == 0
    assert executor.begun == list(range(1 + ahead))
    assert [one.result() for one in found] == [*range(1, 10)]
    assert (executor.begun, executor.cancelled) == ([*range(10)], [])


def test_episodes_that_were_begun_and_not_yielded_are_cancelled() -> None:
    executor: Any = FakeExecutor(2)
    found: Any = in_order(executor, (EpisodePlan(seed) for seed in range(10)))
    next(found)
    next(found)
    found.close()
    assert executor.begun == [0, 1, 2, 3, 4, 5]
    assert executor.cancelled == [2, 3, 4, 5]


def test_a_deferred_episode_runs_when_its_result_is_requested() -> None:
    executor: Any = FakeExecutor(1)
    one: Any = Deferred(executor, EpisodePlan(7))
    told: list[Any] = []
    one.then(told.append)
    one.then(told.append)
    assert executor.begun == []
    assert one.result() == 7
    assert (executor.begun, told) == ([7], [7, 7])
    assert one.cancel() is True


def test_started_episode_runs_once() -> None:
    executor = FakeExecutor(2)
    ahead: Any = Ahead(executor)
    ahead.foresee(plans(1, 1, 2))
    assert executor.begun == [1, 2]
    assert ahead(1, EpisodePlan(1)) == 1
    assert executor.begun == [1, 2]
    assert ahead(5, EpisodePlan(5)) == 5
    assert executor.begun == [1, 2, 5]
    assert executor.cancelled == []
