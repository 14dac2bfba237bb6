"""Check the types of services, requests and responses; each type has a class in both ROS generations."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from pytest_tarl.errors import RecordingError
from pytest_tarl.ros.messages.snapshot import is_message, type_name

_PART = re.compile(r"_?(Request|Response)$")


def request_class(service_class: Any) -> Any:
    """Return a service's request class, in either ROS generation."""
    return getattr(service_class, "Request", None) or service_class._request_class


def response_class(service_class: Any) -> Any:
    """Return a service's response class, in either ROS generation."""
    return getattr(service_class, "Response", None) or service_class._response_class


def service_type(service_class: Any) -> str:
    """Return a service's type, such as `std_srvs/SetBool`, in the same form for both ROS generations."""
    return _PART.sub("", type_name(request_class(service_class)))


def require_service(service: str, service_class: Any, handler: Callable[[Any], Any]) -> None:
    """Raise RecordingError unless the arguments of `tarl.bus.serve` are a service class and a callable."""
    classes = [getattr(service_class, f"_{part.lower()}_class", None) or getattr(service_class, part, None)
               for part in ("Request", "Response")]  # fmt: skip
    if not all(isinstance(one, type) for one in classes):
        raise RecordingError(
            f"tarl.bus.serve({service!r}, …): {_shown(service_class)} is not a service type; make one with "
            "message_type('std_srvs/srv/Trigger')."
        )
    if not callable(handler):
        raise RecordingError(
            f"tarl.bus.serve({service!r}, …): the handler {handler!r} is not callable; it must be a function that "
            "takes a request and returns a response."
        )


def require_part(message: Any, wanted: type, what: str) -> None:
    """Raise RecordingError unless a message is of type `wanted`, in either ROS generation.

    `what` starts the sentence, as in "The request to /dock".
    """
    if isinstance(message, wanted):
        return
    if is_message(message) and _plain(type(message)) == _plain(wanted):
        return
    raise RecordingError(
        f"{what} must be of type {type_name(wanted)}, not {_shown(message)}: make one with {_constructor(wanted)}(…)."
    )


def _plain(part: Any) -> str:
    return type_name(part).replace("_", "")


def _constructor(part: Any) -> str:
    """Return the expression for a request or response class in a test."""
    package, _, name = type_name(part).partition("/")
    short, half = _PART.sub("", name), "Request" if name.endswith("Request") else "Response"
    if hasattr(part, "_slot_types"):
        return f"message_type('{package}/{short}')._{half.lower()}_class"
    return f"message_type('{package}/srv/{short}').{half}"


def _shown(value: Any) -> str:
    if isinstance(value, type):
        return f"the class {value.__name__}"
    return "None" if value is None else type_name(type(value)).replace("builtins/", "")
