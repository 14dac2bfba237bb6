"""Convert messages from `rosbags` to the class that the node subscribes to."""

from __future__ import annotations

from array import array
from typing import Any

from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.messages.field_values import FieldError
from pytest_tarl.ros.messages.snapshot import field_names, is_message
from pytest_tarl.ros.messages.type_definitions import Kind

OF_ONE_GENERATION = {"seq"}  # fields of a header that only ROS 1 has


def class_named(name: str, kind: Kind) -> type[Any] | None:
    """Return the class of a type written as in ROS 2; None if the type is unknown."""
    package, _, short = name.replace("/msg/", "/").partition("/")
    return find_class(kind, package, short)


def converted(recorded: Any, wanted: type[Any]) -> Any:
    """Convert a recorded message field by field. Raise FieldError if the recorded type lacks a field."""
    made = wanted()
    kind: Kind = "ros1" if hasattr(wanted, "_slot_types") else "ros2"
    for name in field_names(wanted):
        if hasattr(recorded, name):
            setattr(made, name, _value(getattr(recorded, name), getattr(made, name), kind))
        elif name not in OF_ONE_GENERATION:
            raise FieldError(f"the recorded {recorded.__msgtype__} has no field {name!r}")
    return made


def _value(value: Any, template: Any, kind: Kind) -> Any:
    """Return a field's value in the form of `template`, the field's value in a new message."""
    if hasattr(template, "nsecs"):
        return type(template)(value.sec, value.nanosec)
    if is_message(template):
        return converted(value, type(template))
    if hasattr(value, "tolist"):
        return _numbers(value, template, kind)
    if isinstance(value, list) and value and hasattr(value[0], "__msgtype__"):
        return [_element(one, kind) for one in value]
    if isinstance(template, bytes) and isinstance(value, int):  # ROS 2 stores a single byte as `bytes`
        return bytes([value])
    return value


def _numbers(value: Any, template: Any, kind: Kind) -> Any:
    if kind == "ros2":
        return (
            array(template.typecode, value.tobytes())
            if isinstance(template, array)
            else _like(value, template)
        )
    return value.tobytes() if isinstance(template, bytes) else value.tolist()


def _like(value: Any, template: Any) -> Any:
    return value.astype(template.dtype) if hasattr(template, "dtype") else value.tolist()


def _element(one: Any, kind: Kind) -> Any:
    if (
        one.__msgtype__ in ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")
        and kind == "ros1"
    ):
        from pytest_tarl.ros.messages.times import Duration, Time

        return (Time if one.__msgtype__.endswith("Time") else Duration)(one.sec, one.nanosec)
    wanted = class_named(one.__msgtype__, kind)
    if wanted is None:
        raise FieldError(f"the type {one.__msgtype__} is unknown")
    return converted(one, wanted)
