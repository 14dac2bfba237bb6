"""Callbacks for quality-of-service events, which are never called, because no message is late or lost."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

EventCallback = Callable[[Any], Any]


class UnsupportedEventTypeError(RuntimeError):
    """The middleware does not support an event; never raised here."""


class _EventCallbacks:
    """Stores callbacks under rclpy's names."""

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


class EventInfo:
    """The argument of event callbacks; never created here."""


# rclpy has a class for each event, which nodes use in annotations
IncompatibleTypeInfo = QoSLivelinessChangedInfo = QoSLivelinessLostInfo = QoSMessageLostInfo = EventInfo
QoSOfferedDeadlineMissedInfo = QoSRequestedDeadlineMissedInfo = EventInfo
QoSOfferedIncompatibleQoSInfo = QoSRequestedIncompatibleQoSInfo = EventInfo
QoSPublisherMatchedInfo = QoSSubscriptionMatchedInfo = EventInfo
