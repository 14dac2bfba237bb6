"""A varying delay, as on a loaded computer or a shared network; messages keep their order."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pytest_tarl.faults.topic import LONGEST, Arrivals, Channel, TopicFault, of_topic, up_to

if TYPE_CHECKING:
    import numpy as np


def jitter(topic: str, most: float) -> TopicFault:
    """Return a fault that delays each message by a random time, uniform from 0 to a size of up to `most` s."""

    def begin(size: float, draws: np.random.Generator) -> Channel:
        arrival = [0.0]  # when the previous message arrived (s)

        def delayed(message: Any, now: float) -> Arrivals:
            arrival[0] = max(arrival[0], now + size * float(draws.random()))
            return [(arrival[0] - now, message)]

        return delayed

    return of_topic("jitter", topic, up_to("jitter", most, LONGEST), begin)
