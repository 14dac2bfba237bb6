"""Lost messages, as on a weak radio link or in a full queue."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pytest_tarl.faults.topic import Channel, TopicFault, of_topic, up_to

if TYPE_CHECKING:
    import numpy as np


def dropout(topic: str, most: float) -> TopicFault:
    """Return a fault that loses each message with a probability up to `most`."""

    def begin(size: float, draws: np.random.Generator) -> Channel:
        return lambda message, _: [] if draws.random() < size else [(0.0, message)]

    return of_topic("dropout", topic, up_to("dropout", most, 1.0), begin)
