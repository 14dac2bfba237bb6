"""Two swapped axes, as from a sensor mounted at an angle of 90°, or another frame convention."""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING, Any

from pytest_tarl.faults.message_numbers import store
from pytest_tarl.faults.topic import OFF_ON, Arrivals, Channel, TopicFault, require_text
from pytest_tarl.field_paths import dotted, field_value

if TYPE_CHECKING:
    import numpy as np


def swapped(topic: str, first: str, second: str) -> TopicFault:
    """Return a fault that exchanges the values of two fields; it is either on or off.

    Raise SettingsError for invalid arguments.
    """
    for what, value in (("topic", topic), ("field", first), ("field", second)):
        require_text("swapped", what, value)
    first, second = dotted(first), dotted(second)

    def exchange(message: Any, _now: float) -> Arrivals:
        copy = deepcopy(message)
        one, other = field_value(message, first), field_value(message, second)
        store(copy, first, other)
        store(copy, second, one)
        return [(0.0, copy)]

    def begin(_size: float, _draws: np.random.Generator) -> Channel:
        return exchange

    return TopicFault("swapped", topic, OFF_ON, begin, f"{first}, {second}")
