"""TARL310: two nodes of a launch file have the same name.

ROS 1 refuses the launch file as a whole: *roslaunch file contains multiple nodes named …*. In ROS 2, both nodes start,
and their parameters and services have the same names. A request then reaches either of the two nodes at random. For
example, the launch files of a perception stack could not be started with one combination of arguments, because two
nodes were named `to_pose_array` (https://github.com/strands-project/strands_perception_people/issues/212).

The rule compares full names, including the namespace. Two nodes named `$(anon view)` in one file also get the same
name. The rule does not cover nodes that an event starts, nodes without source to which the launch file gives no name,
and nodes that are started under a condition known only on the robot, because two such nodes may be alternatives.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.files import shown
from tarl_lint.model import Finding
from tarl_lint.system.hazards import at_node
from tarl_lint.system.model import Instance, System

CODE: Final = "TARL310"
SUMMARY: Final = "two nodes of a launch file have the same name"

INVALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="filter.py" name="filter"/>
      <group ns="/">
        <node pkg="robot" type="filter.py" name="filter"/>
      </group>
    </launch>
    --- scripts/filter.py
    import rospy
    from sensor_msgs.msg import LaserScan

    rospy.init_node("filter")
    pub = rospy.Publisher("filtered", LaserScan, queue_size=1)
    rospy.Subscriber("scan", LaserScan, pub.publish)
    rospy.spin()
    """,
)

VALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="filter.py" name="filter"/>
      <node pkg="robot" type="filter.py" name="filter" ns="rear"/>
      <node pkg="robot" type="filter.py" name="$(anon filter)"/>
      <node pkg="robot" type="filter.py" name="$(anon other)"/>
    </launch>
    --- scripts/filter.py
    import rospy
    from sensor_msgs.msg import LaserScan

    rospy.init_node("filter")
    pub = rospy.Publisher("filtered", LaserScan, queue_size=1)
    rospy.Subscriber("scan", LaserScan, pub.publish)
    rospy.spin()
    """,
)


def findings(system: System) -> Iterator[Finding]:
    """Yield a hazard for each node that has the same name as an earlier node."""
    if system.file.is_dir():
        return  # the system combines several launch files, which need not run together
    first: dict[tuple[str, str], Instance] = {}
    for instance in system.instances:
        name = instance.name, instance.node.anonymous
        other = first.setdefault(name, instance) if _named(instance) else instance
        if other is not instance:
            place = f"{shown(other.node.file)}:{other.node.line}"
            message = f"{instance.name} is started twice, also at {place}: give each node its own name"
            yield at_node(CODE, instance, message, instance.name.rpartition("/")[2])


def _named(instance: Instance) -> bool:
    """Return whether a node is certainly started, and its name is known."""
    node = instance.node
    known = bool(node.name) or (instance.interface is not None and bool(instance.interface.name))
    return known and not node.event and not node.condition and "$(" not in instance.name
