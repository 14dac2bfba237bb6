"""What mission pairs say about statements and sensors, and when structural changes are tried early."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest

from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.repairing import early as module
from pytest_tarl.repairing.early import FROM, LATER, MOST, PARTLY, Early
from pytest_tarl.repairing.mission_pairs import NO_SIGNS, Signs, mission_pairs, signs
from pytest_tarl.rollout import EpisodePlan, EpisodeRun
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.search import Candidate, Trials
from pytest_tarl.sensors import Sensor
from pytest_tarl.symptoms.symptoms import SYMPTOMS
from tests.plugin.repairing.test_evident import order_of, site, unhelpful
from tests.plugin.repairing.test_results import scaled


def test_the_strongest_of_the_named_symptoms_counts() -> None:
    found = Signs({"here": {"noise": 0.2, "spikes": 0.7, "swing": 0.9}})
    assert found.strength("here", ("noise", "spikes")) == 0.7
    assert found.strength("here", ("runaway",)) == 0.0
    assert found.strength("here", ()) == 0.0
    assert found.strength("there", ("spikes",)) == 0.0


NEAR, FAR = (Sensor(name, topic=f"/{name}", field="data") for name in ("near", "far"))


def sensed(designed: Any, drifted: Any) -> float:
    """Return the overlap of the second sensor in two pairs of missions."""
    order: Any = SimpleNamespace(comparison=SimpleNamespace(sensors=(NEAR, FAR)))
    pairs = zip(designed, drifted, strict=True)
    return Signs(
        cells=tuple(
            (tuple((0, one) for one in first), tuple((9, one) for one in second)) for first, second in pairs
        )
    ).overlap(order, FAR)


@pytest.mark.parametrize(
    ("designed", "drifted", "expected"),
    [
        (["aaaa"], ["aaab"], 0.75),
        (["aaab"], ["aaaa"], 0.75),
        (["aabb"], ["bbcc"], 0.5),
        (["aaaa", "b"], ["a", "bbbb"], 0.4),  # the steps of all pairs count alike
        (["ab"], ["aaabbb"], 1.0),  # shares are compared, not numbers
        (["a"], ["b"], 0.0),
        (["aa"], [""], 0.0),
        ([""], ["aa"], 0.0),
    ],
)
def test_sensor_overlap_is_the_share_of_steps_in_common_bins(
    designed: list[str], drifted: list[str], expected: float
) -> None:
    assert sensed(designed, drifted) == pytest.approx(expected)


class Recorded:
    """Missions in which some statements have values: the number of values by seed, drift and the start of the code."""

    def __init__(self, numbers: Any, broken: bool = False) -> None:
        self.numbers = numbers
        self.broken = broken
        self.plans: list[EpisodePlan] = []
        self.order: Any = None

    def __call__(self, asked: EpisodePlan) -> EpisodeRun:
        self.plans.append(asked)
        places = plan(self.order.analysis).places
        numbers = self.numbers(asked.seed, asked.drift is not None)
        found = [
            at
            for at, place in enumerate(places)
            for _ in range(next((n for code, n in numbers.items() if place.code.startswith(code)), 0))
        ]
        steps = 3 if asked.drift is None else 5
        trace = Trace(
            ((7,), (1,)),
            np.array(found, np.int32),
            np.ones(len(found)),
            np.zeros(len(found), np.int32),
            np.zeros(len(found), np.int32),
            np.array([-1, 0, 1, 1, 0][:steps], np.int32),
            np.full(steps, 0.1),
            {},
        )
        broken = "Traceback" if self.broken and asked.drift else ""
        return EpisodeRun(asked, trace, passed=True, broken=broken)


def recorded(folder: Path, numbers: Any, **given: Any) -> tuple[Any, Recorded]:
    rollout = Recorded(numbers, **given)
    rollout.order = order_of(folder, rollout)
    return rollout.order, rollout


def test_symptoms_use_steps_of_both_missions(tmp_path: Path) -> None:
    def numbers(seed: int, drifted: bool) -> dict[str, int]:
        return {
            "self.range = ": 2,
            "self.near = ": 0 if drifted and seed == 4 else 2,
            "self.out": 2,
            "if": not drifted,
        }

    order, _ = recorded(tmp_path, numbers)
    found = signs(order, mission_pairs(order, Trials(unhelpful, 100)))
    assert set(found.strengths) == {site(order, "self.range = ")}  # a publish call has no value of its own
    assert set(found.strengths[site(order, "self.range = ")]) == set(SYMPTOMS)


def test_steps_outside_both_missions_have_no_cell(tmp_path: Path) -> None:
    order, _ = recorded(tmp_path, lambda *_: {})
    found = signs(order, mission_pairs(order, Trials(unhelpful, 100)))
    assert found.cells == ((((7,), (1,)), ((7,), (1,))),) * 2
    assert found.strengths == {}


def test_a_mission_that_cannot_run_leaves_no_symptoms(tmp_path: Path) -> None:
    order, rollout = recorded(tmp_path, lambda *_: {"self.range = ": 2}, broken=True)
    trials = Trials(unhelpful, 100)
    assert signs(order, mission_pairs(order, trials)) == NO_SIGNS
    assert len(rollout.plans) == trials.spent == 2


def test_missions_stop_at_the_end_of_the_budget(tmp_path: Path) -> None:
    order, rollout = recorded(tmp_path, lambda *_: {"self.range = ": 2})
    assert signs(order, mission_pairs(order, Trials(unhelpful, 3))) == NO_SIGNS
    assert len(rollout.plans) == 3
    assert signs(order, mission_pairs(order, Trials(unhelpful, 4))) != NO_SIGNS


# early


class Fake:
    """Structural changes that yield two candidates, at three episodes each, and stop after a last episode."""

    made: ClassVar[list[Any]] = []

    def __init__(self, order: Any, guards: Any, trials: Trials, signs: Signs) -> None:
        self.given = (order, guards, trials, signs)
        self.trials = trials
        self.most, self.once = 0, False
        Fake.made.append(self)

    def surest(self, most: int, symptoms: bool) -> Iterator[Candidate]:
        yield from ()

    def early(self, most: int, once: bool) -> Iterator[Candidate]:
        self.most, self.once = most, once
        for by in (2.0, 3.0):
            for _ in range(3):
                self.trials.charge()
            yield scaled(by)
        self.trials.charge()

    def effects(self) -> dict[str, list[Any]]:
        return {"here": []}


@pytest.fixture
def early(monkeypatch: pytest.MonkeyPatch) -> Early:
    monkeypatch.setattr(Fake, "made", [])
    monkeypatch.setattr(module, "Structures", Fake)
    monkeypatch.setattr(module, "mission_pairs", lambda order, trials: [trials.charge(), ("pair",)][1])
    monkeypatch.setattr(module, "signs", lambda order, recorded: Signs({"x": {}}) if recorded else NO_SIGNS)
    monkeypatch.setattr(module, "corrections", lambda order, recorded: [])
    monkeypatch.setattr(module, "rescaled", lambda order, recorded: [])
    monkeypatch.setattr(module, "hints", lambda order, recorded, operands: [recorded, operands])
    order: Any = SimpleNamespace(goal=SimpleNamespace(wanted=10.0))
    return Early(order, (), Trials(lambda *_: Outcome(0.0, False), 1000))


def charged(early: Early, number: int) -> Early:
    for _ in range(number):
        early.trials.charge()
    return early


def test_changes_begin_with_a_fixed_number_of_episodes(early: Early) -> None:
    assert list(charged(early, FROM - 1).candidates()) == []
    assert (Fake.made, early.spent) == ([], 0)
    assert list(charged(early, 1).candidates()) == [scaled(2.0), scaled(3.0)]


def test_episodes_of_changes_and_pairs_are_counted_together(
    early: Early,
) -> None:
    found = charged(early, FROM).candidates()
    assert not early.waiting
    next(found)
    assert (early.spent, early.waiting) == (4, True)
    charged(early, 5)  # the search examines the candidate
    next(found)
    assert (early.spent, early.waiting) == (12, True)
    assert list(found) == []
    assert (early.spent, early.waiting) == (13, False)


@pytest.mark.parametrize(("best", "once"), [(0.0, True), (PARTLY * 10.0, False)])
def test_parameterless_changes_wait_while_a_constant_gains(early: Early, best: float, once: bool) -> None:
    list(charged(early, LATER).candidates(best))
    made = Fake.made[-1]
    assert made.once is once


def test_search_waits_after_an_accepted_candidate(early: Early) -> None:
    found = charged(early, FROM).candidates()
    next(found)
    charged(early, 2)
    found.close()  # type: ignore[attr-defined]
    assert (early.spent, early.waiting) == (6, True)


def test_mission_pairs_are_recorded_once(early: Early) -> None:
    other = Trials(lambda *_: Outcome(0.0, False), 1000)
    assert early.signs(other) is early.signs(early.trials)
    assert (other.spent, early.trials.spent) == (1, 0)
    list(charged(early, FROM).candidates())
    made = Fake.made[-1]
    assert made.given == (early.order, (), early.trials, Signs({"x": {}}))
    assert made.most == MOST
    assert early.spent == 7


def test_effects_are_empty_until_changes_were_tried(early: Early) -> None:
    assert dict(early.effects()) == {}
    list(charged(early, FROM).candidates())
    assert dict(early.effects()) == {"here": []}
    assert list(early.candidates()) == []
    assert len(Fake.made) == 2  # the surest changes, and the others


def test_suggested_changes_reuse_the_mission_pairs(early: Early) -> None:
    found: Any = early.measured(["GAIN"])  # type: ignore[list-item]
    assert found == [("pair",), ["GAIN"]]
    assert early.trials.spent == 1
    assert early.signs(early.trials) == Signs({"x": {}})
    assert early.trials.spent == 1
