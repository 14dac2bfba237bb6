"""White noise, as from a cheap or ageing sensor or from interference."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from pytest_tarl.faults.topic import TopicFault, of_field, up_to

if TYPE_CHECKING:
    import numpy as np


def noise(topic: str, field: str, most: float) -> TopicFault:
    """Return a fault that adds independent normal noise to a field, with a standard deviation of up to `most`."""

    def noisy(size: float, draws: np.random.Generator) -> Callable[[float], float]:
        return lambda x: x + float(draws.normal(0.0, size))

    return of_field("noise", topic, field, up_to("noise", most), noisy)
