"""Read and bin sensor values fast enough for a control cycle.

The functions return the same as `reading` and `Sensor.bin`. They have a fast path for messages with attributes and for
values of the usual types, and otherwise call `reading` and `Sensor.bin`.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from math import isfinite
from operator import attrgetter
from typing import Any

from pytest_tarl.field_paths import field_value
from pytest_tarl.sensors import Sensor

Read = Callable[[Any], Any]
Bin = Callable[[Any], int | None]
_EXACT = 2**53  # smaller integers convert to float exactly
_MOST = 64  # maximum number of message classes to remember per field


def reader(field: str | Read | None) -> Read:
    """Return a function that reads a field of a message; it raises the same exceptions as `reading`.

    `field` is a dotted path or a function.
    """
    if callable(field):
        return field
    path = field or ""
    parts = path.split(".")
    if not all(part.isidentifier() and not hasattr(dict, part) for part in parts):
        # `attrgetter` cannot read indices, or names that mappings also have as attributes
        return lambda message: field_value(message, path)
    fast = attrgetter(path)
    known: set[type] = set()  # message classes that the fast path can read

    def read(message: Any) -> Any:
        try:
            if type(message) in known:
                return fast(message)
            value = field_value(message, path)
            if len(known) < _MOST and fast(message) is value:
                known.add(type(message))
            return value
        except AttributeError:
            return field_value(message, path)  # the message contains a mapping, or does not have the field

    return read


def binner(sensor: Sensor) -> Bin:
    """Return a function that bins values of a sensor; it raises the same exceptions as `Sensor.bin`."""
    general = sensor.bin
    if sensor.bins is None or sensor.low is None or sensor.high is None:
        return general if sensor.categories or sensor.bins is not None else _whole(general)
    low, high, bins = sensor.low, sensor.high, sensor.bins
    width, edges = high - low, sensor.edges

    def uniform(value: Any) -> int | None:
        if type(value) is float and low <= value < high:
            at = int((value - low) / width * bins)
            return at if at < bins else bins - 1
        return general(value)

    def uneven(value: Any) -> int | None:
        if type(value) is float and low <= value < high:
            return bisect_right(edges, value) - 1
        return general(value)

    def turning(value: Any) -> int | None:
        if type(value) is not float or not isfinite(value):
            return general(value)
        number = low + (value - low) % width
        if number > high:
            return general(value)
        return min(bisect_right(edges, number) - 1 if edges else int((number - low) / width * bins), bins - 1)

    return turning if sensor.angle else uneven if edges else uniform


def _whole(general: Bin) -> Bin:
    def whole(value: Any) -> int | None:
        if value is True or value is False or (type(value) is int and -_EXACT < value < _EXACT):
            return int(value)
        return general(value)

    return whole
