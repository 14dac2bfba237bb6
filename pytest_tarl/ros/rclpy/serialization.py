"""rclpy.serialization: messages as bytes, as DDS transports them."""

from __future__ import annotations

from typing import Any, TypeVar

from pytest_tarl.ros.messages.ros2_wire import deserialize, serialize

T = TypeVar("T")


def serialize_message(message: Any) -> bytes:
    """Return a message as bytes."""
    return serialize(message)


def deserialize_message(serialized_message: bytes, message_type: type[T]) -> T:
    """Return the message of class `message_type` in these bytes."""
    message: T = deserialize(serialized_message, message_type)
    return message
