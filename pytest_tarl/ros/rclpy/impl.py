"""`rclpy.impl`: the logger and its levels, which nodes import from there."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.missing import refuse


def __getattr__(name: str) -> Any:
    """Raise an error for a name that the stand-in lacks."""
    raise refuse("rclpy.impl", name)
