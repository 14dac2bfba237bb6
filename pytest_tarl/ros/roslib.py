"""`roslib.load_manifest`, which old nodes still call."""

from __future__ import annotations

__all__ = ["load_manifest"]


def load_manifest(package_name: str) -> None:
    """Do nothing, as catkin's roslib does: the search path is complete."""
