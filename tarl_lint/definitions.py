"""Fields of the messages that every robot has, for telling that a copy has nothing left of what it was made from."""

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
    **{f"{name}Stamped": _fields("header", "Header") | _fields(name.lower(), name) for name in STAMPED},
}  # type → field → its type where that has fields, too
