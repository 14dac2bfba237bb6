"""Sensors that distinguish the drifted world, and the places at which their templates are tried."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Sensor
from pytest_tarl.model import OperandEffect
from pytest_tarl.repairing import structural, typical_sizes
from pytest_tarl.repairing.telling_sensors import telling, usual, varies
from pytest_tarl.repairing.template_places import spots
from tarl_lint.api import analyse
from tests.plugin.repairing.test_smoothing import TOOL, order

AIMING = """\
import rospy
from std_msgs.msg import Float32
from table import elevation, name


class Cannon:
    def __init__(self):
        self.out = rospy.Publisher("/out", Float32, queue_size=1)
        rospy.Subscriber("/far", Float32, self.on_far)

    def on_far(self, msg):
        self.out.publish(elevation(msg.data))


if __name__ == "__main__":
    rospy.init_node("cannon")
    Cannon()
    rospy.spin()
"""
TABLE = "def elevation(far):\n    return far * 0.5\n\n\ndef name(far):\n    return str(far)\n"


@pytest.mark.parametrize(("designed", "drifted", "tells"), [(0, 5, True), (5, 0, True), (3, 3, False)])
def test_sensor_that_differs_between_worlds_is_offered(designed: int, drifted: int, tells: bool) -> None:
    assert telling(order(designed, drifted)) == ([TOOL] if tells else [])


def test_a_sensor_without_numbers_is_not_offered_to_templates() -> None:
    colour = Sensor("colour", topic="/colour", field="data", categories=("red", "blue"))
    assert telling(order(0, 1, colour)) == []


@pytest.mark.parametrize(("low", "high", "mean"), [(0, 1, 0.55), (-1, 0, 0.45), (-0.55, 0.45, 1.0)])
def test_typical_sensor_size_comes_from_the_drifted_world(low: float, high: float, mean: float) -> None:
    sensor = Sensor("tool", topic="/tool", field="data", low=low, high=high, bins=10)
    assert usual(order(0, 5, sensor), sensor) == pytest.approx(mean)


def visits(designed: list[float], drifted: list[float]) -> Any:
    """Return an order whose worlds spend these numbers of steps in the bins of the sensor, from the first bin on."""
    asked = order(0, 0)
    for world, counts in ((asked.fixture.sample, designed), (asked.online.recorded.sample, drifted)):
        world.cells = [(bin_,) for bin_ in range(len(counts))]
        world.chain.cell, world.chain.count = np.arange(len(counts)), np.array(counts)
    return asked


@pytest.mark.parametrize(
    ("designed", "drifted", "expected"),
    [
        ([5.0], [5.0, 5.0], True),  # one bin and two: twice as many
        ([5.0] * 5, [4.0] * 8, True),  # 1.6 times as many
        ([5.0] * 5, [4.0] * 7, False),  # 1.4 times as many
        ([5.0], [5.0], False),
        ([5.0], [99.0, 1.0], False),  # exp(0.056) bins
        ([5.0], [80.0, 20.0], True),  # exp(0.5004) = 1.65 bins
        ([5.0], [], False),
        ([], [5.0, 5.0], False),
    ],
)
def test_varying_sensor_uses_half_as_many_more_bins(
    designed: list[float], drifted: list[float], expected: bool
) -> None:
    assert varies(visits(designed, drifted), TOOL) is expected


@pytest.mark.parametrize(
    ("designed", "drifted", "tells"),
    [
        ([3.0, 1.0], [0.0, 1.0], True),  # a quarter of the designed steps is in the bin of the drifted world
        ([2.9, 1.0], [0.0, 1.0], False),
        ([1.0, 1.0], [1.0, 3.0], False),
        ([1.0], [], False),
        ([], [1.0], False),
    ],
)
def test_separating_sensor_shares_a_quarter_of_the_steps_at_most(
    designed: list[float], drifted: list[float], tells: bool
) -> None:
    assert bool(telling(visits(designed, drifted))) is tells


def test_typical_sensor_size_is_known_for_the_designed_world() -> None:
    sensor = Sensor("tool", topic="/tool", field="data", low=0, high=1, bins=10)
    asked = order(0, 5, sensor)
    assert usual(asked, sensor, asked.fixture.sample) == pytest.approx(0.05)


SENDING = """\
import rospy
from std_msgs.msg import Bool, Float32


class Sprayer:
    def __init__(self):
        self.open = False
        self.nozzle = rospy.Publisher("/nozzle", Bool, queue_size=1)
        rospy.Subscriber("/green", Float32, self.on_green)

    def on_green(self, msg):
        self.open = msg.data > 0.3
        self.nozzle.publish(Bool(data=self.open))


if __name__ == "__main__":
    rospy.init_node("sprayer")
    Sprayer()
    rospy.spin()
"""


def test_templates_with_a_delay_apply_to_published_values(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sprayer.py").write_text(SENDING)
    monkeypatch.setattr(typical_sizes, "_recorded", lambda *_: {})
    asked: Any = order(0, 5)
    asked.analysis, asked.comparison.culprits = analyse([tmp_path / "sprayer.py"], root=tmp_path), ()
    found = [(spot.source.source(spot.node), spot.kind) for spot in spots(asked)]
    assert ("self.open", "sent") in found


def test_number_returning_call_is_a_template_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "aiming.py").write_text(AIMING)
    (tmp_path / "table.py").write_text(TABLE)
    analysis = analyse([tmp_path / "aiming.py", tmp_path / "table.py"], root=tmp_path)
    returned = {str(step.site): 12.0 for step in analysis.sites if step.code.startswith("return")}
    assert len(returned) == 1
    monkeypatch.setattr(typical_sizes, "_recorded", lambda *_: returned)
    asked: Any = order(0, 5)
    asked.analysis, asked.comparison.culprits = analysis, ()
    found = {spot.source.source(spot.node): spot for spot in spots(asked)}
    assert set(found) == {"elevation(msg.data)", "far * 0.5"}
    call, inner = found["elevation(msg.data)"], found["far * 0.5"]
    assert (call.typical, call.hears, inner.hears) == (12.0, True, False)


def test_statements_that_respond_come_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    moved = AIMING.replace(
        "self.out.publish(elevation(msg.data))",
        "far = msg.data - 1.0\n        self.out.publish(elevation(far))",
    )
    (tmp_path / "aiming.py").write_text(moved)
    (tmp_path / "table.py").write_text(TABLE)
    monkeypatch.setattr(typical_sizes, "_recorded", lambda *_: {})
    asked: Any = order(0, 5)
    asked.analysis = analyse([tmp_path / "aiming.py", tmp_path / "table.py"], root=tmp_path)
    asked.comparison.culprits = ()
    sites = {str(spot.site): spot.source.source(spot.node) for spot in spots(asked)}
    assert len(sites) > 1
    for site, code in sites.items():
        first = next(spots(asked, [site]))
        assert first.source.source(first.node) == code


def test_statement_responds_if_one_constant_gains_a_fifth() -> None:
    effects = {"a": (effect(1.0), effect(2.1)), "b": (effect(6.0),), "c": (effect(1.9),), "d": ()}
    assert structural._responding(effects, 10.0) == ("b", "a")
    assert structural._responding({"a": (effect(0.0),)}, 0.0) == ()


def effect(gain: float) -> OperandEffect:
    return OperandEffect("1.0", 1.0, 2.0, gain)
