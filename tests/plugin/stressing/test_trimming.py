"""Drifts at a jump of the margin: which ones they are, and how single directions are moved towards nominal."""

from __future__ import annotations

import numpy as np
import pytest

from pytest_tarl import Drift
from pytest_tarl.spaces import Point
from pytest_tarl.stressing.evaluating import Count
from pytest_tarl.stressing.prediction import Shown
from pytest_tarl.stressing.trimming import broken, trimmed
from tests.plugin.stressing.worlds import World, evaluator_of, space_of

SPACE = space_of(
    delay=Drift.range(0.0, 1.0, nominal=0.0),
    gain=Drift.range(0.0, 1.0, nominal=0.0),
    slack=Drift.range(0.0, 1.0, nominal=0.0),
    camera=Drift.choice("up", "down"),
)
SHOWN = Shown(0.2, 0.15)
AT = {"delay": 0.5, "gain": 0.4, "slack": 0.2, "camera": 1.0}


def jump(point: Point, _: np.random.Generator) -> tuple[bool, float]:
    """Fail from a delay of 0.5 on if the gain is large enough; the slack changes nothing."""
    return point["delay"] < 0.499 or point["gain"] < 0.21, 10.0


def test_only_harmless_directions_are_moved() -> None:
    evaluator, tried = evaluator_of(jump, SPACE), list[Point]()
    found = [*trimmed(AT, evaluator, tried)]
    # `gain` fails at 0.9, 0.675 and 0.5625 of 0.4, and holds at 0 and at 0.45; `slack` becomes nominal
    assert [one["gain"] for one in found] == pytest.approx([0.36, 0.27, 0.27, 0.27])
    assert found[-1] == pytest.approx({"delay": 0.5, "gain": 0.27, "slack": 0.0, "camera": 1.0})
    assert len(tried) == 7  # one with a smaller delay, four with a smaller gain, two with less slack
    assert all(evaluator.knows(one) for one in tried)


def test_a_drift_that_holds_takes_four_episodes() -> None:
    evaluator = evaluator_of(lambda *_: (True, 10.0), SPACE)
    assert [*trimmed(AT, evaluator, [])] == []
    assert evaluator.spent == 4 * 4  # nominal and one smaller step in each of three ranges


@pytest.mark.parametrize(
    ("lost", "part"), [(0.5 * 1.3, None), (0.5 * 1.45, "loss")]
)  # the tolerated loss is 0.5
def test_loss_far_above_detectable_is_a_jump(lost: float, part: str | None) -> None:
    evaluator = evaluator_of(lambda point, _: (True, 10.0 - (lost if point["delay"] else 0.0)), SPACE)
    evaluator.examine(AT, 4)
    assert broken(AT, evaluator, SHOWN) == part


def test_failures_in_chain_tests_count() -> None:
    world: World = lambda *_: (True, 10.0)  # noqa: E731
    evaluator = evaluator_of(world, SPACE)
    assert broken(AT, evaluator, SHOWN) is None
    evaluator.count("chain 0", Count(AT, 5.0, 16))
    assert broken(AT, evaluator, SHOWN) is None  # the pool is not released
    evaluator.release("chain 0")
    assert broken(AT, evaluator, SHOWN) == "rate"  # 5 of 16 are more than twice 15 %
    evaluator.count("chain 0", Count(AT, 4.0, 16))
    assert broken(AT, evaluator, SHOWN) is None
