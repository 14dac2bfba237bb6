"""TARL308: a remapping matches no name that the node uses.

The remapping has no effect, so the publisher and the subscription that it should connect stay separate. In the Kobuki,
the multiplexer published on `cmd_vel_mux/output`, but the launch file remapped `cmd_vel_mux/mux_cmd_vel`, a name that
no node used. The robot ignored all velocity commands (https://github.com/aliasrobotics/RVD/issues/582).

A remapping from `/cmd_vel` also matches nothing if the node uses `cmd_vel` in the namespace `/robot`, where the topic
is `/robot/cmd_vel`.

The rule reports a remapping only if it could read all nodes to which the remapping applies, with all their imports, if
the names of their topics are constant, and if no other string of the nodes equals the remapped name or ends with it.
The private name `~path` and the longer name `front/path` do not count as uses of `path`. The rule reports a remapping
of a group only if it matches nothing in any node of the group.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, get_args

from tarl_lint.model import Finding
from tarl_lint.system.hazards import at_node
from tarl_lint.system.model import Instance, Role, System
from tarl_lint.workspace.name_resolution import resolved

CODE: Final = "TARL308"
SUMMARY: Final = "a remapping matches no name that the node uses"

INVALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="keeper.py" name="keeper" ns="cart">
        <remap from="/cmd_vel" to="/wheels/cmd_vel"/>
      </node>
    </launch>
    --- scripts/keeper.py
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    rospy.init_node("keeper")
    gain = rospy.get_param("~gain", 0.5)
    pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)

    def on_odom(odom):
        cmd = Twist()
        cmd.angular.z = -gain * odom.pose.pose.position.y
        pub.publish(cmd)

    rospy.Subscriber("odom", Odometry, on_odom)
    rospy.spin()
    """,
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="keeper.py" name="keeper">
        <remap from="cmd_val" to="/wheels/cmd_vel"/>
      </node>
    </launch>
    --- scripts/keeper.py
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    rospy.init_node("keeper")
    gain = rospy.get_param("~gain", 0.5)
    pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)

    def on_odom(odom):
        cmd = Twist()
        cmd.angular.z = -gain * odom.pose.pose.position.y
        pub.publish(cmd)

    rospy.Subscriber("odom", Odometry, on_odom)
    rospy.spin()
    """,
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="keeper.py" name="keeper">
        <remap from="cmd_val" to="/wheels/cmd_vel"/>
      </node>
      <node pkg="robot" type="other.py" name="other">
        <remap from="cmd_val" to="/wheels/cmd_vel"/>
      </node>
    </launch>
    --- scripts/keeper.py
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    rospy.init_node("keeper")
    gain = rospy.get_param("~gain", 0.5)
    pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)

    def on_odom(odom):
        cmd = Twist()
        cmd.angular.z = -gain * odom.pose.pose.position.y
        pub.publish(cmd)

    rospy.Subscriber("odom", Odometry, on_odom)
    rospy.spin()
    --- scripts/other.py
    import rospy
    from geometry_msgs.msg import Twist

    rospy.init_node("other")
    rospy.Subscriber("cmd_val", Twist, print)
    rospy.spin()
    """,
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="keeper.py" name="keeper">
        <remap from="cmd_vel" to="/wheels/cmd_vel"/>
      </node>
    </launch>
    --- scripts/keeper.py
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    rospy.init_node("keeper")
    gain = rospy.get_param("~gain", 0.5)
    pub = rospy.Publisher("~cmd_vel", Twist, queue_size=1)

    def on_odom(odom):
        cmd = Twist()
        cmd.angular.z = -gain * odom.pose.pose.position.y
        pub.publish(cmd)

    rospy.loginfo("publishes on %s", "keeper/cmd_vel")
    rospy.Subscriber("odom", Odometry, on_odom)
    rospy.spin()
    """,
)

VALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="keeper.py" name="keeper">
        <remap from="cmd_vel" to="/wheels/cmd_vel"/>
      </node>
    </launch>
    --- scripts/keeper.py
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    rospy.init_node("keeper")
    gain = rospy.get_param("~gain", 0.5)
    pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)

    def on_odom(odom):
        cmd = Twist()
        cmd.angular.z = -gain * odom.pose.pose.position.y
        pub.publish(cmd)

    rospy.Subscriber("odom", Odometry, on_odom)
    rospy.spin()
    """,
)

_OF_ROS: Final = frozenset(
    [
        "tf",
        "tf_static",
        "clock",
        "rosout",
        "parameter_events",
        "diagnostics",
        "robot_description",
        "parameter_descriptions",
        "parameter_updates",
        "set_parameters",
    ]
)


_ACTIONS: Final[tuple[Role, ...]] = ("asks", "performs")
_PARTS: Final = ("goal", "cancel", "status", "feedback", "result")  # topics of an action in ROS 1


def findings(system: System) -> Iterator[Finding]:
    """Yield a hazard for each remapping that matches nothing in any of the nodes to which it applies."""
    carriers: dict[tuple[str, str, str], list[Instance]] = {}
    for instance in system.instances:
        for number, (old, new) in enumerate(instance.node.remaps):
            own = "" if number < instance.node.inherited else f"{instance.name} {instance.node.line}"
            carriers.setdefault((old, new, own), []).append(instance)
    for (old, new, _), instances in carriers.items():
        if all(_unmatched(instance, old) for instance in instances):
            first = instances[0]
            known = _used_instead(first, old)
            message = f"{first.name} uses no name {old}, so renaming it to {new} has no effect{known}"
            yield at_node(CODE, first, message, old)


def _used_instead(instance: Instance, old: str) -> str:
    """Return the last part of the message: the name that was probably meant, or else the names that the node uses."""
    used = sorted({name for role in get_args(Role) for _, end in instance.ends(role) for name in end.names})
    own, namespace = instance.name.rpartition("/")[2], instance.node.namespace
    near = [name for name in used if _last(name) == _last(old)]
    if near:
        return f"; it uses {near[0]}, which is {resolved(near[0], namespace, own)} here"
    return f"; it uses {', '.join(used[:4])}{' …' if len(used) > 4 else ''}" if used else ""


def _last(name: str) -> str:
    return name.strip("~/").rpartition("/")[2]


def _unmatched(instance: Instance, old: str) -> bool:
    """Return whether a node certainly uses no such name."""
    last = _last(old)
    if (
        not instance.whole
        or instance.silent
        or old.startswith("_")
        or last in _OF_ROS
        or "$(" in old
        or ":" in old
    ):
        return False
    own, namespace = instance.name.rpartition("/")[2], instance.node.namespace
    names = {name for end in instance.certain for name in end.names}
    names |= {f"{name}/{part}" for end in instance.certain if end.role in _ACTIONS for name in end.names
              for part in _PARTS}  # fmt: skip
    used = {resolved(name, namespace, own) for name in names}
    words = frozenset[str]()
    if instance.interface is not None:
        words = instance.interface.words - instance.interface.private_words - names
    # the last part of a name may be below a namespace
    whole = resolved(old, namespace, own)
    said = any(whole.endswith(f"/{word.strip('/')}") for word in words if word.strip("/"))
    return not said and whole not in used
