"""Definitions of widely used message, service and action types that `rosbags` does not contain."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Literal

from pytest_tarl.ros.messages.known import actions, moveit, msgs, robots, srvs

Part = Literal["msg", "srv", "action"]
_BOTH = {
    "msg": (msgs.BOTH, moveit.MSGS, robots.MSGS),
    "srv": (srvs.BOTH, moveit.SRVS, robots.SRVS),
    "action": (actions.BOTH, moveit.ACTIONS),
}
_ROS1 = {
    "msg": (msgs.ROS1, moveit.MSGS_ROS1, robots.MSGS_ROS1),
    "srv": (srvs.ROS1, robots.SRVS_ROS1),
    "action": (actions.ROS1, robots.ACTIONS_ROS1),
}
_ROS2 = {
    "msg": (msgs.ROS2, moveit.MSGS_ROS2, robots.MSGS_ROS2),
    "srv": (srvs.ROS2, robots.SRVS_ROS2),
    "action": (actions.ROS2,),
}


@cache
def known_types(kind: str, part: Part) -> Mapping[str, str]:
    """Return the definitions by type name, in the syntax of .msg, .srv and .action files."""
    own = _ROS1 if kind == "ros1" else _ROS2
    return {name: text for table in (*_BOTH[part], *own[part]) for name, text in _split(table).items()}


def _split(text: str) -> dict[str, str]:
    found = {}
    for section in text.split("== ")[1:]:
        name, _, definition = section.partition("\n")
        found[name.strip()] = definition
    return found
