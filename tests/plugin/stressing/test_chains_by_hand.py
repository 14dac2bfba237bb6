"""Seeds, counts and drifts of chains, compared with values that are worked out by hand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import hypot, inf
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.stressing import chains
from pytest_tarl.stressing.chains import (
    BEFORE,
    FINE,
    INWARD,
    LIKELY,
    NEARER,
    OUTWARD,
    POSSIBLE,
    UNLIKELY,
    closer,
    finer,
    likely,
    part_of,
)
from pytest_tarl.stressing.evaluating import Count
from pytest_tarl.stressing.guarantee import Guarantee, Part, most_passed
from pytest_tarl.stressing.rate_tests import BLOCK, LOOKS, SPENT, RateTests

GIVEN = Guarantee(0.95, 0.5, (1.0,) * 100, 1.0)
RISK = 0.05
LEAST = tuple(
    size - most_passed(GIVEN, size, RISK * share, "rate") for size, share in zip(LOOKS, SPENT, strict=True)
)  # number of failures at each check that shows that a drift fails


class Scripted:
    """Episodes that fail as a function of the seed's number says."""

    guarantee = GIVEN

    def __init__(self) -> None:
        self.fails: Callable[[int], bool] = lambda _: True
        self.ran: list[int] = []
        self.counts: list[Count] = []
        self.stops = inf

    def ordered(self, _: str, __: Any, rows: Sequence[int]) -> dict[int, Any]:
        if len(self.ran) >= self.stops:
            raise RuntimeError("the budget is spent")
        self.ran += rows
        return {row: SimpleNamespace(passed=not self.fails(row)) for row in rows}

    def count(self, _: str, count: Count) -> None:
        self.counts.append(count)


def confirmed(*drifts: Callable[[int], bool]) -> tuple[list[bool], list[list[int]], list[Count], RateTests]:
    """Return for each drift of a chain whether it is confirmed, the seeds that ran, and what the model learns."""
    episodes: Any = Scripted()
    tests = RateTests(episodes, "fresh", RISK)
    shown, ran = [], []
    for number, fails in enumerate(drifts):
        episodes.fails, episodes.ran = fails, []
        shown.append(tests.confirm({"size": float(number)}))
        ran.append(episodes.ran)
    return shown, ran, episodes.counts, tests


def even(row: int) -> bool:
    return row % 2 == 0


def blocks(number: int) -> list[int]:
    return list(range(BLOCK * number))


def test_certain_failure_is_confirmed_in_the_first_block() -> None:
    needed = -(-LEAST[0] // BLOCK)
    shown, (ran,), (count,), tests = confirmed(lambda _: True)
    assert (shown, ran) == ([True], blocks(needed))
    assert (count.point, count.failed, count.episodes) == ({"size": 0.0}, len(ran), len(ran))
    assert tests.ran == tests.failed == {*ran}


def test_hopeless_test_ends_early() -> None:
    shown, (ran,), (count,), tests = confirmed(lambda _: False)
    assert shown == [False]
    assert 0 < len(ran) < LOOKS[-1]
    assert ran == list(range(len(ran)))
    assert (count.failed, count.episodes) == (0, len(ran))
    assert tests.ran == tests.failed == set()


def test_later_failures_do_not_count_in_a_check() -> None:
    # one failure fewer than needed among the first 16 seeds, and all further seeds pass
    assert not confirmed(lambda row: row < LEAST[0] - 1)[0][0]
    # the missing one follows among the first 32 seeds, which need more failures
    assert LEAST[0] < LEAST[1]
    assert not confirmed(lambda row: row < LEAST[0] - 1 or row == LOOKS[0])[0][0]
    shown, (ran,), *_ = confirmed(lambda row: row < LEAST[0])
    assert shown[0]
    assert ran == blocks(-(-LEAST[0] // BLOCK))


def test_failed_seeds_run_first_on_the_next_drift() -> None:
    shown, ran, _, tests = confirmed(even, lambda _: False)
    assert shown == [True, False]
    failed, passed = ([row for row in ran[0] if row % 2 == at] for at in (0, 1))
    new = [row for row in range(LOOKS[-1]) if row not in ran[0]]
    assert ran[1] == [*failed, *new, *passed][: len(ran[1])]
    assert (tests.ran, tests.failed) == ({*ran[0]}, {*failed})  # those of the last confirmed drift


def test_drift_that_fails_on_the_same_seeds_is_confirmed() -> None:
    shown, ran, counts, tests = confirmed(even, even, even)
    assert shown == [True] * 3
    failed = [row for row in ran[0] if even(row)]
    assert ran[1] == ran[2] == failed[: len(ran[1])]
    assert len(ran[1]) <= len(failed)
    # seeds that did not run count as passed; of those that failed before, all fail again
    assert (counts[1].failed, counts[1].episodes) == (len(failed), len(ran[0]))
    assert tests.failed == {*ran[1]}
    assert tests.ran == {*ran[0]}


def test_estimate_extends_failed_seeds_to_all() -> None:
    failed = {row for row in confirmed(even)[1][0] if even(row)}
    half = sorted(failed)[1::2]
    _, ran, counts, __ = confirmed(even, lambda row: row in half)
    again = [row for row in ran[1] if row in failed]
    new = [row for row in ran[1] if row not in ran[0]]
    assert counts[1].failed == pytest.approx(len(failed) * sum(row in half for row in again) / len(again))
    assert counts[1].episodes == len({*ran[0], *new})


def test_model_learns_until_the_budget_ends() -> None:
    episodes: Any = Scripted()
    episodes.fails = lambda row: row % 3 == 0
    episodes.stops = BLOCK
    with pytest.raises(RuntimeError):
        RateTests(episodes, "fresh", RISK).confirm({"size": 1.0})
    assert [(one.failed, one.episodes) for one in episodes.counts] == [(3, BLOCK)]
    episodes.stops, episodes.counts = 0, []
    with pytest.raises(RuntimeError):
        RateTests(episodes, "fresh", RISK).confirm({"size": 1.0})
    assert episodes.counts == []


# the part of the guarantee, and finer chains


def model_of(by_loss: Sequence[float], by_rate: Sequence[float], luck: float = 0.0) -> Any:
    shown = SimpleNamespace(shown_by=lambda _: (np.array(by_loss), np.array(by_rate)), luck=luck)
    coordinates = SimpleNamespace(
        covers=lambda point: "option" not in point,
        vector=lambda point: np.array([point["a"], point["b"]]),
        point=lambda vector: {"a": float(vector[0]), "b": float(vector[1])},
        low=np.array([0.0, 0.0]),
        high=np.array([1.0, 1.0]),
    )
    return SimpleNamespace(
        model=lambda: shown, coordinates=coordinates, distance=lambda point: hypot(point["a"], point["b"])
    )


DRIFTS: list[Any] = [{"a": 0.8, "b": 0.6}, {"a": 0.6, "b": 0.45}, {"a": 0.4, "b": 0.3}]


@pytest.mark.parametrize(
    ("by_loss", "by_rate", "expected"),
    [
        ((0.9, 0.9, 0.4), (LIKELY, LIKELY, 0.4), "rate"),
        ((0.9, 0.9, 0.41), (0.9, 0.9, 0.4), "both"),  # the nearest drift decides
        ((0.0, 0.0, 0.0), (0.9, LIKELY - 0.01, 0.4), "both"),
        ((0.9, 0.9, 0.9), (UNLIKELY - 0.01, 0.0, 0.0), "loss"),
        ((0.9, 0.9, 0.9), (UNLIKELY, 0.0, 0.0), "both"),
    ],
)
def test_chain_tests_the_broken_part_of_the_guarantee(
    by_loss: Sequence[float], by_rate: Sequence[float], expected: str
) -> None:
    assert part_of(model_of(by_loss, by_rate), DRIFTS) == expected


def test_chain_outside_the_model_tests_both_parts() -> None:
    certain = model_of((0.0,), (1.0,))
    assert part_of(certain, DRIFTS[:1]) == "rate"
    assert part_of(certain, []) == "both"
    assert part_of(certain, [*DRIFTS, {"a": 0.1, "b": 0.1, "option": 1.0}]) == "both"


def lengths(points: Sequence[Any]) -> list[float]:
    return [hypot(one["a"], one["b"]) for one in points]


def test_chain_is_refined_if_the_same_seeds_fail() -> None:
    found = finer(model_of((), (), luck=0.1), DRIFTS, "rate")  # distances of 1, 0.75 and 0.5
    assert lengths(found) == pytest.approx(
        [1.0, 0.75, *(0.5 * one for one in OUTWARD), 0.5, *(0.5 * one for one in INWARD)]
    )
    assert all(one["b"] == pytest.approx(0.75 * one["a"]) for one in found)


def test_further_drifts_lie_nearer_than_the_last() -> None:
    close: list[Any] = [{"a": 0.432, "b": 0.324}, {"a": 0.4, "b": 0.3}]  # 1.08 times as far
    alike = model_of((), (), luck=0.1)
    assert lengths(finer(alike, close, "rate"))[:3] == pytest.approx([0.54, 0.52, 0.5])
    (edge, *_) = finer(alike, [{"a": 1.0, "b": 0.5}], "rate")
    assert edge == {"a": 1.0, "b": pytest.approx(0.5 * OUTWARD[0])}


def test_chain_with_other_failing_seeds_is_refined_one_way() -> None:
    found = finer(model_of((), ()), DRIFTS, "rate")
    assert lengths(found) == pytest.approx([1.0, 0.75, 0.5, *(0.5 * one for one in INWARD)])


@pytest.mark.parametrize("part", ["loss", "both"])
def test_loss_chain_continues_towards_nominal(
    part: Part,
) -> None:
    found = finer(model_of((), (), luck=0.1), DRIFTS, part)
    inward = [0.5 * one for one in INWARD]
    assert lengths(found) == pytest.approx([1.0, 0.75, *(0.5 * one for one in BEFORE), 0.5, *inward])
    assert lengths(finer(model_of((), ()), DRIFTS[2:], part)) == pytest.approx([0.5, *inward])


def test_chain_outside_the_model_is_not_refined() -> None:
    option: list[Any] = [{"a": 0.6, "b": 0.8, "option": 1.0}]
    assert finer(model_of((), ()), option, "both") == option
    assert finer(model_of((), ()), [], "both") == []


def test_chains_with_an_option_are_short() -> None:
    option = {"a": 0.6, "b": 0.8, "option": 1.0}

    def chain(best: Any, limit: float) -> Any:
        nearest = model_of((), ())
        nearest.best = best
        return chains.chain(nearest, chains.FIRST, limit)

    assert chain(None, inf) == []
    assert chain(option, inf) == [option]
    assert chain(option, 1.0) == []
    assert chain(option, 1.0 / chains.NEARER + 0.001) == [option]


@pytest.mark.parametrize(
    ("best", "predicted", "slope"),
    [
        ({"a": 0.3, "b": 0.0}, {"a": 0.0, "b": 0.2}, inf),  # the model prefers b
        ({"a": 0.3, "b": 0.1}, None, 0.75),
        ({"a": 0.1, "b": 0.3}, {"a": 0.3, "b": 0.1, "option": 1.0}, 3.0),
    ],
)
def test_small_steps_follow_the_likeliest_direction(best: Any, predicted: Any, slope: float) -> None:
    nearest = model_of((), ())
    failing = SimpleNamespace(failing=lambda vectors: vectors[:, 1])
    nearest.model = lambda: failing
    nearest.coordinates.options, nearest.tested, nearest.best = 0, [], best
    nearest.evaluator = SimpleNamespace(seed=0, drift="world")
    nearest.predicted = lambda errors, depth, draws: predicted
    found = closer(nearest, DRIFTS[1])  # at a distance of 0.75, with a slope of 0.75
    assert lengths(found) == pytest.approx([0.75 * NEARER * one for one in FINE])
    assert all(
        one["b"] == pytest.approx(slope * one["a"]) if slope < inf else one["a"] == 0.0 for one in found
    )


def test_drift_outside_the_model_gets_no_small_steps() -> None:
    nearest = model_of((), ())
    nearest.best = DRIFTS[0]
    assert closer(nearest, {"a": 0.6, "b": 0.8, "option": 1.0}) == []
    nearest.best = None
    assert closer(nearest, DRIFTS[0]) == []


def test_likely_drift_has_a_probability_of_one_half() -> None:
    nearest = model_of((), ())
    for chance, answer in ((POSSIBLE, True), (POSSIBLE - 0.01, False)):
        failing = SimpleNamespace(failing=lambda vectors, chance=chance: np.full(len(vectors), chance))
        nearest.model = lambda failing=failing: failing
        assert likely(nearest, DRIFTS[0]) is answer
        assert not likely(nearest, {"a": 0.6, "b": 0.8, "option": 1.0})  # the model does not cover it
