"""The common contents of all bags: typed channels, and messages in the order of their times."""

from __future__ import annotations

from typing import NamedTuple


class Channel(NamedTuple):
    """A recorded topic. `type` is written as in ROS 2, `std_msgs/msg/Bool`, for bags of both generations.

    `definition` is the text of the type, empty if the bag has none; `latched` tells whether it was kept for late
    subscribers.
    """

    topic: str
    type: str
    definition: str = ""
    idl: bool = False
    latched: bool = False


class Recorded(NamedTuple):
    """A serialised message and when it was recorded, in ns."""

    time: int
    topic: str
    data: bytes
