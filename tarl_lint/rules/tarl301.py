"""TARL301: a subscription has no publisher, and a publisher with a similar name has no subscriber.

The two were probably meant to be connected: they have the same message type, and their names differ only by a namespace
(`/cmd_vel` and `/robot/cmd_vel`) or by one letter. The robot starts without an error but does not move. This defect
disabled the keyboard teleoperation of the Kobuki (https://github.com/aliasrobotics/RVD/issues/581). Another robot stood
still because the launch file started it in a namespace, but its code published on `/cmd_vel`
(https://github.com/UoY-RoboStar/AURO/issues/5).

Two names also count as similar in these cases:

- One has a slash where the other has an underscore (`/water/current` and `/water_current`).
- A word is abbreviated (`/cmd` and `/command`).
- The words are in another order (`/scan_filtered` and `/filtered_scan`).
- A word has the same meaning (`/gripper/state` and `/gripper/status`).
- Both names are private to the same node (`~finished` and `~finish`).

The rule also reports private names of a renamed node. For example, if the code calls a node `elevator` and one of its
topics `~floor`, and the launch file calls the node `lift`, the topic is `/lift/floor`, and a subscription to
`/elevator/floor` has no publisher.

Two names are not similar if they differ in a word of one or two letters (`wheel_fl` and `wheel_fr`). Names with fewer
than five letters are similar only if two letters are exchanged (`/sacn` and `/scan`).

Some nodes of a launch file may be *unknown*: their source is missing, they compute the names of their topics, or a
missing launch file starts them. An unknown node might be the missing publisher or subscriber, so the rule then reports
less:

- It reports misspelt names, but not different namespaces or abbreviations.
- It reports nothing if an unknown node has one of the two names in its remappings, parameters, arguments or strings.

An unknown node is disregarded if it cannot use the message type: for example, a laser driver publishes no `Twist`.
tarl-lint knows the types of well-known packages, and assumes that a C++ program of the workspace uses only the types
that its files name.

An unknown sensor driver (recognised by its package, or by a word such as `lidar` or `gps` in its name) is also
disregarded if it cannot use either of the two names. It may use a name that it mentions, a name that is private to it,
and a name whose last part is typical of sensor drivers: `/rear/scan` and `/points_raw` are typical; `/obstacles` is
not.

The rule reports nothing if no publisher has a similar name, because sensors, simulators and teleoperation are often
started elsewhere. In completely known launch files, only one of 23 topics without a similar publisher was a mistake.
The report of `--launch` lists such topics under "No publisher here", and the JSON report under `one_sided`. They do not
fail the run.
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
    """Yield a hazard for each subscription that matches a publisher in everything but the name of the topic."""
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
    """Return the type of the messages that a relay passes on: the type of its input's publishers; "" if unknown."""
    heard = (
        {name for name, _ in who.ends("subscribes")} if who.interface is None and who.known.through else set()
    )
    types = {end.type for name, _, end in system.named("publishes") if name in heard}
    return types.pop() if len(types) == 1 else ""
