"""`moveit_commander.exception`."""

from __future__ import annotations


class MoveItCommanderException(Exception):  # noqa: N818 (the library's name)
    """moveit_commander rejects an argument or a request."""
