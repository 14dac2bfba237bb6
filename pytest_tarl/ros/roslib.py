"""`roslib.load_manifest`, which old nodes still call."""

from __future__ import annotations

from typing import Any

__all__ = ["load_manifest"]


def load_manifest(package_name: str) -> None:
    """Do nothing, as catkin's roslib does: the search path is complete."""


def __getattr__(name: str) -> Any:
    """Raise an error for a name that the stand-in lacks."""
    from pytest_tarl.ros.missing import refuse

    raise refuse("roslib", name)
