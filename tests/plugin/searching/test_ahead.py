"""Searches with workers have the same history as without, and keep the workers busy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.rollout import Ahead
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.halving import Halving
from pytest_tarl.searching.ranking import Ranking
from pytest_tarl.searching.search import Candidate, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.seeds import generator
from tests.plugin.searching.test_search import GOAL, OPERANDS, operand, run

MANY = (*OPERANDS, *(operand(line, f"{line}.0", float(line)) for line in range(10, 55)))


def sweep(trials: Trials) -> None:
    next(Sweep(MANY[:20], mutations, (ALWAYS,), trials, GOAL).candidates())


def screening(trials: Trials) -> None:
    next(Sweep(MANY, mutations, (ALWAYS,), trials, GOAL, generator(0, "sweep")).candidates())


def halving(trials: Trials) -> None:
    next(Halving(MANY[:20], mutations, (ALWAYS,), trials, GOAL).candidates())


def ranking(trials: Trials) -> None:
    Ranking(MANY[:20], mutations, ALWAYS, trials, GOAL).run()


@dataclass
class FakeExecutor:
    """Workers that run an announced episode at once and return it on request."""

    workers: int
    waiting: int = 0
    most: int = 0
    begun: list[Any] = field(default_factory=list)

    def begin(self, plan: Any) -> Any:
        self.begun.append(plan)
        self.waiting += 1
        self.most = max(self.most, self.waiting)
        outcome = run(plan.candidate, plan.seed)

        def result() -> Any:
            self.waiting -= 1
            return outcome

        return SimpleNamespace(result=result, cancel=result)


def history(search: Callable[[Trials], None], workers: int) -> tuple[list[float], list[str], FakeExecutor]:
    executor = FakeExecutor(workers)
    ahead: Any = Ahead(executor)  # type: ignore[arg-type]

    def plan(candidate: Candidate, seed: int) -> Any:
        return (candidate, seed), SimpleNamespace(candidate=candidate, seed=seed)

    trials = Trials(
        lambda candidate, seed: ahead(*plan(candidate, seed)),
        300,
        foresee=lambda wanted: ahead.foresee(plan(*one) for one in wanted),
    )
    search(trials)
    return trials.totals, trials.labels, executor


@pytest.mark.parametrize("search", [sweep, screening, halving, ranking])
def test_history_does_not_depend_on_workers(search: Callable[[Trials], None]) -> None:
    totals, labels, alone = history(search, 1)
    assert len(alone.begun) == len(totals)
    assert alone.most == 1
    for workers in (2, 7):
        again, named, executor = history(search, workers)
        assert (again, named) == (totals, labels)
        assert executor.most > workers  # each worker can run an episode while one result is used
