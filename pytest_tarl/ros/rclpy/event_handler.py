"""Callbacks for quality-of-service events: taken, and never called, since nothing is late or lost here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

EventCallback = Callable[[Any], Any]


class UnsupportedEventTypeError(RuntimeError):
    """A middleware does not know an event; this one takes all."""


class _EventCallbacks:
    """Holds callbacks by the names that rclpy gives them."""

    _names: tuple[str, ...] = ()

    def __init__(self, **given: Any) -> None:
        self.use_default_callbacks = bool(given.pop("use_default_callbacks", True))
        unknown = sorted(set(given) - set(self._names))
        if unknown:
            raise TypeError(f"{type(self).__name__} got an unexpected keyword argument {unknown[0]!r}")
        for name in self._names:
            setattr(self, name, given.get(name))


class SubscriptionEventCallbacks(_EventCallbacks):
    """Callbacks of a subscription."""

    _names = ("incompatible_qos", "deadline", "liveliness", "message_lost", "incompatible_type", "matched")


class PublisherEventCallbacks(_EventCallbacks):
    """Callbacks of a publisher."""

    _names = ("deadline", "liveliness", "incompatible_qos", "incompatible_type", "matched")
