"""Callback groups: which callbacks a multi-threaded executor may run at the same time."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

from typing import Any


class CallbackGroup:
    """Decides whether another callback of the group may start; a base class for nodes' own groups."""

    def __init__(self) -> None:
        self.entities: set[Any] = set()

    def add_entity(self, entity: Any) -> None:
        """Add an entity."""
        self.entities.add(entity)

    def has_entity(self, entity: Any) -> bool:
        """Return whether an entity belongs to this group."""
        return entity in self.entities

    def can_execute(self, entity: Any) -> bool:
        """Return whether a callback could start now."""
        raise NotImplementedError

    def beginning_execution(self, entity: Any) -> bool:
        """Return whether a callback may start; if so, count it as running."""
        raise NotImplementedError

    def ending_execution(self, entity: Any) -> None:
        """Count a callback as ended."""
        raise NotImplementedError


class ReentrantCallbackGroup(CallbackGroup):
    """Allows any number of concurrent callbacks."""

    def can_execute(self, entity: Any) -> bool:
        """Return True."""
        return True

    def beginning_execution(self, entity: Any) -> bool:
        """Return True."""
        return True

    def ending_execution(self, entity: Any) -> None:
        """Do nothing."""


class MutuallyExclusiveCallbackGroup(CallbackGroup):
    """Allows one callback at a time; a coroutine occupies the group until it returns."""

    def __init__(self) -> None:
        super().__init__()
        self.active: Any = None

    def can_execute(self, entity: Any) -> bool:
        """Return whether no callback is running."""
        return self.active is None

    def beginning_execution(self, entity: Any) -> bool:
        """Count this callback as running unless another one is; return whether it may start."""
        if self.active is not None:
            return False
        self.active = entity
        return True

    def ending_execution(self, entity: Any) -> None:
        """Let the next callback start."""
        self.active = None
