"""Find the services that a program calls, by literals in its code."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from tarl_lint.evidence import Outline
from tarl_lint.trees import argument, last_name

_PROXIES: Final = frozenset(["ServiceProxy"])
_CLIENTS: Final = frozenset(["create_client"])
CLIENTS: Final = (
    "rospy.ServiceProxy",
    "rclpy.create_client",
    "actionlib.SimpleActionClient",
    "actionlib.ActionClient",
    "rclpy.action.ActionClient",
)
_SERVERS: Final = (
    "rospy.Service",
    "rclpy.create_service",
    "actionlib.SimpleActionServer",
    "actionlib.ActionServer",
    "rclpy.action.ActionServer",
)
# endings of the names of calls that send or receive feedback
FEEDBACK: Final = (".publish_feedback", ".feedback")
# Each pair has the message that goes to the server of a service or action, and the message that may come back.
PARTS: Final = ((" (request)", " (response)"), (" (goal)", " (result)"), (" (goal)", " (feedback)"))


def part(api: str, *, sent: bool) -> str:
    """Return the part of a service that an end is, such as ` (request)`; "" for a topic."""
    client = api.startswith(CLIENTS)
    if not client and not api.startswith(_SERVERS):
        return ""
    if api.endswith(FEEDBACK):
        return PARTS[2][1]
    parts = PARTS[1] if "action" in api else PARTS[0]
    return parts[0] if client is sent else parts[1]


def called_services(outline: Outline) -> Iterator[tuple[ast.Call, str, str]]:
    """Yield the calls that create a client, with service name and type."""
    for calls in outline.calls.values():
        for call in calls:
            made = last_name(call.func)
            places = (0, 1) if made in _PROXIES else (1, 0) if made in _CLIENTS else None
            if places is None:
                continue
            name = argument(call, places[0], "name", "srv_name")
            kind = argument(call, places[1], "service_class", "srv_type")
            if isinstance(name, ast.Constant) and isinstance(name.value, str):
                yield call, name.value, last_name(kind) if kind is not None else ""
