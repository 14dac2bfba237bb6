"""The one call of roslib that old nodes still make."""

from __future__ import annotations

from typing import Any

__all__ = ["load_manifest"]


def load_manifest(package_name: str) -> None:
    """Do nothing, as catkin's roslib does: the search path is complete."""


def __getattr__(name: str) -> Any:
    """Name what is missing."""
    from pytest_tarl.ros.missing import refuse

    raise refuse("roslib", name)
