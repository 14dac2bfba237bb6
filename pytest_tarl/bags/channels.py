"""The contents of a bag in any format: typed channels, and messages in order of time."""

from __future__ import annotations

from typing import NamedTuple


class Channel(NamedTuple):
    """A recorded topic.

    `type` is written as in ROS 2, for example `std_msgs/msg/Bool`, even for ROS 1. `definition` is the text of the
    type; it is empty if the bag does not have it. `latched` is true if the publisher kept its last message for late
    subscribers.
    """

    topic: str
    type: str
    definition: str = ""
    idl: bool = False
    latched: bool = False


class Recorded(NamedTuple):
    """A serialised message, and the time at which it was recorded (ns)."""

    time: int
    topic: str
    data: bytes
