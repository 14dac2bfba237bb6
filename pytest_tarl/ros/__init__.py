"""Replacements for rospy and rclpy in this process: virtual clock, synchronous delivery, no state left behind.

Heavy modules are imported only when `Ros`, `Bus` or `message_type` is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pytest_tarl.ros.bus import Bus
    from pytest_tarl.ros.episode import Ros
    from pytest_tarl.ros.messages import message_type

__all__ = ["Bus", "Ros", "message_type"]

_HOMES = {
    "Bus": "pytest_tarl.ros.bus",
    "Ros": "pytest_tarl.ros.episode",
    "message_type": "pytest_tarl.ros.messages",
}


def __getattr__(name: str) -> Any:
    """Import a name of the public API from its module."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)
