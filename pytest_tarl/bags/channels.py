"""The contents of a bag in any format: typed channels, and messages in order of time."""

from __future__ import annotations

from typing import NamedTuple


class Channel(NamedTuple):
    """A recorded topic.

    `type` has the form of ROS 2, such as `std_msgs/msg/Bool`, even for bags of ROS 1. `definition` is the
    text of the type, or empty if the bag has none. `latched` is true if the publisher kept its last message
    for late subscribers.
    """

    topic: str
    type: str
    definition: str = ""
    idl: bool = False
    latched: bool = False


class Recorded(NamedTuple):
    """A serialised message and the time at which it was recorded (ns)."""

    time: int
    topic: str
    data: bytes
