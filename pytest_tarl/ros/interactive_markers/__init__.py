"""interactive_markers for both ROS generations: markers that a user drags or whose menu a user opens."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.interactive_markers.menu import MenuHandler
from pytest_tarl.ros.interactive_markers.server import InteractiveMarkerServer
from pytest_tarl.ros.missing import refuse

__all__ = ["InteractiveMarkerServer", "MenuHandler"]


def __getattr__(name: str) -> Any:
    """Raise an error for a name that the stand-in lacks."""
    raise refuse("interactive_markers", name)
