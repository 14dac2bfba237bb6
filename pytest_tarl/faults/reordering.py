"""Messages in the wrong order, as over UDP or several network paths."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pytest_tarl.faults.topic import Arrivals, Channel, TopicFault, of_topic, up_to

if TYPE_CHECKING:
    import numpy as np


def reordering(topic: str, most: float) -> TopicFault:
    """Return a fault that delivers a message after its successor, with a probability up to `most`."""

    def begin(size: float, draws: np.random.Generator) -> Channel:
        waiting: list[Any] = []

        def exchanged(message: Any, _now: float) -> Arrivals:
            if waiting:
                return [(0.0, message), (0.0, waiting.pop())]
            if draws.random() < size:
                waiting.append(message)
                return []
            return [(0.0, message)]

        return exchanged

    return of_topic("reordering", topic, up_to("reordering", most, 1.0), begin)
