"""A rollout that keeps its episodes: which are run, which are reused, and which are kept."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pytest_tarl.errors import RecordingError
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.item_episode import Instruments
from pytest_tarl.resuming.journal import Journal
from pytest_tarl.resuming.kept_rollout import KeptRollout, episode_key, scope_of
from pytest_tarl.rollout import EpisodePlan, EpisodeRun
from pytest_tarl.sensors import Sensor

SCOPE = b"scope"


def trace(reward: float) -> Trace:
    none = np.zeros(0, np.int32)
    return Trace((), none, np.zeros(0), none, none, none, np.array([reward]), {})


@dataclass
class Inner:
    """A rollout whose episodes have the reward `reward`, and what else `changes` says. It counts its episodes."""

    reward: float = 1.0
    changes: dict[str, Any] = field(default_factory=dict)
    ran: list[int] = field(default_factory=list)
    cancels: bool = True
    workers: int = 3

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        return self.begin(plan).result()

    def begin(self, plan: EpisodePlan) -> Any:
        self.ran.append(plan.seed)
        return Done(EpisodeRun(plan, trace(self.reward), **{"passed": True, **self.changes}), self.cancels)


@dataclass
class Done:
    run: EpisodeRun
    cancels: bool
    calls: list[Callable[[EpisodeRun], None]] = field(default_factory=list)

    def result(self) -> EpisodeRun:
        for call in self.calls:
            call(self.run)
        self.calls = []
        return self.run

    def cancel(self) -> bool:
        return self.cancels

    def then(self, call: Callable[[EpisodeRun], None]) -> None:
        self.calls.append(call)


JOURNALS: list[Journal] = []


@pytest.fixture
def path(tmp_path: Path) -> Iterator[Path]:
    yield tmp_path / "a.episodes"
    for journal in JOURNALS:
        journal.close()
    JOURNALS.clear()


def opened(path: Path) -> Journal:
    JOURNALS.append(Journal(path, {}))
    return JOURNALS[-1]


def first_run(path: Path, *seeds: int, **changes: Any) -> None:
    """Keep the episodes of a run with these seeds."""
    journal = opened(path)
    rollout = KeptRollout(Inner(changes=changes), journal, SCOPE, "shown")
    for seed in seeds:
        rollout(EpisodePlan(seed))
    journal.close()


def resumed(path: Path, inner: Inner, scope: bytes = SCOPE, **more: Any) -> KeptRollout:
    journal = opened(path)
    journal.resume()
    return KeptRollout(inner, journal, scope, "shown", **more)


def test_kept_episodes_are_reused_after_the_first_was_repeated(path: Path) -> None:
    first_run(path, 1, 2)
    inner = Inner()
    again = resumed(path, inner)
    runs = [again(EpisodePlan(seed)) for seed in (1, 2, 3)]
    assert inner.ran == [1, 3]
    assert [run.plan.seed for run in runs] == [1, 2, 3]
    assert [run.trace.reward.tolist() for run in runs] == [[1.0]] * 3
    assert again.workers == 3


def test_a_run_that_was_already_checked_repeats_no_episode(path: Path) -> None:
    first_run(path, 1)
    inner = Inner()
    resumed(path, inner, checked=True)(EpisodePlan(1))
    assert inner.ran == []


def test_repeated_episode_is_kept_as_second_run(path: Path) -> None:
    first_run(path, 1)
    inner = Inner()
    again = resumed(path, inner)
    for _ in range(3):
        again(EpisodePlan(1))
    assert inner.ran == [1, 1]  # the check, and the third run of the plan


@pytest.mark.parametrize(("reward", "changes"), [(2.0, {}), (1.0, {"passed": False})])
def test_a_repeated_episode_with_another_result_is_refused(path: Path, reward: float, changes: Any) -> None:
    first_run(path, 7)
    with pytest.raises(RecordingError, match=r"episode with seed 7 now has another result.*delete shown to"):
        resumed(path, Inner(reward, changes))(EpisodePlan(7))


def test_episodes_of_an_external_simulator_are_not_repeated(path: Path) -> None:
    first_run(path, 1, simulator=True)
    inner = Inner(reward=5.0)
    assert resumed(path, inner)(EpisodePlan(1)).trace.reward.tolist() == [1.0]
    assert inner.ran == []


def test_episodes_of_another_scope_or_plan_are_run(path: Path) -> None:
    first_run(path, 1)
    inner = Inner()
    again = resumed(path, inner, b"other")
    again(EpisodePlan(1))
    again(EpisodePlan(1, "mud"))
    assert inner.ran == [1, 1]


@pytest.mark.parametrize(
    "changes",
    [{"broken": "NameError"}, {"stuck": True}, {"older": (Path("node.py"),)}],
)
def test_episodes_that_cannot_be_evaluated_are_not_kept(path: Path, changes: Any) -> None:
    journal = opened(path)
    KeptRollout(Inner(changes=changes), journal, SCOPE, "shown")(EpisodePlan(1))
    assert journal.episodes == 0


def test_failed_episodes_are_kept_for_a_resumed_run(path: Path) -> None:
    journal = opened(path)
    KeptRollout(Inner(changes={"passed": False, "crashed": True}), journal, SCOPE, "shown")(EpisodePlan(1))
    assert journal.episodes == 1


@pytest.mark.parametrize(("cancels", "count"), [(True, 2), (False, 3)])
def test_a_cancelled_episode_does_not_count_as_begun(path: Path, cancels: bool, count: int) -> None:
    """Of three kept runs of a plan, the first is reused by the next request only if its own was cancelled."""
    inner = Inner(cancels=cancels)
    journal = opened(path)
    rollout = KeptRollout(inner, journal, SCOPE, "shown", checked=True)
    assert rollout.begin(EpisodePlan(1)).cancel() is cancels
    journal.keep(episode_key(EpisodePlan(1), SCOPE), _episode())
    rollout(EpisodePlan(1))
    rollout(EpisodePlan(1))
    assert len(inner.ran) == count


def _episode() -> bytes:
    from pytest_tarl.workers.protocol import run_message

    return run_message(EpisodeRun(EpisodePlan(1), trace(1.0), passed=True))


def test_kept_episode_is_returned_immediately(path: Path) -> None:
    first_run(path, 1)
    pending = resumed(path, Inner(), checked=True).begin(EpisodePlan(1))
    heard: list[EpisodeRun] = []
    pending.then(heard.append)
    assert heard == [pending.result()]
    assert pending.cancel() is True


def test_a_new_episode_is_passed_on_when_it_ends(path: Path) -> None:
    pending = KeptRollout(Inner(), opened(path), SCOPE, "shown").begin(EpisodePlan(1))
    heard: list[EpisodeRun] = []
    pending.then(heard.append)
    assert heard == []
    assert [pending.result()] == heard


def test_scope_depends_on_sites_publishers_and_sensors(tmp_path: Path) -> None:
    positions: Any = {tmp_path / "a.py": {(1, 0): 0, (2, 0): 1}}
    base, sensors = Instruments(positions, frozenset({1})), (Sensor("level"),)
    others = [
        scope_of(Instruments({tmp_path / "b.py": positions[tmp_path / "a.py"]}, base.publishes), sensors),
        scope_of(replace(base, positions={tmp_path / "a.py": {(1, 0): 0, (3, 0): 1}}), sensors),
        scope_of(replace(base, publishes=frozenset({0})), sensors),
        scope_of(base, (Sensor("flow"),)),
        scope_of(base, ()),
        scope_of(base, sensors),
    ]
    assert len({*others}) == 6
    assert all(len(one) == 32 for one in others)
    assert (
        len({episode_key(EpisodePlan(seed, drift), SCOPE) for seed in (1, 2) for drift in (None, "a")}) == 4
    )
