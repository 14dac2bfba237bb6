"""A DiagnosticStatus with the methods that diagnostic tasks call."""

# ruff: noqa: N802 (names are those of diagnostic_updater)

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.messages import class_of
from pytest_tarl.ros.messages.type_definitions import Kind


def number(level: Any) -> int:
    """Return a level as a number; in ROS 2, it is one byte."""
    return level[0] if isinstance(level, bytes) else int(level)


class _Filling:
    """Methods that a status has in addition to its message fields."""

    level: Any
    message: str
    values: list[Any]
    _kind: Kind

    def summary(self, *args: Any) -> None:
        """Set level and message, or copy them from another status."""
        if len(args) == 1:
            self.level, self.message = args[0].level, args[0].message
        elif len(args) == 2:
            self.level, self.message = args[0], str(args[1])

    def clearSummary(self) -> None:
        """Set the level to OK, without a message."""
        self.set_level(0, "")

    def mergeSummary(self, *args: Any) -> None:
        """Merge level and message into those of this status.

        The higher level wins. If both levels are OK, or neither is, the messages are joined. Otherwise the message with
        the higher level wins.
        """
        level, text = (args[0].level, args[0].message) if len(args) == 1 else args
        if (number(level) > 0) == (number(self.level) > 0):
            self.message = f"{self.message}; {text}" if self.message else text
        elif number(level) > number(self.level):
            self.message = text
        if number(level) > number(self.level):
            self.level = level

    def add(self, key: str, val: object) -> None:
        """Append a value as text."""
        pair: Any = class_of(self._kind, "diagnostic_msgs/KeyValue")
        self.values.append(pair(key=key, value=str(val)))

    def set_level(self, level: int, text: str) -> None:
        """Set level and message; `level` is a number in both ROS generations."""
        self.summary(level if self._kind == "ros1" else bytes([level]), text)


_WRAPPERS: dict[Kind, type[Any]] = {}


def wrapper_of(kind: Kind) -> Any:
    """Return `DiagnosticStatusWrapper`, a subclass of the generation's DiagnosticStatus."""
    message = class_of(kind, "diagnostic_msgs/DiagnosticStatus")
    known = _WRAPPERS.get(kind)
    if known is None or message not in known.__mro__:
        known = _WRAPPERS[kind] = type("DiagnosticStatusWrapper", (_Filling, message), {"_kind": kind})
    return known
