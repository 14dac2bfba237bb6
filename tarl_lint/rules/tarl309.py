"""TARL309: code uses a field that the message type does not have.

The callback raises AttributeError at its first message. rospy logs the error and continues, so the rest of the robot
runs without the data. An `Accel`, for example, has `linear` and `angular`, but no `accel`.

The rule covers messages, services and actions that packages of the workspace define. It also covers messages of
`std_msgs`, `geometry_msgs`, `nav_msgs`, `sensor_msgs` and a few other packages. Some fields exist only in ROS 1 or only
in ROS 2: an rclpy program has no `header.seq`, no `stamp.secs` and no `K` in a `CameraInfo`.

The rule checks the arguments with which the code creates messages, and every expression that is certainly a message:

- the arguments of callbacks, servers and synchronizers,
- variables with annotations,
- responses of services,
- variables and attributes of `self` to which the code assigns only messages of one type,
- elements of lists of messages.

The rule reports nothing if the code tests the class of a variable, checks for the field by name (`hasattr`), or handles
AttributeError.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

from tarl_lint.message_fields import BY_RELEASE, KNOWN_FIELDS
from tarl_lint.model import Finding
from tarl_lint.system.model import Interface, Misfit, System
from tarl_lint.system.unknown_fields import lacking

CODE: Final = "TARL309"
SUMMARY: Final = "code uses a field that the message type does not have"

INVALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="limiter.py" name="limiter"/>
    </launch>
    --- scripts/limiter.py
    import rospy
    from geometry_msgs.msg import Accel
    from std_msgs.msg import Float64

    rospy.init_node("limiter")
    pub = rospy.Publisher("force", Float64, queue_size=1)

    def on_accel(msg):
        pub.publish(2.0 * msg.accel.x)

    rospy.Subscriber("accel", Accel, on_accel)
    rospy.spin()
    """,
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="heading.py" name="heading"/>
    </launch>
    --- scripts/heading.py
    import rospy
    from sensor_msgs.msg import Imu
    from std_msgs.msg import Float64

    rospy.init_node("heading")
    pub = rospy.Publisher("rate", Float64, queue_size=1)

    def on_imu(msg):
        pub.publish(Float64(value=msg.angular_velocity.z))

    rospy.Subscriber("imu", Imu, on_imu)
    rospy.spin()
    """,
)

VALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="limiter.py" name="limiter"/>
    </launch>
    --- scripts/limiter.py
    import rospy
    from geometry_msgs.msg import Accel
    from std_msgs.msg import Float64

    rospy.init_node("limiter")
    pub = rospy.Publisher("force", Float64, queue_size=1)

    def on_accel(msg):
        pub.publish(2.0 * msg.linear.x)

    rospy.Subscriber("accel", Accel, on_accel)
    rospy.spin()
    """,
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="tilt.py" name="tilt"/>
    </launch>
    --- scripts/tilt.py
    import rospy
    from geometry_msgs.msg import Vector3Stamped
    from std_msgs.msg import Float64, Header

    rospy.init_node("tilt")
    pub = rospy.Publisher("tilt", Float64, queue_size=1)

    def on_gravity(msg):
        rospy.loginfo("%s %s", msg.header.seq, Header(seq=1))
        pub.publish(Float64(data=msg.vector.x))

    rospy.Subscriber("gravity", Vector3Stamped, on_gravity)
    rospy.spin()
    """,
)


def findings(system: System) -> Iterator[Finding]:
    """Yield a hazard for each use of an absent field; once if several nodes run the same program."""
    from difflib import get_close_matches  # slow to import; reports import every rule

    known = {**KNOWN_FIELDS, **system.messages}
    for interface in {
        one.interface.path: one.interface for one in system.instances if one.interface
    }.values():
        for misfit in (*interface.misfits, *_in_workspace(interface, known)):
            fields = _fields(misfit, known)
            near = [one for one in fields if one.lower() == misfit.field.lower()]
            near = near or get_close_matches(misfit.field, fields, 1)
            hint = f"did you mean {near[0]}?" if near else f"it has {', '.join(fields)}"
            message = f"{misfit.type} has no field {misfit.field}: {hint}"
            about = f"{misfit.type}.{misfit.field}"
            yield Finding(
                CODE, misfit.span, message, about=about, place=misfit.place, package=interface.package
            )


def _fields(misfit: Misfit, known: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Return the fields of a message type in the release of ROS in which the type lacks the field."""
    releases = (known, *(BY_RELEASE[one] for one in sorted(BY_RELEASE)))
    given = [one[misfit.type] for one in releases if misfit.type in one]
    fields = next((one for one in given if misfit.field not in one), {})
    return [one for one in fields if not one.endswith("[]")]


def _in_workspace(interface: Interface, known: Mapping[str, Mapping[str, str]]) -> Iterator[Misfit]:
    """Yield the uses of absent fields of messages that the workspace defines."""
    for use in interface.uses:
        absent = lacking(use.type, tuple(use.field.split(".")), known)
        if absent is not None:
            yield replace(use, type=absent[0], field=absent[1])
