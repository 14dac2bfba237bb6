"""TARL301: a subscription has no publisher, and a publisher with a similar name has no subscriber.

The two ends were probably meant to be connected. The types of both ends are equal, and the names differ only by a
namespace (`/cmd_vel` and `/robot/cmd_vel`) or by one letter. The robot starts without an error and does not move. For
this reason, the keyboard teleoperation of the Kobuki had no effect (https://github.com/aliasrobotics/RVD/issues/581).
Robots also stand still if they are launched in a namespace but their code publishes on `/cmd_vel`
(https://github.com/UoY-RoboStar/AURO/issues/5).

Names are similar as well if a slash stands for an underscore (`/water/current` and `/water_current`), if words are
abbreviated (`/cmd` and `/command`) or in another order (`/scan_filtered` and `/filtered_scan`), or if they have the
same meaning (`/gripper/state` and `/gripper/status`). Two private names of the same node are similar, such as
`/speech/finished` and `/speech/finish`. If the launch file names the node `lift` of the code `elevator`, its topic
`~floor` is `/elevator/floor`, and `/lift/floor` has no publisher. Names that differ in a word of one or two letters,
such as `wheel_fl` and `wheel_fr`, are not similar, nor are names with fewer than five letters, unless two letters are
exchanged (`/sacn`).

A node that was not read, that computes the names of its topics, or that a missing launch file may start, might be the
other end. Then the rule reports only misspelt names, not different namespaces and abbreviations, and only if no such
node mentions one of the names in its remappings, parameters, arguments or strings. Such a node counts only if it may
use the type: a laser driver publishes no `Twist`, the types of well-known packages are known, and C++ programs of the
workspace use only types that their files name. The driver of a sensor, which is known by its package or by a word such
as `lidar` or `gps` in its name, counts only if it may also use one of the names: if it mentions the name, if the name
is private to it, or if the last part has only words of such drivers, as `/rear/scan` and `/points_raw` do, but
`/obstacles` does not.

The rule reports nothing if no publisher has a similar name, because sensors, simulators and teleoperation are often
started elsewhere: of 23 such topics in launch files of which every part is known, one was a mistake. The report of
`--launch` lists these topics under "No publisher here", and JSON under `one_sided`; they do not fail the run.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

from tarl_lint.fingerprints import topic_text
from tarl_lint.model import Finding
from tarl_lint.system.hazards import at_end, differ, single
from tarl_lint.system.lonely_ends import Lonely, near
from tarl_lint.system.model import Instance, System

CODE: Final = "TARL301"
SUMMARY: Final = "a subscription has no publisher, and a publisher with a similar name has no subscriber"

INVALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="teleop.py" name="teleop"/>
      <group ns="left">
        <node pkg="robot" type="base.py" name="base"/>
      </group>
    </launch>
    --- scripts/teleop.py
    import rospy
    from geometry_msgs.msg import Twist
    from sensor_msgs.msg import Joy

    rospy.init_node("teleop")
    pub = rospy.Publisher("/cmd_vel", Twist, queue_size=1)

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

VALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <group ns="left">
        <node pkg="robot" type="teleop.py" name="teleop"/>
        <node pkg="robot" type="base.py" name="base"/>
      </group>
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
      <node pkg="robot" type="teleop.py" name="teleop"/>
      <group ns="left">
        <node pkg="robot" type="base.py" name="base"/>
      </group>
      <node pkg="other" type="mux" name="mux"/>
    </launch>
    --- scripts/teleop.py
    import rospy
    from geometry_msgs.msg import Twist
    from sensor_msgs.msg import Joy

    rospy.init_node("teleop")
    pub = rospy.Publisher("/cmd_vel", Twist, queue_size=1)

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
    """Yield a hazard for each subscription that differs from a publisher only in the name of the topic."""
    published, subscribed = (
        {name for name, _, _ in system.named(role)} for role in ("publishes", "subscribes")
    )
    lonely = [
        Lonely(name, who, replace(end, type=end.type or _passed_on(who, system)))
        for name, who, end in system.ends("publishes")
        if name not in subscribed
    ]
    for name, who, end in system.ends("subscribes"):
        if name in published or not single(end) or len(end.names) > 1:
            continue
        alike = near(
            system,
            Lonely(name, who, end),
            [one for one in lonely if one.node is not who and single(one.end) and not differ(end, one.end)],
        )
        if alike:
            message = f"{who.name} subscribes to {name} ({end.type}), which no node publishes; "
            message += (
                " and ".join(f"{one.node.name} publishes {one.name}" for one in alike)
                + ", to which no node subscribes"
            )
            yield at_end(CODE, who, end, message, topic_text(end.in_code))


def _passed_on(who: Instance, system: System) -> str:
    """Return the type of the messages that a relay passes on: that of the publishers of its input; "" if unknown."""
    heard = (
        {name for name, _ in who.ends("subscribes")} if who.interface is None and who.known.through else set()
    )
    types = {end.type for name, _, end in system.named("publishes") if name in heard}
    return types.pop() if len(types) == 1 else ""
