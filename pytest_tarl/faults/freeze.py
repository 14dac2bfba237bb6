"""A frozen value: a driver repeats its last reading while the sensor is disconnected."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.faults.topic import LONGEST, Arrivals, Channel, TopicFault, moment, of_topic, up_to

if TYPE_CHECKING:
    import numpy as np


def freeze(topic: str, most: float, *, at: float = 0.0) -> TopicFault:
    """Return a fault that repeats the topic's last message for up to `most` seconds from the moment `at` on.

    Raise SettingsError if the moment is invalid.
    """
    begins = moment(at)
    if begins is None:
        raise SettingsError(f"faults.freeze: at must be a moment from 0 to {LONGEST:g} s, got {at!r}.")

    def begin(size: float, _draws: np.random.Generator) -> Channel:
        last: list[Any] = []

        def held(message: Any, now: float) -> Arrivals:
            if not last or not begins <= now < begins + size:
                last[:] = [message]
            return [(0.0, last[0])]

        return held

    return of_topic("freeze", topic, up_to("freeze", most, LONGEST), begin)
