"""`numpy_msg(Type)`: here the type itself; numpy functions take its tuples."""

# ruff: noqa: ARG001 (signatures are rospy's)

from __future__ import annotations

from typing import Any

__all__ = ["numpy_msg"]


def numpy_msg(msg_type: Any) -> Any:
    """Refuse: messages whose arrays are numpy arrays are not built yet."""
    from pytest_tarl.ros.missing import unsupported

    raise unsupported("rospy.numpy_msg.numpy_msg")
