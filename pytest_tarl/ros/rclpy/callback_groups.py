"""Callback groups: which callbacks a multi-threaded executor may run beside each other."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

from typing import Any


class CallbackGroup:
    """Decides whether one more of its callbacks may start."""

    def __init__(self) -> None:
        self.running = 0

    def add_entity(self, entity: Any) -> None:
        """Do nothing: entities name their group."""

    def has_entity(self, entity: Any) -> bool:
        """Tell whether an entity names this group."""
        return getattr(entity, "callback_group", None) is self

    def can_execute(self, entity: Any) -> bool:
        """Tell whether a callback may start now."""
        return True


class ReentrantCallbackGroup(CallbackGroup):
    """Any number of callbacks at once."""


class MutuallyExclusiveCallbackGroup(CallbackGroup):
    """One callback at a time."""

    def can_execute(self, entity: Any) -> bool:
        """Tell whether none is running."""
        return self.running == 0
