"""With the setting `tf2`, look-ups and tests of transforms are sources, in the styles of tf and tf2."""

from __future__ import annotations

from textwrap import indent

import pytest

from tarl_lint.settings.config import Config
from tests.lint.models.marked import differing, flows

HEAD = """\
import rospy, tf, tf2_ros, tf2_geometry_msgs
from std_msgs.msg import Float64

out = rospy.Publisher("out", Float64, queue_size=1)
listener = tf.TransformListener()
buffer = tf2_ros.Buffer()

def step(point, pose, scaler):
"""
# Bodies of a function, each below its title.
PROGRAMS = """\
### tf returns what it transforms
out.publish(listener.transformPose("map", pose).pose)  # data
out.publish(listener.transformPoint("map", point).point.x)  # data
out.publish(listener.transformVector3("map", point))  # data
out.publish(listener.transformPointCloud("map", point))  # data
out.publish(listener.transformQuaternion("map", point))  # data
out.publish(listener.asMatrix("map", point.header)[0][3])  # data
out.publish(listener.other("map", point))  # clean
### tf2 returns what it transforms
out.publish(buffer.transform(point, "map").point.x)  # data
out.publish(buffer.transform_full(point, "map", rospy.Time(0), "odom"))  # data
out.publish(buffer.lookup_transform_full("map", rospy.Time(0), "base", rospy.Time(0), "odom"))  # data
### transform of another class
out.publish(scaler.transform(point))  # clean
### clients of a buffer server
out.publish(tf2_ros.BufferClient("tf2_buffer_server").transform(point, "map"))  # data
### a class that inherits from a buffer
class Ours(tf2_ros.Buffer):
    pass
out.publish(Ours().transform(point, "map"))  # data
### a future
future = buffer.lookup_transform_async("map", "base", rospy.Time(0))
future.add_done_callback(lambda done: out.publish(done.result().transform.translation.x))  # data
### a test of tf2
if buffer.can_transform("map", "base", rospy.Time(0)):
    out.publish(1.0)  # control
out.publish(2.0)  # clean
### a test of tf2 that leaves
if not buffer.can_transform("map", "base", rospy.Time(0)):
    return
out.publish(1.0)  # control
### a test that stores its result
ready = listener.canTransform("map", "base", rospy.Time(0))
out.publish(1.0 if ready else 0.0)  # control
### frames that exist
if listener.frameExists("map") and listener.frameExists("base"):
    out.publish(1.0)  # control
else:
    out.publish(2.0)  # control
### the time of the newest transform
age = rospy.Time.now() - listener.getLatestCommonTime("map", "base")
out.publish(age.to_sec())  # data
### a wait that may fail
try:
    listener.waitForTransform("map", "base", rospy.Time(0), rospy.Duration(1.0))
except tf.Exception:
    out.publish(0.0)  # control
    return
out.publish(1.0)  # control
### a wait that nothing catches
listener.waitForTransform("map", "base", rospy.Time(0), rospy.Duration(1.0))
out.publish(1.0)  # clean
### a transform that may fail
try:
    there = listener.transformPoint("map", point)
except tf.TransformException:
    return
out.publish(1.0)  # control
"""
CASES = {
    title: HEAD + indent(body, "    ") + "\nrospy.Timer(rospy.Duration(1.0), step)\n"
    for title, _, body in (part.partition("\n") for part in PROGRAMS.split("### ")[1:])
}


@pytest.mark.parametrize("title", CASES)
def test_look_ups_and_tests_of_transforms_are_sources(title: str) -> None:
    text = CASES[title]
    found = flows(text, Config(tf2=True))
    assert differing(text, found) == {}
    assert {name for flow in found for name in flow.source.topics} <= {"/tf"}


@pytest.mark.parametrize("title", CASES)
def test_without_the_setting_transforms_are_not_sources(title: str) -> None:
    assert not flows(CASES[title])
