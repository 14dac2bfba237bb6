"""TARL302: publisher and subscription of a topic, or client and server of a service, have different types.

ROS refuses the connection, and no message arrives. rospy logs a warning; rclpy usually logs nothing. For example, some
nodes use `Twist` and others `TwistStamped` (https://github.com/ros-teleop/teleop_twist_keyboard/issues/39). Types of
two packages may also have the same name, such as `std_msgs/String` and `my_msgs/String`.

The rule compares clients and servers of a service or an action in the same way. If their types differ, a call fails in
ROS 1, and the client waits forever in ROS 2.

The rule considers only types that the code names directly. It compares the packages of two types only if both packages
are known; if a program imports a message class from one of its own modules, the package is unknown.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.fingerprints import topic_text
from tarl_lint.model import Finding
from tarl_lint.system.hazards import at_end, differ
from tarl_lint.system.model import Endpoint, Role, System
from tarl_lint.workspace.conditions import exclusive

CODE: Final = "TARL302"
SUMMARY: Final = (
    "publisher and subscription of a topic, or client and server of a service, have different types"
)

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
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="lamp.py" name="lamp"/>
      <node pkg="robot" type="desk.py" name="desk"/>
    </launch>
    --- scripts/desk.py
    import rospy
    from std_msgs.msg import ColorRGBA
    from sensor_msgs.msg import Joy

    rospy.init_node("desk")
    pub = rospy.Publisher("color", ColorRGBA, queue_size=1)
    rospy.Subscriber("joy", Joy, lambda joy: pub.publish(ColorRGBA(r=joy.axes[0])))
    rospy.spin()
    --- scripts/lamp.py
    import rospy
    from lamp_msgs.msg import ColorRGBA

    rospy.init_node("lamp")
    rospy.Subscriber("color", ColorRGBA, lambda msg: print(msg.r))
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
    """
    --- launch/robot.launch
    <launch>
      <arg name="stamped"/>
      <node pkg="robot" type="teleop.py" name="teleop"/>
      <node pkg="robot" type="base.py" name="base" unless="$(arg stamped)"/>
      <node pkg="robot" type="stamped.py" name="base" if="$(arg stamped)"/>
      <node pkg="robot" type="stamper.py" name="stamper" if="$(arg stamped)"/>
    </launch>
    --- scripts/teleop.py
    import rospy
    from geometry_msgs.msg import Twist
    from sensor_msgs.msg import Joy

    rospy.init_node("teleop")
    pub = rospy.Publisher("joy_vel", Twist, queue_size=1)
    rospy.Subscriber("joy", Joy, lambda joy: pub.publish(Twist()))
    rospy.spin()
    --- scripts/base.py
    import rospy
    from geometry_msgs.msg import Twist

    rospy.init_node("base")
    rospy.Subscriber("cmd_vel", Twist, lambda msg: print(msg.linear.x))
    rospy.spin()
    --- scripts/stamped.py
    import rospy
    from geometry_msgs.msg import TwistStamped

    rospy.init_node("base")
    rospy.Subscriber("cmd_vel", TwistStamped, lambda msg: print(msg.twist.linear.x))
    rospy.spin()
    --- scripts/stamper.py
    import rospy
    from geometry_msgs.msg import Twist, TwistStamped

    rospy.init_node("stamper")
    pub = rospy.Publisher("cmd_vel", TwistStamped, queue_size=1)
    rospy.Subscriber("joy_vel", Twist, lambda msg: pub.publish(TwistStamped(twist=msg)))
    rospy.spin()
    """,
)


# role of an end → role of the other end, and what the message says about both
_ROLES: Final[tuple[tuple[Role, Role, str, str], ...]] = (
    ("subscribes", "publishes", "subscribes to", "publishes"),
    ("calls", "serves", "calls", "offers"),
    ("asks", "performs", "sends goals to", "performs"),
)


def findings(system: System) -> Iterator[Finding]:
    """Yield a hazard for each subscription or client whose type differs from all other ends of its topic or service."""
    for role, opposite, does, others_do in _ROLES:
        for name, who, end in system.named(role):
            others = {
                (them.name, beyond)
                for other, them, beyond in system.named(opposite)
                if other == name and len(beyond.names) == 1 and not exclusive(who.node, them.node)
            }
            if len(end.names) == 1 and others and all(differ(end, beyond) for _, beyond in others):
                alike = any(beyond.type == end.type for _, beyond in others)
                offered = sorted((node, _shown(beyond, alike)) for node, beyond in others)
                theirs = " and ".join(f"{node} {others_do} {kind}" for node, kind in dict.fromkeys(offered))
                message = f"{who.name} {does} {name} as {_shown(end, alike)}, but {theirs}"
                yield at_end(CODE, who, end, message, topic_text(end.in_code))


def _shown(endpoint: Endpoint, alike: bool) -> str:
    return endpoint.whole_type if alike and endpoint.whole_type else endpoint.type
