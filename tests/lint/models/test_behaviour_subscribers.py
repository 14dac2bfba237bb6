"""Behaviours of py_trees_ros that subscribe: the keys that they fill, and their status."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import operator, py_trees, py_trees_ros, rclpy
from py_trees.common import Status
from std_msgs.msg import Bool, Float64
from geometry_msgs.msg import PoseStamped
node = rclpy.create_node("tree")
out = node.create_publisher(Float64, "out", 1)
class Tell(py_trees.behaviour.Behaviour):
    def update(self):
        out.publish(Float64(data=1.0))  # TELL
        return Status.SUCCESS
"""
TAIL = """
tree = py_trees_ros.trees.BehaviourTree(root)
tree.tick_tock(period_ms=500)
rclpy.spin(tree.node)
"""
# Programs, each below its title and the mark of the publish call of `Tell`.
PROGRAMS = """\
### the whole message under a key: clean
class Show(py_trees.behaviour.Behaviour):
    def update(self):
        board = self.attach_blackboard_client("show")
        out.publish(Float64(data=board.pose.pose.position.x))  # pose:data
        return Status.SUCCESS
root = py_trees.composites.Sequence("root", True)
root.add_children([
    py_trees_ros.subscribers.ToBlackboard(
        name="in", topic_name="/pose", topic_type=PoseStamped, qos_profile=1, blackboard_variables={"pose": None}
    ),
    Show("show"),
    Tell("tell"),
])
### a field under a key, by position and in ROS 1: clean
class Show(py_trees.behaviour.Behaviour):
    def update(self):
        out.publish(py_trees.blackboard.Blackboard().get("x"))  # pose:data
        out.publish(py_trees.blackboard.Blackboard().get("other"))  # clean
        return Status.SUCCESS
root = py_trees.composites.Sequence("root", children=[
    py_trees_ros.subscribers.ToBlackboard("in", "pose", PoseStamped, {"x": "pose.position.x"}),
    Show("show"),
    Tell("tell"),
])
### a check of a key that a subscriber fills: level:control
root = py_trees.composites.Sequence("root", False)
level = py_trees_ros.subscribers.ToBlackboard("in", "level", Float64, 1, blackboard_variables={"level": "data"})
low = py_trees.behaviours.CheckBlackboardVariableValue(
    "low", py_trees.common.ComparisonExpression("level", 1.0, operator.lt)
)
root.add_children([level, low, Tell("tell")])
### the status of CheckData follows the message: door:control
root = py_trees.composites.Sequence("root", False)
door = py_trees_ros.subscribers.CheckData(
    name="door", topic_name="door", topic_type=Bool, qos_profile=1, variable_name="data", expected_value=True
)
root.add_children([door, Tell("tell")])
### a Selector asks the second child if the first one fails: door:control gate:control
root = py_trees.composites.Selector("root", False)
doors = [
    py_trees_ros.subscribers.CheckData(name, name, Bool, 1, variable_name="data", expected_value=True)
    for name in ("door", "gate")
]
root.add_children([*doors, Tell("tell")])
### whether a message has arrived is not data: clean
root = py_trees.composites.Sequence("root", False)
root.add_child(py_trees_ros.subscribers.WaitForData("in", "go", Bool, 1))
root.add_child(py_trees_ros.subscribers.EventToBlackboard("event", "pressed", 1, variable_name="pressed"))
root.add_child(Tell("tell"))
### the battery: clean
class Show(py_trees.behaviour.Behaviour):
    def update(self):
        board = self.attach_blackboard_client("show")
        out.publish(Float64(data=board.battery.percentage))  # battery:data
        out.publish(Float64(data=board.battery_low_warning))  # battery:data
        return Status.SUCCESS
root = py_trees.composites.Parallel("root", py_trees.common.ParallelPolicy.SuccessOnAll())
root.add_child(py_trees_ros.battery.ToBlackboard(name="in", topic_name="battery", qos_profile=1, threshold=30.0))
root.add_children([Show("show"), Tell("tell")])
### a handler keeps the last message: pose:control
class Near(py_trees_ros.subscribers.Handler):
    def __init__(self, name, topic):
        super().__init__(name=name, topic_name=topic, topic_type=PoseStamped, qos_profile=1)
    def update(self):
        with self.data_guard:
            if self.msg is None:
                return Status.RUNNING
            out.publish(Float64(data=self.msg.pose.position.x))  # pose:data
            return Status.SUCCESS if self.msg.pose.position.x < 1.0 else Status.FAILURE
root = py_trees.composites.Sequence("root", False)
root.add_children([Near("near", "pose"), Tell("tell")])
### subscribers in a table: clean
class Show(py_trees.behaviour.Behaviour):
    def update(self):
        board = self.attach_blackboard_client("show")
        out.publish(board.left)  # left:data
        return Status.SUCCESS
root = py_trees.composites.Sequence("root", False)
for name in ("left", "right"):
    root.add_child(py_trees_ros.subscribers.ToBlackboard(name, name, Float64, 1, blackboard_variables={name: "data"}))
root.add_children([Show("show"), Tell("tell")])
"""


@pytest.mark.parametrize("title", sections(PROGRAMS))
def test_subscribers_of_behaviour_trees(title: str) -> None:
    head = HEAD.replace("TELL", title.rpartition(": ")[2])
    assert differing_topics(head + sections(PROGRAMS)[title] + TAIL) == {}
