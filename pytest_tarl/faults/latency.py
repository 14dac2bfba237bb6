"""A constant delay, as from slow processing or a long network path; header stamps do not change."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pytest_tarl.faults.topic import LONGEST, Channel, TopicFault, of_topic, up_to

if TYPE_CHECKING:
    import numpy as np


def latency(topic: str, most: float) -> TopicFault:
    """Return a fault that delays each message by up to `most` seconds."""

    def begin(size: float, _draws: np.random.Generator) -> Channel:
        return lambda message, _: [(size, message)]

    return of_topic("latency", topic, up_to("latency", most, LONGEST), begin)
