"""A constant factor, as from a worn wheel with an encoder, or a wrong unit."""

from __future__ import annotations

from pytest_tarl.faults.topic import TopicFault, of_field, sizes


def scale(topic: str, field: str, low: float, high: float) -> TopicFault:
    """Return a fault that multiplies a field by a factor from `low` to `high`; 1 means no fault."""
    return of_field("scale", topic, field, sizes("scale", low, high, 1.0), lambda size, _: lambda x: x * size)
