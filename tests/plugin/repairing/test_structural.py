"""Structural repairs, for drifts that no constant repairs."""

from __future__ import annotations

import sys

import pytest

from tests.plugin.tank import RECORD, result
from tests.slow import SLOW

REPAIR = ("--tarl-online", "--tarl-episodes=10", "--tarl-repair")
NODE = """\
import rospy
from std_msgs.msg import Float64

error = None


def on_error(msg):
    global error
    error = msg.data


def main():
    rospy.init_node("keeper")
    rospy.Subscriber("/error", Float64, on_error)
    valve = rospy.Publisher("/valve", Float64, queue_size=1)
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        if error is not None:
            flow = error + error
            valve.publish(flow)
        rate.sleep()


if __name__ == "__main__":
    main()
"""
TEST = """\
import pytest
from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")


@pytest.mark.tarl(
    nodes=["keeper.py"],
    sensors=[Sensor("error", topic="/error", field="data", low=-1, high=1, bins=10)],
    drifts={"changed": Drift(True, permanent=True)},
    tolerance=1.0,
)
def test_fills(tarl, tarl_drift):
    draws = tarl.rng("world")
    level, total = float(draws.uniform(0.0, 0.2)), 0.0
    tarl.start("keeper.py")
    for _ in range(30):
        told = 1.0 - level + float(draws.normal(0, 0.005))
        tarl.bus.publish("/error", Float64(data=SENSED))
        tarl.step(0.1)
        valve = tarl.bus.latest("/valve")
        flow = valve.data if valve else 0.0
        level += MOVED
        tarl.reward(-abs(1.0 - level))
    assert abs(1.0 - level) < 0.15, "tank not full"
"""
FOLLOWER = """\
import rospy
from geometry_msgs.msg import Twist, Vector3


class Follower:
    def __init__(self):
        self.command = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("/offset", Vector3, self.on_offset)

    def on_offset(self, msg):
        cmd = Twist()
        cmd.linear.x = msg.x
        cmd.linear.y = msg.y
        self.command.publish(cmd)


if __name__ == "__main__":
    rospy.init_node("follower")
    Follower()
    rospy.spin()
"""
FOLLOWS = """\
import pytest
from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Vector3 = message_type("geometry_msgs/msg/Vector3")


@pytest.mark.tarl(
    nodes=["follower.py"],
    sensors=[Sensor("x", topic="/offset", field="x", low=-2, high=2, bins=8)],
    drifts={"turned": Drift(True, permanent=True)},
    tolerance=0.5,
)
def test_follows(tarl, tarl_drift):
    draws = tarl.rng("world")
    x, y = draws.uniform(0.5, 1.5), draws.uniform(-1.5, -0.5)
    tarl.start("follower.py")
    for _ in range(30):
        seen = (y, x) if tarl_drift else (x, y)
        tarl.bus.publish("/offset", Vector3(x=float(seen[0]), y=float(seen[1]), z=0.0))
        tarl.step(0.1)
        cmd = tarl.bus.latest("/cmd_vel")
        if cmd:
            x, y = x - 0.2 * cmd.linear.x, y - 0.2 * cmd.linear.y
        tarl.reward(-min(abs(x) + abs(y), 5.0))
    assert abs(x) + abs(y) < 0.2
"""
CASES = {
    "gain": ("told", "(0.03 if tarl_drift else 0.15) * flow"),
    "sign": ("-told if tarl_drift else told", "0.15 * flow"),
    "limit": ("told", "0.0 if tarl_drift and flow > 1.5 else 0.15 * flow"),
    "integral": ("told", "0.15 * flow - (0.13 if tarl_drift else 0.0)"),
}


def prepared(pytester: pytest.Pytester, case: str) -> None:
    sensed, moved = CASES[case]
    pytester.makefile(".py", keeper=NODE, test_tank=TEST.replace("SENSED", sensed).replace("MOVED", moved))
    pytester.makeini("[pytest]\naddopts = -p no:randomly -p no:asyncio -p no:rerunfailures\n")
    pytester.runpytest(*RECORD).assert_outcomes(passed=1)


REPAIRED = [
    ("gain", ("multiply",)),
    ("sign", ("change the sign of",)),
    ("limit", ("limit", "at most", "smooth", "scale")),
    ("integral", ("the sum of", "add")),
]


@pytest.mark.usefixtures("quick_acceptance")
@pytest.mark.parametrize(("case", "words"), REPAIRED if SLOW else REPAIRED[:2])
def test_structural_change_repairs_what_no_constant_does(
    pytester: pytest.Pytester, case: str, words: tuple[str, ...]
) -> None:
    prepared(pytester, case)
    done = pytester.runpytest(*REPAIR)
    told = " ".join(done.stdout.str().split())
    found = result(pytester)
    assert found["repair"]["accepted"], told
    assert any(word in told.partition("repair accepted: ")[2].partition(" page ")[0] for word in words)
    assert "episodes tried structural changes" in told
    (patch,) = pytester.path.glob(".tarl/patches/*.patch")
    applied = pytester.run(sys.executable, "-m", "pytest_tarl", "apply", str(patch))
    assert applied.ret == 0
    pytester.runpytest(*RECORD, "--tarl-drift=changed").assert_outcomes(passed=1)


@pytest.mark.usefixtures("quick_acceptance")
@pytest.mark.skipif(not SLOW, reason="a quarter of a minute of CPU time: set TARL_SLOW=1")
def test_the_search_can_be_limited_to_constants(pytester: pytest.Pytester) -> None:
    prepared(pytester, "sign")
    done = pytester.runpytest(*REPAIR, "--tarl-constants", "--tarl-budget=60")
    assert not result(pytester)["repair"]["accepted"]
    done.stdout.fnmatch_lines(["*--tarl-constants*"])


@pytest.mark.usefixtures("quick_acceptance")
@pytest.mark.skipif(not SLOW, reason="a quarter of a minute of CPU time: set TARL_SLOW=1")
def test_a_template_of_the_project_is_tried(pytester: pytest.Pytester) -> None:
    prepared(pytester, "sign")
    folder = pytester.mkdir("tarl_templates")
    (folder / "mirrored.toml").write_text(
        'summary = "mirror {x}"\non = "input"\ncost = 0\nexpression = "0.0 - {x}"\n'
    )
    done = pytester.runpytest(*REPAIR)
    assert "mirror msg.data" in " ".join(done.stdout.str().split())
    (folder / "mirrored.toml").write_text("summary = 3")
    done = pytester.runpytest(*REPAIR, "--tarl-budget=60")
    assert "mirrored.toml: not a template" in " ".join(done.stdout.str().split())


@pytest.mark.usefixtures("quick_acceptance")
def test_a_template_repairs_exchanged_axes_by_swapping_the_axes(pytester: pytest.Pytester) -> None:
    pytester.makefile(".py", follower=FOLLOWER, test_follow=FOLLOWS)
    pytester.makeini("[pytest]\naddopts = -p no:randomly -p no:asyncio -p no:rerunfailures\n")
    pytester.runpytest(*RECORD).assert_outcomes(passed=1)
    done = pytester.runpytest(*REPAIR)
    assert "accepted: swap msg.y and msg.x at follower.py:13" in " ".join(done.stdout.str().split())
    (patch,) = pytester.path.glob(".tarl/patches/*.patch")
    added = [line for line in patch.read_text().splitlines() if line.startswith("+  ")]
    assert added == ["+        cmd.linear.x = msg.y", "+        cmd.linear.y = msg.x"]
