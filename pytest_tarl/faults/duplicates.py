"""Messages that arrive twice, as after a lost acknowledgement or with two publishers of one topic."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pytest_tarl.faults.topic import Channel, TopicFault, of_topic, up_to

if TYPE_CHECKING:
    import numpy as np


def duplicates(topic: str, most: float) -> TopicFault:
    """Return a fault that delivers a message twice, with a probability up to `most`."""

    def begin(size: float, draws: np.random.Generator) -> Channel:
        return lambda message, _: [(0.0, message)] * (2 if draws.random() < size else 1)

    return of_topic("duplicates", topic, up_to("duplicates", most, 1.0), begin)
