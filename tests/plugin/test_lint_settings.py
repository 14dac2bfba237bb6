"""The plugin applies what the settings of tarl-lint say about the code of a node."""

from __future__ import annotations

import pytest

from tests.plugin.tank import RECORD, changed

BUS = """\
import rospy
from std_msgs.msg import Float64

_publisher = rospy.Publisher("/valve", Float64, queue_size=1)
send = getattr(_publisher, "pub" + "lish")
"""
FOLLOWER = """\
import rospy
import tf
from geometry_msgs.msg import Twist

GAIN = 0.5


def main():
    rospy.init_node("follower")
    listener = tf.TransformListener()
    command = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        rate.sleep()
        try:
            there, _ = listener.lookupTransform("robot", "leader", rospy.Time(0))
        except tf.Exception:
            continue
        twist = Twist()
        twist.linear.x = GAIN * there[0]
        command.publish(twist)


if __name__ == "__main__":
    main()
"""
FOLLOWS = """\
import pytest
from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

TFMessage, Stamped = message_type("tf2_msgs/TFMessage"), message_type("geometry_msgs/TransformStamped")


def ahead(message):
    return message.transforms[0].transform.translation.x


@pytest.mark.tarl(
    nodes=["follower.py"],
    sensors=[Sensor("gap", topic="/tf", field=ahead, low=0, high=4, bins=4)],
    drifts={},
    episodes=16,
)
def test_follows(tarl, tarl_drift):
    gap = tarl.rng("world").uniform(2, 3)
    tarl.start("follower.py")
    for _ in range(60):
        stamped = Stamped()
        stamped.header.frame_id, stamped.child_frame_id = "robot", "leader"
        stamped.transform.translation.x, stamped.transform.rotation.w = gap, 1.0
        tarl.bus.publish("/tf", TFMessage(transforms=[stamped]))
        tarl.step(0.1)
        command = tarl.bus.latest("/cmd_vel")
        gap -= 0.1 * (command.linear.x if command else 0.0)
        tarl.reward(-gap)
    assert gap < 1
"""


@pytest.fixture
def follower(pytester: pytest.Pytester) -> pytest.Pytester:
    pytester.makepyfile(follower=FOLLOWER, test_follower=FOLLOWS)
    return pytester


def test_a_node_that_only_looks_up_transforms_is_recorded(follower: pytest.Pytester) -> None:
    result = follower.runpytest(*RECORD)
    result.assert_outcomes(passed=1)
    result.stdout.fnmatch_lines(["*recorded ATR*"])


def test_tf2_setting_makes_look_ups_sources(follower: pytest.Pytester) -> None:
    follower.makepyprojecttoml("[tool.tarl-lint]\ntf2 = false\n")
    result = follower.runpytest(*RECORD)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*No flow from a subscription to a publish call*"])


def test_a_sink_of_the_settings_is_a_publish_call(tank: pytest.Pytester) -> None:
    tank.makepyfile(bus=BUS)
    changed(tank, "keeper", "def main", "def send(flow):\n    import bus\n\n    bus.send(flow)\n\n\ndef main")
    changed(tank, "keeper", "valve.publish(flow)", "send(flow)")
    tank.runpytest(*RECORD).assert_outcomes(failed=1)
    tank.makepyprojecttoml('[tool.tarl-lint]\nsinks = ["bus.send"]\n')
    tank.runpytest(*RECORD).assert_outcomes(passed=1)


def test_an_invalid_setting_is_reported(tank: pytest.Pytester) -> None:
    tank.makepyprojecttoml("[tool.tarl-lint]\ntf2 = 3\n")
    result = tank.runpytest(*RECORD)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*tf2*true or false*"])
