"""`rclpy.impl`: the logger and its levels, which nodes import from there."""

from __future__ import annotations
