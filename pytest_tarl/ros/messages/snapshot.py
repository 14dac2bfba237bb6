"""Copy messages to what a receiver gets: checked, and in the receiver's class."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from copy import deepcopy
from io import BytesIO
from typing import Any

from pytest_tarl.ros.clock import NANOSECONDS
from pytest_tarl.ros.messages import find_class, unknown_type
from pytest_tarl.ros.messages.field_values import FieldError, as_float32

_COPIERS: dict[type, Callable[[Any], Any]] = {}  # message class → copier; entries never change
_STAMPS: dict[
    type, tuple[str, str] | None
] = {}  # class → names of the stamp's parts in the header; entries never change


def snapshot(message: Any, wanted: type | None = None) -> Any:
    """Copy a message for a receiver of class `wanted` (None: the same class). Raise FieldError if it does not fit."""
    own = type(message)
    if wanted is not None and wanted is not own:
        if type_name(wanted) != type_name(own):
            raise FieldError(f"its type is {type_name(own)}, not {type_name(wanted)}")
        return translate(message, wanted)
    copier = _COPIERS.get(own)
    if copier is None:
        copier = _COPIERS[own] = _copier(own)
    return copier(message)


def type_name(message_type: Any) -> str:
    """Return the type name of a class, such as `nav_msgs/Odometry`, in the same form for both ROS generations."""
    if hasattr(message_type, "_slot_types"):
        return str(message_type._type)
    package = getattr(message_type, "__module__", "").partition(".")[0]
    return (
        f"{package}/{message_type.__name__}"
        if hasattr(message_type, "get_fields_and_field_types")
        else (getattr(message_type, "__name__", str(message_type)))
    )


def field_names(message: Any) -> tuple[str, ...]:
    """Return the field names of a message or message class."""
    if hasattr(message, "get_fields_and_field_types"):
        return tuple(message.get_fields_and_field_types())
    return tuple(message.__slots__)


def translate(message: Any, wanted: type) -> Any:
    """Convert a message field by field to the class of the same type in the other ROS generation."""
    made = wanted()
    for name in field_names(wanted):
        if hasattr(message, name):
            setattr(made, name, _translated(getattr(message, name), getattr(made, name), wanted))
    return snapshot(made)


def _translated(value: Any, template: Any, wanted: type) -> Any:
    if hasattr(value, "secs") and hasattr(template, "sec"):
        return type(template)(sec=value.secs, nanosec=value.nsecs)
    if hasattr(value, "sec") and hasattr(template, "secs"):
        return type(template)(value.sec, value.nanosec)
    if is_message(value):
        return translate(value, type(template))
    if isinstance(value, list | tuple) and value and is_message(value[0]):
        return [translate(item, _class_like(type(item), wanted)) for item in value]
    return bytes(value) if isinstance(template, bytes) else list(value) if hasattr(value, "tolist") else value


def _class_like(own: type, other: type) -> type[Any]:
    """Return the class of the same type in the ROS generation of `other`. Raise UnsupportedApiError."""
    package, _, short = type_name(own).partition("/")
    found = find_class("ros1" if hasattr(other, "_slot_types") else "ros2", package, short)
    if found is None:
        raise unknown_type(package, short)
    return found


def is_message(value: Any) -> bool:
    """Return whether an object is a ROS message of either generation."""
    own = type(value)
    return hasattr(own, "get_fields_and_field_types") or (
        hasattr(own, "_slot_types") and hasattr(own, "_type")
    )


def stamp_if_unset(message: Any, now: int) -> None:
    """Set the header stamp of `message` to the current time (ns), unless it is already set."""
    own = type(message)
    if own not in _STAMPS:
        _STAMPS[own] = _stamp_parts(message)
    parts = _STAMPS[own]
    if parts is None:
        return
    whole, rest = parts
    stamp: Any = message.header.stamp
    if not (getattr(stamp, whole) or getattr(stamp, rest)):
        seconds, nanoseconds = divmod(now, NANOSECONDS)
        setattr(stamp, whole, seconds)
        setattr(stamp, rest, nanoseconds)


def _stamp_parts(message: Any) -> tuple[str, str] | None:
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    if stamp is None:
        return None
    if hasattr(stamp, "nsecs"):
        return "secs", "nsecs"
    return (
        ("_sec", "_nanosec") if hasattr(stamp, "_tarl_fields") else ("sec", "nanosec")
    )  # classes built here need no checks


def _copier(own: type) -> Callable[[Any], Any]:
    """Return the copy function of a class; classes of an installed ROS 1 are copied by serialisation.

    Raise FieldError if the class is not a message class.
    """
    copier: Callable[[Any], Any] | None = getattr(own, "_tarl_copy", None)
    if copier is not None:
        return copier
    if hasattr(own, "get_fields_and_field_types"):
        return _slot_copier(own)
    if hasattr(own, "_slot_types") and hasattr(own, "deserialize"):
        return _through_the_wire
    raise FieldError(
        f"{own.__name__} is not a ROS message (make one with message_type('std_msgs/Float64')(…))"
    )


def _slot_copier(own: type) -> Callable[[Any], Any]:
    """Return the copy function for a class of an installed ROS 2: slot by slot, sharing immutable values."""
    slots = [slot for base in reversed(own.__mro__) for slot in getattr(base, "__slots__", ())]
    singles = {f"_{name}" for name, kind in own.get_fields_and_field_types().items() if kind == "float"}  # type: ignore[attr-defined]

    def copy(message: Any) -> Any:
        twin: Any = object.__new__(own)
        for slot in slots:
            value = getattr(message, slot)
            if value.__class__ not in _UNCHANGEABLE:
                value = _copied(value)
            elif slot in singles:
                value = as_float32(value, slot)
            object.__setattr__(twin, slot, value)
        return twin

    return copy


_UNCHANGEABLE = frozenset([int, float, bool, str, bytes])


def _copied(value: Any) -> Any:
    if is_message(value):
        return snapshot(value)
    if isinstance(value, list | tuple) and value and is_message(value[0]):
        return [snapshot(item) for item in value]
    if isinstance(value, list | array):
        return value[:]
    return value.copy() if hasattr(value, "dtype") else deepcopy(value)


def _through_the_wire(message: Any) -> Any:
    from genpy import SerializationError

    buffer = BytesIO()
    try:
        message.serialize(buffer)
    except SerializationError as error:
        raise FieldError(str(error)) from error
    return type(message)().deserialize(buffer.getvalue())
