"""Managed entities of a lifecycle node, such as publishers, which work only while the node is active."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

from pytest_tarl.ros.rclpy.lifecycle.states import LifecycleState, TransitionCallbackReturn
from pytest_tarl.ros.rclpy.topics import Publisher

_SUCCESS = TransitionCallbackReturn.SUCCESS


class ManagedEntity:
    """An entity that takes part in every transition; callbacks return SUCCESS by default."""

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:  # noqa: ARG002 (for those who derive)
        """Return SUCCESS."""
        return _SUCCESS

    on_cleanup = on_shutdown = on_activate = on_deactivate = on_error = on_configure


class SimpleManagedEntity(ManagedEntity):
    """An entity that is enabled while its node is active."""

    def __init__(self) -> None:
        self._enabled = False

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:  # noqa: ARG002
        """Enable."""
        self._enabled = True
        return _SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:  # noqa: ARG002
        """Disable."""
        self._enabled = False
        return _SUCCESS

    @property
    def is_activated(self) -> bool:
        """Return whether the entity is enabled."""
        return self._enabled

    @staticmethod
    def when_enabled(wrapped: Any = None, *, when_not_enabled: Callable[[], Any] | None = None) -> Any:
        """Make a method do nothing, or call another function, while its entity is disabled."""

        def decorate(method: Callable[..., Any]) -> Callable[..., Any]:
            @wraps(method)
            def guarded(self: SimpleManagedEntity, *args: Any, **kwargs: Any) -> None:
                if self.is_activated:
                    method(self, *args, **kwargs)
                elif when_not_enabled is not None:
                    when_not_enabled()

            return guarded

        return decorate if wrapped is None else decorate(wrapped)


class LifecyclePublisher(SimpleManagedEntity, Publisher):
    """Publishes while its node is active, and otherwise drops messages."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        SimpleManagedEntity.__init__(self)
        Publisher.__init__(self, *args, **kwargs)

    def publish(self, msg: Any) -> None:
        """Publish, if active."""
        if self._enabled:
            Publisher.publish(self, msg)
