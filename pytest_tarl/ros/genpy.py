"""The parts of genpy that nodes import: times, the base class of messages, and errors."""

from __future__ import annotations

from struct import Struct

from pytest_tarl.ros.messages.ros1 import Message
from pytest_tarl.ros.messages.times import Duration, Time, TVal

__all__ = [
    "DeserializationError",
    "Duration",
    "Message",
    "MessageException",
    "SerializationError",
    "TVal",
    "Time",
    "struct_I",
]

struct_I = Struct("<I")  # noqa: N816 (genpy's name): the length of a text or array in a serialized message


class MessageException(Exception):  # noqa: N818 (named by genpy)
    """Base of genpy's errors."""


class SerializationError(MessageException):
    """A message cannot be serialised."""


class DeserializationError(MessageException):
    """A message cannot be deserialised."""
