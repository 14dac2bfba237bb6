"""Definitions of widely used message and service types that `rosbags` does not ship, in .msg syntax."""

from __future__ import annotations

from collections.abc import Mapping

_TURTLESIM = {
    "turtlesim/Pose": "float32 x\nfloat32 y\nfloat32 theta\nfloat32 linear_velocity\nfloat32 angular_velocity",
    "turtlesim/Color": "uint8 r\nuint8 g\nuint8 b",
}
_ACKERMANN = "\n".join(
    f"float32 {name}"
    for name in ("steering_angle", "steering_angle_velocity", "speed", "acceleration", "jerk")
)
_COMMON = {
    **_TURTLESIM,
    "ackermann_msgs/AckermannDrive": _ACKERMANN,
    "ackermann_msgs/AckermannDriveStamped": "std_msgs/Header header\nackermann_msgs/AckermannDrive drive",
    "tf2_msgs/TFMessage": "geometry_msgs/TransformStamped[] transforms",
}
_EXAMPLE_TYPES = (
    "Bool bool",
    "Int32 int32",
    "Int64 int64",
    "Float32 float32",
    "Float64 float64",
    "String string",
)

MESSAGES: Mapping[str, Mapping[str, str]] = {
    "ros1": _COMMON,
    "ros2": {
        **_COMMON,
        **{f"example_interfaces/{item.split()[0]}": f"{item.split()[1]} data" for item in _EXAMPLE_TYPES},
    },
}

_SWITCHES = {
    "std_srvs/Empty": "---",
    "std_srvs/Trigger": "---\nbool success\nstring message",
    "std_srvs/SetBool": "bool data\n---\nbool success\nstring message",
}
_SERVICES = {
    **_SWITCHES,
    "turtlesim/Kill": "string name\n---",
    "turtlesim/SetPen": "uint8 r\nuint8 g\nuint8 b\nuint8 width\nuint8 off\n---",
    "turtlesim/Spawn": "float32 x\nfloat32 y\nfloat32 theta\nstring name\n---\nstring name",
    "turtlesim/TeleportAbsolute": "float32 x\nfloat32 y\nfloat32 theta\n---",
    "turtlesim/TeleportRelative": "float32 linear\nfloat32 angular\n---",
}

SERVICES: Mapping[str, Mapping[str, str]] = {
    "ros1": _SERVICES,
    "ros2": {**_SERVICES, "example_interfaces/AddTwoInts": "int64 a\nint64 b\n---\nint64 sum"},
}
