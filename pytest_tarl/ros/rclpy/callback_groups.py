"""Callback groups: which callbacks a multi-threaded executor may run beside each other."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

from typing import Any


class CallbackGroup:
    """Decides whether one more of its callbacks may start. Nodes derive groups of their own from it."""

    def __init__(self) -> None:
        self.entities: set[Any] = set()

    def add_entity(self, entity: Any) -> None:
        """Take an entity in."""
        self.entities.add(entity)

    def has_entity(self, entity: Any) -> bool:
        """Tell whether an entity belongs to this group."""
        return entity in self.entities

    def can_execute(self, entity: Any) -> bool:
        """Tell whether a callback could start now."""
        raise NotImplementedError

    def beginning_execution(self, entity: Any) -> bool:
        """Let a callback start, or refuse."""
        raise NotImplementedError

    def ending_execution(self, entity: Any) -> None:
        """Take note that a callback has ended."""
        raise NotImplementedError


class ReentrantCallbackGroup(CallbackGroup):
    """Any number of callbacks at once."""

    def can_execute(self, entity: Any) -> bool:
        """Tell that it can."""
        return True

    def beginning_execution(self, entity: Any) -> bool:
        """Let it."""
        return True

    def ending_execution(self, entity: Any) -> None:
        """Do nothing."""


class MutuallyExclusiveCallbackGroup(CallbackGroup):
    """One callback at a time; a coroutine counts until it has returned."""

    def __init__(self) -> None:
        super().__init__()
        self.active: Any = None

    def can_execute(self, entity: Any) -> bool:
        """Tell whether none is running."""
        return self.active is None

    def beginning_execution(self, entity: Any) -> bool:
        """Let it start if none is running."""
        if self.active is not None:
            return False
        self.active = entity
        return True

    def ending_execution(self, entity: Any) -> None:
        """Make room for the next."""
        self.active = None
