"""TARL305: two nodes publish commands on the same topic.

The last message wins, so the robot jerks as it follows both nodes in turn. Give each node a separate topic, and let a
multiplexer such as `twist_mux` choose. Clearpath's robots had this defect: both the game controller and the autonomous
control published on `cmd_vel` (https://github.com/clearpathrobotics/clearpath_common/pull/232).

The rule covers commands such as `Twist` and `JointTrajectory`, and numbers on topics such as `wheel/command` or
`left_thrust`. Each of the two nodes must compute its commands from a subscribed topic, or publish them in a timer or
loop, as in a patrol that follows the clock. One of the two may also be a common program without source in the
workspace, such as `teleop_twist_joy`, `move_base` and `twist_mux`.

The rule does not cover nodes that only stop the robot, nodes that publish once, and nodes that are started under a
condition known only on the robot, because two such nodes may be alternatives.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.model import Finding
from tarl_lint.system.command_topics import is_command
from tarl_lint.system.hazards import at_node
from tarl_lint.system.model import Endpoint, Instance, System, place_of

CODE: Final = "TARL305"
SUMMARY: Final = "two nodes publish commands on the same topic"

INVALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="teleop.py" name="teleop"/>
      <node pkg="robot" type="planner.py" name="planner"/>
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
    --- scripts/planner.py
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Path

    rospy.init_node("planner")
    pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)

    def on_path(path):
        cmd = Twist()
        cmd.linear.x = path.poses[0].pose.position.x
        pub.publish(cmd)

    rospy.Subscriber("path", Path, on_path)
    rospy.spin()
    """,
)

VALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="teleop.py" name="teleop">
        <remap from="cmd_vel" to="joy_vel"/>
      </node>
      <node pkg="robot" type="planner.py" name="planner"/>
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
    --- scripts/planner.py
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Path

    rospy.init_node("planner")
    pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)

    def on_path(path):
        cmd = Twist()
        cmd.linear.x = path.poses[0].pose.position.x
        pub.publish(cmd)

    rospy.Subscriber("path", Path, on_path)
    rospy.spin()
    """,
)


def findings(system: System) -> Iterator[Finding]:
    """Yield a hazard for each topic of commands on which several nodes publish."""
    authors: dict[str, dict[str, tuple[Instance, str]]] = {}
    for instance in system.instances:
        for finding in instance.interface.flows if instance.interface is not None else ():
            sink = finding.flow.sink if finding.flow is not None else None
            if (
                sink is None
                or instance.node.condition
                or not is_command(sink.type, sink.topics)
                or len(sink.topics) != 1
            ):
                continue
            topic = instance.resolve(sink.topics[0])
            authors.setdefault(topic, {}).setdefault(instance.name, (instance, sink.topics[0]))
    for topic, instance, end in system.named("publishes"):
        if (
            end.driven
            and len(end.names) == 1
            and not instance.node.condition
            and is_command(end.type, end.names)
        ):
            authors.setdefault(topic, {}).setdefault(instance.name, (instance, end.names[0]))
    for topic, instance, end in _of_known_programs(system):
        if topic in authors:
            authors[topic].setdefault(instance.name, (instance, end.names[0]))
    for topic, found in sorted(authors.items()):
        (_, (first, _)), *others = found.items()
        for name, (instance, in_code) in others:
            message = f"{name} and {first.name} both publish commands on {topic}: let a multiplexer choose"
            yield at_node(
                CODE, instance, message, f"{in_code}, beside {first.node.package}/{first.node.executable}"
            )


def _of_known_programs(system: System) -> Iterator[tuple[str, Instance, Endpoint]]:
    """Yield the commands of programs that are known without source, such as teleoperation and multiplexers."""
    for topic, instance, end in system.named("publishes"):
        known = instance.interface is None and not instance.node.condition and end.span == place_of(instance)
        # a two-way bridge publishes messages of other nodes
        both = any(name == topic for name, _ in instance.named("subscribes"))
        if known and not both and is_command(end.type, (topic,)):
            yield topic, instance, end
