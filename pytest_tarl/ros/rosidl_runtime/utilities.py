"""rosidl_runtime_py.utilities: look up message, service and action types by name."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.messages.known import Part

__all__ = [
    "get_action",
    "get_interface",
    "get_message",
    "get_service",
    "is_action",
    "is_message",
    "is_service",
]


_PARTS: tuple[Part, ...] = ("msg", "srv", "action")


def get_interface(identifier: str) -> Any:
    """Return the type with a name such as `std_msgs/msg/String`.

    Raise ValueError if the name has another form, and ModuleNotFoundError or AttributeError if the type is unknown.
    """
    package, *middle, short = identifier.split("/") if "/" in identifier else ("", identifier)
    if not package or not short or len(middle) > 1 or (middle and middle[0] not in _PARTS):
        raise ValueError(
            f"Invalid name '{identifier}'. Expected PACKAGE/msg/NAME, PACKAGE/srv/NAME or PACKAGE/action/NAME"
        )
    parts = [one for one in _PARTS if one in middle] or _PARTS
    found = next(
        (cls for part in parts if (cls := find_class("ros2", package, short, part)) is not None), None
    )
    if found is None:
        raise AttributeError(f"module '{package}.{parts[0]}' has no attribute '{short}'")
    return found


def get_message(identifier: str) -> Any:
    """Return a message type by name. Raise the errors of `get_interface`, and ValueError for other types."""
    return _of_kind(identifier, "message", is_message)


def get_service(identifier: str) -> Any:
    """Return a service type by name. Raise the errors of `get_interface`, and ValueError for other types."""
    return _of_kind(identifier, "service", is_service)


def get_action(identifier: str) -> Any:
    """Return an action type by name. Raise the errors of `get_interface`, and ValueError for other types."""
    return _of_kind(identifier, "action", is_action)


def is_message(interface: Any) -> bool:
    """Return whether a type is a message."""
    return hasattr(interface, "get_fields_and_field_types")


def is_service(interface: Any) -> bool:
    """Return whether a type is a service."""
    return hasattr(interface, "Request") and hasattr(interface, "Response")


def is_action(interface: Any) -> bool:
    """Return whether a type is an action."""
    return all(hasattr(interface, part) for part in ("Goal", "Result", "Feedback"))


def _of_kind(identifier: str, kind: str, fits: Any) -> Any:
    interface = get_interface(identifier)
    if not fits(interface):
        raise ValueError(f"Expected the full name of a {kind}, got '{identifier}'")
    return interface
