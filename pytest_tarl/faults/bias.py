"""A constant offset, as from a wrongly mounted or calibrated sensor."""

from __future__ import annotations

from pytest_tarl.faults.topic import TopicFault, of_field, sizes


def bias(topic: str, field: str, low: float, high: float) -> TopicFault:
    """Return a fault that adds a constant from `low` to `high` to a field; 0 means no fault."""
    return of_field("bias", topic, field, sizes("bias", low, high, 0.0), lambda size, _: lambda x: x + size)
