"""interactive_markers for both ROS generations: markers that users drag, or whose menus they open."""

from __future__ import annotations

from pytest_tarl.ros.interactive_markers.menu import MenuHandler
from pytest_tarl.ros.interactive_markers.server import InteractiveMarkerServer

__all__ = ["InteractiveMarkerServer", "MenuHandler"]
