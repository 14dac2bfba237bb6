"""`rclpy.impl`: what nodes import from there are the logger and its levels."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.missing import refuse


def __getattr__(name: str) -> Any:
    """Name what is missing."""
    raise refuse("rclpy.impl", name)
