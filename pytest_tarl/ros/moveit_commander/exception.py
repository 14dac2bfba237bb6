"""`moveit_commander.exception`."""

from __future__ import annotations


class MoveItCommanderException(Exception):  # noqa: N818 (the library's name)
    """An argument or a request that moveit_commander refuses."""
