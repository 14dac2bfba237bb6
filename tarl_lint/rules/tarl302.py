"""TARL302: publisher and subscription of a topic have different types.

ROS refuses the connection, and no message arrives. rospy logs a warning; rclpy usually logs nothing. For
example, some nodes use `Twist` and others `TwistStamped`
(https://github.com/ros-teleop/teleop_twist_keyboard/issues/39). The rule compares only the last part of the
two type names, and only if the code names both types by constants.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.fingerprints import topic_text
from tarl_lint.model import Finding
from tarl_lint.system.hazards import at_end, single
from tarl_lint.system.model import System

CODE: Final = "TARL302"
SUMMARY: Final = "publisher and subscription of a topic have different types"

INVALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="teleop.py" name="teleop"/>
      <node pkg="robot" type="base.py" name="base"/>
    </launch>
    --- scripts/teleop.py
    import rospy
    from geometry_msgs.msg import TwistStamped
    from sensor_msgs.msg import Joy

    rospy.init_node("teleop")
    pub = rospy.Publisher("cmd_vel", TwistStamped, queue_size=1)

    def on_joy(joy):
        cmd = TwistStamped()
        cmd.twist.linear.x = joy.axes[1]
        pub.publish(cmd)

    rospy.Subscriber("joy", Joy, on_joy)
    rospy.spin()
    --- scripts/base.py
    import rospy
    from geometry_msgs.msg import Twist

    rospy.init_node("base")
    rospy.Subscriber("cmd_vel", Twist, lambda msg: print(msg.linear.x))
    rospy.spin()
    """,
)

VALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="teleop.py" name="teleop"/>
      <node pkg="robot" type="base.py" name="base"/>
    </launch>
    --- scripts/teleop.py
    import rospy
    from geometry_msgs.msg import Twist
    from sensor_msgs.msg import Joy

    rospy.init_node("teleop")
    pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)

    def on_joy(joy):
        cmd = Twist()
        cmd.linear.x = joy.axes[1]
        pub.publish(cmd)

    rospy.Subscriber("joy", Joy, on_joy)
    rospy.spin()
    --- scripts/base.py
    import rospy
    from geometry_msgs.msg import Twist

    rospy.init_node("base")
    rospy.Subscriber("cmd_vel", Twist, lambda msg: print(msg.linear.x))
    rospy.spin()
    """,
)


def findings(system: System) -> Iterator[Finding]:
    """Yield a hazard for each subscription whose type no publisher of its topic has."""
    for name, who, end in system.ends("subscribes"):
        others = {
            (them.name, single(beyond))
            for other, them, beyond in system.ends("publishes")
            if other == name and len(beyond.names) == 1
        }
        if single(end) and len(end.names) == 1 and others and all(t not in ("", end.type) for _, t in others):
            theirs = " and ".join(f"{node} publishes {kind}" for node, kind in sorted(others))
            message = f"{who.name} subscribes to {name} as {end.type}, but {theirs}"
            yield at_end(CODE, who, end, message, topic_text(end.in_code))
