"""The parts of a recording: its episodes, notes and summary, and why it is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.errors import FixtureError, RecordingError
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning import fixture
from pytest_tarl.recording import (
    NOT_REPRODUCIBLE,
    PILOTS,
    Recorded,
    _previous,
    _refused,
    _silent_lists,
    _summary,
    identical,
    read_values,
    repeated,
    run_episodes,
    sound,
)
from pytest_tarl.rollout import EpisodePlan, EpisodeRun
from pytest_tarl.seeds import episode_seeds

INTS = np.zeros(0, np.int32)


def trace(*rewards: float, site: int | None = None, **parts: list[float]) -> Trace:
    events = np.full(int(site is not None), site or 0, np.int32)
    return Trace(
        ((1,), (2,)),
        events,
        np.ones(len(events)),
        np.zeros(len(events), np.int32),
        np.zeros(len(events), np.int32),
        np.arange(len(rewards), dtype=np.int32) % 2,
        np.array(rewards, np.float64),
        {name: np.array(values, np.float64) for name, values in parts.items()},
    )


class Missions:
    """Runs whose reward is the number of the run, and whose result is given by the letters."""

    workers = 1

    def __init__(self, letters: str = "." * 9, **changed: Any) -> None:
        self.letters = letters
        self.changed = changed
        self.plans: list[EpisodePlan] = []

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        self.plans.append(plan)
        number = len(self.plans)
        failed = self.letters[number - 1] == "F"
        usual = EpisodeRun(
            plan,
            trace(float(number), 0.0),
            not failed,
            failure=f"failure {number}." if failed else "",
            topics={"/odom": f"type {number}"},
            notes=("same", f"note {number}"),
            values={"v": [float(number)]},
        )
        return replace(usual, **self.changed)

    def begin(self, plan: EpisodePlan) -> Any:
        return SimpleNamespace(result=lambda: self(plan), cancel=lambda: True)


def run(missions: Any, count: int, **given: Any) -> Recorded:
    shown: list[Any] = given.pop("shown", [])
    return run_episodes(
        missions, range(10, 10 + count), "mud", ((0,),), lambda *one: shown.append(one), **given
    )


def test_episodes_are_recorded_in_order_with_their_results() -> None:
    shown: list[Any] = []
    missions = Missions(".F.F")
    found = run(missions, 4, shown=shown)
    assert [(one.seed, one.drift, one.record) for one in missions.plans] == [
        (seed, "mud", True) for seed in (10, 11, 12, 13)
    ]
    assert found.sample.seeds == (10, 11, 12, 13)
    assert found.sample.total.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert (found.success, found.failures) == (0.5, ("failure 2.", "failure 4."))
    assert found.first.reward.tolist() == [1.0, 0.0]
    assert found.topics == {"/odom": "type 4"}
    assert found.notes == ("same", "note 1", "note 2", "note 3", "note 4")
    assert shown == [(number, 4, "mud") for number in range(4)]
    assert (found.learner, found.simulator, len(found.sarsa)) == ("sarsa", False, 1)


def test_a_recording_ends_when_its_rule_says_so() -> None:
    missions = Missions()
    assert run(missions, 9, enough=lambda samples: len(samples) == 3).sample.episodes == 3
    assert len(missions.plans) == 3


def test_broken_episode_teaches_no_bins() -> None:
    with pytest.raises(RecordingError, match="0 episodes were requested"):
        run(Missions(), 0)
    with pytest.raises(RecordingError, match=r"\(seed 10\) that did not end: never waits"):
        run(Missions(stuck=True, failure="never waits"), 2)
    with pytest.raises(RecordingError, match=r"\(seed 10\) failed outside the mission:\nTraceback"):
        run(Missions(broken="Traceback"), 2)
    usual = EpisodeRun(EpisodePlan(1), trace(1.0), passed=False)
    assert sound(usual) is usual


def test_values_for_bins_come_from_episodes_of_their_own() -> None:
    shown: list[Any] = []
    missions: Any = Missions("." * PILOTS)
    assert read_values(missions, 5, lambda *one: shown.append(one), "mud") == {
        "v": [float(number) for number in range(1, PILOTS + 1)]
    }
    assert tuple(one.seed for one in missions.plans) == episode_seeds(5, "bins", PILOTS)
    assert {(one.drift, one.record) for one in missions.plans} == {("mud", False)}
    assert shown == [(number, PILOTS, "bins") for number in range(PILOTS)]


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        (trace(1.0, 2.0), trace(1.0, 2.0), True),
        (trace(1.0, 2.0), trace(1.0, np.nextafter(2.0, 3.0)), False),
        (trace(float("nan")), trace(float("nan")), True),
        (trace(1.0), trace(1.0, 0.0), False),
        (trace(1.0, part=[1.0]), trace(1.0, part=[1.0]), True),
        (trace(1.0, part=[1.0]), trace(1.0, part=[2.0]), False),
        (trace(1.0, part=[1.0]), trace(1.0, other=[1.0]), False),
        (trace(1.0), replace(trace(1.0), cells=((1,), (3,))), False),
        (trace(1.0), replace(trace(1.0), thread=INTS), False),  # a thread started only in the second episode
        (replace(trace(1.0), thread=np.zeros(3, np.int32)), trace(1.0), False),
        (trace(1.0), replace(trace(1.0), thread=np.zeros(3, np.int32)), False),
        (trace(1.0, site=0), trace(1.0, site=1), False),
    ],
)
def test_traces_are_identical_to_the_last_bit(one: Trace, other: Trace, same: bool) -> None:
    assert identical(one, other) is same


def again(*rewards: float, **changed: Any) -> list[str]:
    """Return the notes about a repetition of an episode that earned 1."""
    found = replace(run(Missions(), 3), **changed)
    rollout: Any = lambda plan: EpisodeRun(plan, trace(*rewards), passed=True)  # noqa: E731
    return repeated(rollout, EpisodePlan(10), found)


def test_an_episode_that_cannot_be_repeated_is_noted() -> None:
    assert again(1.0, 0.0) == []
    assert again(1.0, 0.5) == [NOT_REPRODUCIBLE]
    (note,) = again(1.0, 2.5, simulator=True)
    assert "earned 1 and 3.5, 2.5 apart; the standard deviation over all episodes is 1. This" in note
    (note,) = again(1.0, 2.5, simulator=True, sample=run(Missions(), 1).sample)
    assert "is unknown. This" in note


def test_failures_are_reported_before_unjudged_formulas() -> None:
    def refused(failing: str, robustness: float, *failures: str) -> str:
        judged = SimpleNamespace(formulas=("up",), robustness=np.array([[robustness]]))
        found: Any = SimpleNamespace(failures=failures, sample=SimpleNamespace(judgements=judged, episodes=7))
        settling: Any = SimpleNamespace(failing=failing)
        return _refused(settling, found)

    nan = float("nan")
    assert refused("", 1.0) == ""
    assert refused("", nan).startswith("The formula 'up' can never be judged")
    assert "all 7 episodes" in refused("", nan)
    told = refused("2 of 5 failed", nan, "too late.", "too far.")
    assert told.startswith("2 of 5 failed, so the software does not yet work")
    assert told.endswith(
        "The first failure: too late. Fix the node or the test, or lower min_success on the marker."
    )
    assert refused("7 of 7 failed", nan, *["too late"] * 7).endswith(" Fix the node or the test.")
    assert "first failure" not in refused("2 of 5 failed", 1.0)


def test_a_note_names_lists_without_an_executed_statement() -> None:
    plan: Any = SimpleNamespace(
        lists=tuple(SimpleNamespace(name=name) for name in ("a", "b", "c")), forwarded=frozenset({2})
    )
    found: Any = SimpleNamespace(
        lists=tuple(
            SimpleNamespace(visits=SimpleNamespace(state=np.array(one))) for one in ([0, 1], [0, 0], [])
        )
    )
    told = _silent_lists(found, plan)
    assert [one[:28] for one in told] == ["no step of b was executed: d", "no statement runs when a mes"]
    assert "passes c, since" in told[1]


def test_the_summary_compares_with_the_previous_recording() -> None:
    old, new = run(Missions(".."), 2).sample, run(Missions(".F."), 3).sample
    assert _summary(new, None) == "recorded ATR 2, success 66.6 %, 3 episodes, 2 cells"
    assert _summary(new, old).startswith("recorded ATR 1.5 → 2, success")


def test_a_previous_recording_that_cannot_be_read_is_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "old.npz"
    assert _previous(path) == (None, ())
    path.write_bytes(b"")
    sample: Any = "sample"
    monkeypatch.setattr(fixture, "load", lambda _: SimpleNamespace(sample=sample))
    assert _previous(path) == (sample, ())

    def damaged(_: Path) -> None:
        raise FixtureError("old.npz is damaged.")

    monkeypatch.setattr(fixture, "load", damaged)
    none, (note,) = _previous(path)
    assert none is None
    assert "old.npz is damaged." in note
    assert note.endswith("The new recording replaces it.")
