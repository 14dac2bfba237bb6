"""Limits that drifted missions reach and designed ones do not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.repairing.reached_limits import reached_limits
from tarl_lint.api import analyse

CAPPER = """\
import rospy
from std_msgs.msg import Float64

MOST_TURNS = 2.0
MOST_TIME = 1.5
COLDEST = -4.0
LEAST = 0.3
FASTEST = 9.0


def on_turns(msg):
    turns = msg.data
    if turns - 0.1 > MOST_TURNS:
        turns = 0.0
    if not turns * 2.0 < MOST_TIME:
        turns = 0.0
    if turns < COLDEST or LEAST > turns:
        turns = 0.0
    near = turns > LEAST
    if near:
        turns = 1.0
    if turns == MOST_TURNS:
        turns = 2.0
    speed = max(-FASTEST, min(FASTEST, turns))
    out.publish(Float64(data=speed))


rospy.init_node("capper")
out = rospy.Publisher("/out", Float64, queue_size=1)
rospy.Subscriber("/turns", Float64, on_turns)
rospy.spin()
"""
TURNS, TIME, COLD, NEAR = "if turns - 0.1", "if not turns", "if turns < COLDEST", "near ="
SAME, SPEED = "if turns ==", "speed ="
RARE = [0.0] * 30
Values = Mapping[str, Sequence[float]]


def limits(
    folder: Path, designed: Values, drifted: Values, before: Values | None = None
) -> list[tuple[str, float]]:
    """Return the code and factor of each limit, for the values of statements; the n-th value belongs to step n."""
    (folder / "capper.py").write_text(CAPPER)
    analysis = analyse([folder / "capper.py"], root=folder)

    def trace(values: Values) -> Any:
        events = [
            (number, at, value)
            for number, place in enumerate(plan(analysis).places)
            for code, each in values.items()
            if f":{code}" in place.id
            for at, value in enumerate(each)
        ]
        site, steps, flow = map(np.array, zip(*events, strict=True))
        return SimpleNamespace(
            site=site, event_step=steps, flow=flow, reward=np.zeros(max(map(len, values.values())))
        )

    order: Any = SimpleNamespace(analysis=analysis)
    known = trace(before) if before is not None else None
    return [(one.code, by) for one, by in reached_limits(order, [(trace(designed), trace(drifted))], known)]


@pytest.mark.parametrize(
    ("code", "new", "expected"),
    [
        (TURNS, 1.0, [("MOST_TURNS", 2.2), ("0.1", 2.2)]),  # a subtracted constant acts like the limit here
        (TIME, 1.0, [("MOST_TIME", 2.2), ("2.0", 0.4)]),
        (COLD, 1.0, [("COLDEST", 2.2), ("LEAST", 0.4)]),  # a negative limit is relaxed by a larger size
        (NEAR, 1.0, [("LEAST", 2.2)]),
        (NEAR, 0.0, [("LEAST", 0.4)]),
        (SAME, 1.0, []),
    ],
)
def test_limit_is_relaxed_to_the_designed_result(
    code: str, new: float, expected: list[tuple[str, float]], tmp_path: Path
) -> None:
    usual = [1.0 - new] * 30
    found = limits(tmp_path, {code: usual}, {code: [*usual[:5], new]})
    assert sorted(found) == sorted(expected)


@pytest.mark.parametrize(
    ("designed", "drifted", "expected"),
    [
        (RARE, RARE, False),
        ([0.0, 1.0, *RARE], [0.0, 1.0, 0.0], False),  # both missions reach it once
        ([0.0, 1.0, *RARE], [0.0, 1.0, 1.0, 1.0], False),  # for longer, but still once
        ([0.0, 1.0, *RARE], [0.0, 1.0, 0.0, 1.0], True),  # once more
        ([*RARE, 1.0], [0.0, 1.0], True),  # the designed mission reaches it only later
        ([0.0, 1.0] * 9, [0.0, 1.0] * 12, False),  # an ordinary decision, no limit
        ([], [1.0], False),  # never decided as designed
        (RARE, [], False),
    ],
)
def test_limit_is_reached_more_often_than_as_designed(
    designed: Sequence[float], drifted: Sequence[float], expected: bool, tmp_path: Path
) -> None:
    rest = {NEAR: [0.0]}  # a trace is never empty
    found = limits(tmp_path, {TURNS: designed} | rest, {TURNS: drifted} | rest)
    assert ("MOST_TURNS" in {code for code, _ in found}) is expected


def test_new_limits_come_first_in_order_of_time(tmp_path: Path) -> None:
    usual = {TURNS: RARE, TIME: RARE, NEAR: RARE}
    drifted = {TURNS: [1.0], TIME: [0.0, 0.0, 0.0, 1.0], NEAR: [0.0, 1.0]}
    first = [code for code, _ in limits(tmp_path, usual, drifted) if code.isupper()]
    assert first == ["MOST_TURNS", "LEAST", "MOST_TIME"]
    then = limits(tmp_path, usual, drifted, before={TURNS: [1.0], TIME: [0.0], NEAR: [0.0, 1.0]})
    assert [code for code, _ in then if code.isupper()] == ["MOST_TIME", "MOST_TURNS", "LEAST"]


@pytest.mark.parametrize(
    ("drifted", "expected"),
    [
        ([9.0] * 10 + [1.0] * 10, [("FASTEST", 2.2)]),
        ([-9.0] * 10 + [1.0] * 10, [("FASTEST", 2.2)]),
        ([9.0] + [1.0] * 10, []),  # at its bound only for a moment
        ([9.0] * 10 + [12.0], [("FASTEST", 0.4)]),  # the bound is no upper one
    ],
)
def test_a_value_that_stays_at_a_bound_reaches_it(
    drifted: Sequence[float], expected: list[tuple[str, float]], tmp_path: Path
) -> None:
    assert sorted(set(limits(tmp_path, {SPEED: [1.0] * 30}, {SPEED: drifted}))) == expected
    assert limits(tmp_path, {SPEED: [9.0] * 30}, {SPEED: drifted}) == []
