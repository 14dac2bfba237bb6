"""Which constants are changed on a second scale besides factors."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.charts import SHARE, offset
from pytest_tarl.patching.mutate import mutations, stepped
from pytest_tarl.repairing import typical_sizes
from pytest_tarl.repairing.between import factor
from pytest_tarl.repairing.ledger import alike
from pytest_tarl.repairing.scales import charts
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate
from pytest_tarl.sensors import Sensor
from tarl_lint.api import analyse
from tarl_lint.model import Operand, SiteId, Span

NODE = """\
import rospy
from std_msgs.msg import Float64

ALPHA = 0.95
HALF = 0.5
ZERO_ANGLE = -0.012
LARGE = 40.0
GAIN = 0.01
BIAS = 0.02


def on_pitch(msg):
    pitch = msg.data * HALF
    level = ALPHA * pitch
    error = pitch - (ZERO_ANGLE + level)
    far = pitch + LARGE
    if error > 0.0:
        far += BIAS
    wheels.publish(GAIN * error + far)


rospy.init_node("balance")
rospy.Subscriber("/pitch", Float64, on_pitch)
wheels = rospy.Publisher("/wheels", Float64, queue_size=1)
rospy.spin()
"""


def test_value_near_one_has_a_second_scale(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "balance.py").write_text(NODE)
    analysis = analyse([tmp_path / "balance.py"], root=tmp_path)
    sizes = {"pitch": 0.3, "level": 0.2, "error": 0.1, "far": 0.5}
    recorded = {
        str(step.site): sizes[step.code.split(" ")[0]]
        for step in analysis.sites
        if step.code.split(" ")[0] in sizes
    }
    monkeypatch.setattr(typical_sizes, "_recorded", lambda *_: recorded)
    order: Any = SimpleNamespace(analysis=analysis, fixture=SimpleNamespace(sensors=()))
    operands = [one for step in analysis.sites for one in analysis.operands(step.site)]
    found = {one.code: chart for one, chart in charts(order, operands).items()}
    assert found == {"ALPHA": SHARE, "ZERO_ANGLE": offset(0.3), "0.0": offset(0.1), "BIAS": offset(0.5)}


RADIO = """\
import rospy
from std_msgs.msg import UInt16

TRIM = 0


def scaled(width):
    return (width - 1500.0) / 600.0


def on_stick(msg):
    wheels.publish(scaled(msg.data + TRIM))


rospy.init_node("radio")
rospy.Subscriber("/stick", UInt16, on_stick)
wheels = rospy.Publisher("/wheels", UInt16, queue_size=1)
rospy.spin()
"""


@pytest.mark.parametrize(
    ("topic", "field", "expected"),
    [("/stick", "data", {"TRIM": offset(150.0)}), ("/other", "data", {}), ("/stick", "other", {})],
)
def test_zero_offset_of_a_reading_has_the_sensor_scale(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, topic: str, field: str, expected: dict[str, Any]
) -> None:
    """The published value, about 0.1, has another unit, because a function makes it from the sum."""
    (tmp_path / "radio.py").write_text(RADIO)
    analysis = analyse([tmp_path / "radio.py"], root=tmp_path)
    recorded = {str(step.site): 0.1 for step in analysis.sites if step.code.startswith("wheels")}
    monkeypatch.setattr(typical_sizes, "_recorded", lambda *_: recorded)
    sensor = Sensor("stick", topic=topic, field=field, low=1200, high=1800, bins=6)
    order: Any = SimpleNamespace(analysis=analysis, fixture=SimpleNamespace(sensors=(sensor,)))
    operands = [one for step in analysis.sites for one in analysis.operands(step.site)]
    assert "TRIM" in {one.code for one in operands}
    assert {one.code: chart for one, chart in charts(order, operands).items()} == expected


def test_values_near_one_are_compared_by_distance_to_one() -> None:
    span = Span("node.py", 3, 5, 3, 9)
    share = Operand(SiteId("node", "run", "line 3"), span, "0.95", 0.95, span)

    def moved(step: float) -> Candidate:
        mutation = stepped(share, step, SHARE, mutations)
        assert mutation is not None
        assert factor(mutation) == pytest.approx(step, rel=0.01)
        return Candidate((mutation,), ALWAYS)

    assert alike(moved(5.0), moved(5.1))
    assert not alike(moved(5.0), moved(8.0))  # 0.99 and 0.99375, less than 5 % apart
