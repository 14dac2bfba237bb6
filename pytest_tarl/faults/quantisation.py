"""Rounding, as by an encoder with fewer counts or a converter with fewer bits."""

from __future__ import annotations

from pytest_tarl.faults.topic import TopicFault, of_field, up_to


def quantisation(topic: str, field: str, most: float) -> TopicFault:
    """Return a fault that rounds a field to multiples of a step of up to `most`; inf and NaN stay unchanged."""

    def rounded(x: float, step: float) -> float:
        return x if x - x != 0.0 else round(x / step) * step

    return of_field(
        "quantisation", topic, field, up_to("quantisation", most), lambda size, _: lambda x: rounded(x, size)
    )
