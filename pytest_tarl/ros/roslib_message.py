"""`roslib.message` and `genpy.message`: look up message and service classes by type name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pytest_tarl.ros.genpy import (
    DeserializationError,
    Duration,
    Message,
    MessageException,
    SerializationError,
    Time,
    TVal,
    struct_I,
)
from pytest_tarl.ros.messages import class_of, find_class
from pytest_tarl.ros.messages.known import Part
from pytest_tarl.ros.messages.ros1 import as_yaml

__all__ = [
    "DeserializationError", "Duration", "Message", "MessageException", "SerializationError", "TVal", "Time",
    "fill_message_args", "get_message_class", "get_printable_message_args", "get_service_class", "strify_message",
    "struct_I",
]  # fmt: skip


def get_message_class(message_type: str, reload_on_error: bool = False) -> Any:  # noqa: ARG001 (genpy's signature)
    """Return the class of a message type such as `std_msgs/String`, or None if it is unknown."""
    return _class(message_type, "msg")


def get_service_class(service_type: str, reload_on_error: bool = False) -> Any:  # noqa: ARG001
    """Return the class of a service type such as `std_srvs/Empty`, or None if it is unknown."""
    return _class(service_type, "srv")


def _class(name: str, part: Part) -> Any:
    package, _, short = name.rpartition("/")
    if not package:
        if short != "Header":
            raise ValueError(f"message type is missing package name: {name}")
        package = "std_msgs"
    return find_class("ros1", package, short, part)


def strify_message(val: Any, indent: str = "", *_: Any, **__: Any) -> str:
    """Format a message as `rostopic echo` does."""
    return as_yaml(val, indent)


def get_printable_message_args(msg: Any, buff: Any = None, prefix: str = "") -> str:  # noqa: ARG001
    """Return the names of all fields, with dots for nested messages."""
    names = []
    for name, kind in zip(msg.__slots__, msg._slot_types, strict=True):
        inner = getattr(msg, name)
        names.append(
            get_printable_message_args(inner, prefix=f"{prefix}{name}.")
            if "/" in kind and isinstance(inner, Message)
            else f"{prefix}{name}"
        )
    return " ".join(names)


def fill_message_args(msg: Any, msg_args: Any, keys: Mapping[str, Any] | None = None) -> None:
    """Fill a message from a dict of fields, or from a list with one value for each field.

    `keys` maps names such as `now` to times. Raise MessageException for values that do not fit.
    """
    if len(msg_args) == 1 and isinstance(msg_args[0], dict | list) and not isinstance(msg_args, dict):
        msg_args = msg_args[0]
    _fill(msg, msg_args, keys or {}, "")


def _fill(msg: Any, given: Any, keys: Mapping[str, Any], prefix: str) -> None:
    if isinstance(given, str) and given in keys:
        given = {"secs": keys[given].secs, "nsecs": keys[given].nsecs}
    if isinstance(given, list):
        if len(given) > len(msg.__slots__):
            raise MessageException(f"Too many arguments:\n * Given: {given}\n * Expected: {msg.__slots__}")
        if len(given) < len(msg.__slots__):
            raise MessageException(f"Not enough arguments:\n * Given: {given}\n * Expected: {msg.__slots__}")
        given = dict(zip(msg.__slots__, given, strict=True))
    if not isinstance(given, dict):
        raise MessageException(f"invalid message_args type for field [{prefix}]: {given}")
    for name, value in given.items():
        if name not in msg.__slots__:
            raise MessageException(f"No field name [{prefix}{name}]")
        setattr(msg, name, _filled(msg, name, value, keys, prefix))


def _filled(msg: Any, name: str, value: Any, keys: Mapping[str, Any], prefix: str) -> Any:
    """Return a field's value: strings, numbers and times unchanged, messages built from dicts and lists."""
    old = getattr(msg, name)
    if isinstance(old, TVal):
        if isinstance(value, str) and value in keys:
            return keys[value]
        if isinstance(value, dict):
            old.secs, old.nsecs = value.get("secs", old.secs), value.get("nsecs", old.nsecs)
            return old
        if isinstance(value, list) and len(value) == 2:
            old.secs, old.nsecs = value
            return old
        return value
    if isinstance(old, Message):
        _fill(old, value, keys, f"{prefix}{name}.")
        return old
    kind = msg._slot_types[msg.__slots__.index(name)]
    if kind.endswith("]") and "/" in kind and isinstance(value, list):
        element = class_of("ros1", kind.partition("[")[0])
        made = [element() for _ in value]
        for one, given in zip(made, value, strict=True):
            _fill(one, given, keys, f"{prefix}{name}.")
        return made
    return value
