"""Fields of common messages, used to detect that all fields of a copy were replaced."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

NUMBERS: Final = (
    "Bool", "Byte", "Char", "Duration", "Float32", "Float64", "Int8", "Int16", "Int32", "Int64", "String", "Time",
    "UInt8", "UInt16", "UInt32", "UInt64",
)  # fmt: skip
STAMPED: Final = ("Point", "Vector3", "Quaternion", "Pose", "Twist", "Accel", "Wrench")


def _fields(names: str, kind: str = "") -> dict[str, str]:
    return dict.fromkeys(names.split(), kind)


HEADED: Final = _fields("header", "Header")
FIELDS: Final[Mapping[str, Mapping[str, str]]] = {
    **{name: _fields("data") for name in NUMBERS},
    "ColorRGBA": _fields("r g b a"),
    "Header": _fields("stamp frame_id"),
    "Point": _fields("x y z"),
    "Point32": _fields("x y z"),
    "Vector3": _fields("x y z"),
    "Quaternion": _fields("x y z w"),
    "Pose2D": _fields("x y theta"),
    "Pose": _fields("position", "Point") | _fields("orientation", "Quaternion"),
    "Twist": _fields("linear angular", "Vector3"),
    "Accel": _fields("linear angular", "Vector3"),
    "Wrench": _fields("force torque", "Vector3"),
    "Transform": _fields("translation", "Vector3") | _fields("rotation", "Quaternion"),
    **{f"{name}Stamped": HEADED | _fields(name.lower(), name) for name in STAMPED},
    "TransformStamped": HEADED | _fields("child_frame_id") | _fields("transform", "Transform"),
    "PoseWithCovariance": _fields("pose", "Pose") | _fields("covariance"),
    "TwistWithCovariance": _fields("twist", "Twist") | _fields("covariance"),
    "PoseWithCovarianceStamped": HEADED | _fields("pose", "PoseWithCovariance"),
    "Odometry": HEADED
    | _fields("child_frame_id")
    | _fields("pose", "PoseWithCovariance")
    | _fields("twist", "TwistWithCovariance"),
    "Path": HEADED | _fields("poses"),
    "PoseArray": HEADED | _fields("poses"),
    "MapMetaData": _fields("map_load_time resolution width height") | _fields("origin", "Pose"),
    "OccupancyGrid": HEADED | _fields("info", "MapMetaData") | _fields("data"),
    "Image": HEADED | _fields("height width encoding is_bigendian step data"),
    "CompressedImage": HEADED | _fields("format data"),
    "JointState": HEADED | _fields("name position velocity effort"),
    "Joy": HEADED | _fields("axes buttons"),
    "LaserScan": HEADED
    | _fields(
        "angle_min angle_max angle_increment time_increment scan_time range_min range_max ranges intensities"
    ),
}  # type → name of a field → type of the field, for field types that have fields themselves
