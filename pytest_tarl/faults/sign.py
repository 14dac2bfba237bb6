"""A wrong sign, as from swapped wires of a motor or encoder, or another axis convention."""

from __future__ import annotations

from pytest_tarl.faults.topic import OFF_ON, TopicFault, of_field


def sign(topic: str, field: str) -> TopicFault:
    """Return a fault that negates a field; it is either on or off."""
    return of_field("sign", topic, field, OFF_ON, lambda _size, _draws: lambda x: -x)
