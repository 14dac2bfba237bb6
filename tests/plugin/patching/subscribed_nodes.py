"""Nodes in four styles, before and after a repair whose condition reads a topic that the node does not subscribe to."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pytest_tarl.model import Guard
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.rewriting import rewrite
from tests.plugin.patching.repairs import (
    MUD,
    TOPICS,
    HandMade,
)

SCRIPT = '''\
#!/usr/bin/env python3
"""Drive."""
import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

GAIN = 1.0
pos = None


# Keeps the position.
def callback(msg):
    global pos
    pos = msg.pose.pose.position.x


def step(pub):
    pub.publish(5 * pos)


if __name__ == "__main__":
    rospy.init_node("n")
    rospy.Subscriber("/odom", Odometry, callback)
    pub = rospy.Publisher("/vel", Float64, queue_size=1)
'''

PATCHED_SCRIPT = '''\
#!/usr/bin/env python3
"""Drive."""
import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool, Float64

GAIN = 1.0
pos = None
terrain = None


def on_terrain(message):
    global terrain
    terrain = message.data


# Keeps the position.
def callback(msg):
    global pos
    pos = msg.pose.pose.position.x


def step(pub):
    if terrain:
        pub.publish(12.0 * pos)
    else:
        pub.publish(5 * pos)


if __name__ == "__main__":
    rospy.init_node("n")
    rospy.Subscriber("/odom", Odometry, callback)
    rospy.Subscriber("/terrain", Bool, on_terrain)
    pub = rospy.Publisher("/vel", Float64, queue_size=1)
'''

ROSPY_CLASS = """\
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry


class Driver:
    def __init__(self):
        rospy.init_node("driver")
        self.pub = rospy.Publisher('cmd', Twist, queue_size=1)
        self.sub = rospy.Subscriber('/odom', Odometry, self.on_odom)

    def on_odom(self, msg):
        self.pub.publish(5 * msg.pose.pose.position.x)


driver = Driver()
"""

PATCHED_ROSPY_CLASS = """\
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool


class Driver:
    def __init__(self):
        rospy.init_node("driver")
        self.pub = rospy.Publisher('cmd', Twist, queue_size=1)
        self.terrain = None
        self.sub = rospy.Subscriber('/odom', Odometry, self.on_odom)
        rospy.Subscriber('/terrain', Bool, self.on_terrain)

    def on_terrain(self, message):
        self.terrain = message.data

    def on_odom(self, msg):
        if self.terrain:
            self.pub.publish(12.0 * msg.pose.pose.position.x)
        else:
            self.pub.publish(5 * msg.pose.pose.position.x)


driver = Driver()
"""

RCLPY_CLASS = """\
import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import (
    Float64,
)


class Driver(Node):
    def __init__(self) -> None:
        super().__init__("driver")
        self.pub = self.create_publisher(Float64, "/vel", 10)
        self.create_subscription(Odometry, "/odom", self.on_odom, 10)

    def on_odom(self, msg: Odometry) -> None:
        self.pub.publish(5 * msg.pose.pose.position.x)


rclpy.init()
driver = Driver()
"""

PATCHED_RCLPY_CLASS = """\
import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import (
    Bool, Float64,
)


class Driver(Node):
    def __init__(self) -> None:
        super().__init__("driver")
        self.pub = self.create_publisher(Float64, "/vel", 10)
        self.terrain = None
        self.create_subscription(Odometry, "/odom", self.on_odom, 10)
        self.create_subscription(Bool, "/terrain", self.on_terrain, 10)

    def on_terrain(self, message: Bool) -> None:
        self.terrain = message.data

    def on_odom(self, msg: Odometry) -> None:
        if self.terrain:
            self.pub.publish(12.0 * msg.pose.pose.position.x)
        else:
            self.pub.publish(5 * msg.pose.pose.position.x)


rclpy.init()
driver = Driver()
"""

RCLPY_FUNCTION = """\
import rclpy
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool, Float64


def main():
    rclpy.init()
    node = rclpy.create_node("driver")
    pub = node.create_publisher(Float64, "/vel", 10)

    def on_odom(msg):
        pub.publish(5 * msg.pose.pose.position.x)

    node.create_subscription(Odometry, "/odom", on_odom, 10)


main()
"""

PATCHED_RCLPY_FUNCTION = """\
import rclpy
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool, Float64


terrain = None


def on_terrain(message):
    global terrain
    terrain = message.data


def main():
    rclpy.init()
    node = rclpy.create_node("driver")
    pub = node.create_publisher(Float64, "/vel", 10)

    def on_odom(msg):
        if terrain:
            pub.publish(12.0 * msg.pose.pose.position.x)
        else:
            pub.publish(5 * msg.pose.pose.position.x)

    node.create_subscription(Odometry, "/odom", on_odom, 10)
    node.create_subscription(Bool, "/terrain", on_terrain, 10)


main()
"""

NODES = {
    "rospy script": (SCRIPT, PATCHED_SCRIPT, 'rospy.Subscriber("/odom", Odometry, callback)', "rospy.Subscriber"),
    "rospy class": (
        ROSPY_CLASS, PATCHED_ROSPY_CLASS, "rospy.Subscriber('/odom', Odometry, self.on_odom)", "rospy.Subscriber",
    ),
    "rclpy class": (
        RCLPY_CLASS, PATCHED_RCLPY_CLASS, 'self.create_subscription(Odometry, "/odom", self.on_odom, 10)', "rclpy",
    ),
    "rclpy function": (
        RCLPY_FUNCTION, PATCHED_RCLPY_FUNCTION, 'node.create_subscription(Odometry, "/odom", on_odom, 10)', "rclpy",
    ),
}  # fmt: skip


def repaired(
    sources: Mapping[str, str], flows: Any = (), guard: Guard = MUD, topics: Any = TOPICS, held: Any = ()
) -> dict[str, str]:
    """Change the first 5 of the first file to 12 under the condition; return all files, changed or not."""
    analysis = HandMade(sources, flows, dict(held))
    changed = rewrite(analysis, [Mutation(analysis.operand("5", 5, "5 *"), 12.0)], guard, topics)
    return {**sources, **changed}
