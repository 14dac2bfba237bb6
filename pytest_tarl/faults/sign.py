"""A wrong sign, as caused by swapped wires of a motor or encoder or by a different axis convention."""

from __future__ import annotations

from pytest_tarl.faults.topic import OFF_ON, TopicFault, of_field


def sign(topic: str, field: str) -> TopicFault:
    """Return a fault that is off or on; if it is on, it negates a field."""
    return of_field("sign", topic, field, OFF_ON, lambda _size, _draws: lambda x: -x)
