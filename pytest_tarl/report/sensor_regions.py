"""Describe sets of cells as boxes and in words."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Iterable, Sequence
from itertools import permutations

from pytest_tarl.sensors import Cell, Sensor

Box = tuple[tuple[int, int], ...]  # first and last bin of each sensor

# maximum number of sensor orders to try when merging bins; four sensors have this many orders
ORDERS = 24
NAMED = 3  # maximum number of places to name before "and 2 more"


def boxes(cells: Iterable[Cell], apart: Collection[int] = ()) -> tuple[Box, ...]:
    """Cover `cells` with few boxes; never merge bins of the sensors `apart`."""
    single = [tuple((index, index) for index in cell) for cell in sorted(set(cells))]
    if not single:
        return ()
    along = [d for d in range(len(single[0])) if d not in apart]
    covers = []
    for order, _ in zip(permutations(along), range(ORDERS), strict=False):
        cover = single
        for dimension in order:
            cover = _merged(cover, dimension)
        covers.append(tuple(sorted(cover)))
    return min(covers, key=lambda cover: (len(cover), cover))


def _merged(cover: Sequence[Box], dimension: int) -> list[Box]:
    """Join boxes that touch along `dimension` and are equal in all other dimensions."""
    by_rest: dict[Box, list[tuple[int, int]]] = defaultdict(list)
    for box in cover:
        by_rest[box[:dimension] + box[dimension + 1 :]].append(box[dimension])
    merged = []
    for rest, ranges in by_rest.items():
        merged += [(*rest[:dimension], joined, *rest[dimension:]) for joined in runs(ranges)]
    return merged


def runs(ranges: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
    """Join ranges of bins that touch or overlap."""
    joined: list[tuple[int, int]] = []
    for first, last in sorted(ranges):
        if joined and first <= joined[-1][1] + 1:
            joined[-1] = (joined[-1][0], max(last, joined[-1][1]))
        else:
            joined.append((first, last))
    return joined


def bridged(cover: Iterable[Box], others: Iterable[Cell]) -> tuple[Box, ...]:
    """Join boxes with only unvisited cells between them."""
    kept, pending, barred = [], list(cover), list(others)
    while pending:
        box = pending.pop(0)
        for other in pending:
            hull = tuple((min(a[0], b[0]), max(a[1], b[1])) for a, b in zip(box, other, strict=True))
            if not any(_holds(hull, cell) for cell in barred):
                pending.remove(other)
                pending.insert(0, hull)
                break
        else:
            kept.append(box)
    return tuple(kept)


def closed(cover: Iterable[Box], dimension: int, bins: int) -> tuple[Box, ...]:
    """Join boxes that meet where an angle wraps around, such as at ±180°.

    The last bin of such a box has an index beyond the number of bins.
    """
    kept = list(cover)
    for ending in [box for box in kept if box[dimension][1] == bins - 1 and box[dimension][0] > 0]:
        first = ending[dimension][0]
        for beginning in kept:
            last = beginning[dimension][1]
            joined = (*beginning[:dimension], ending[dimension], *beginning[dimension + 1 :])
            if beginning[dimension][0] == 0 and joined == ending and beginning is not ending:
                kept = [box for box in kept if box not in (ending, beginning)]
                kept.append((*ending[:dimension], (first, last + bins), *ending[dimension + 1 :]))
                break
    return tuple(kept)


def _holds(box: Box, cell: Cell) -> bool:
    return all(first <= index <= last for (first, last), index in zip(box, cell, strict=True))


class Vocabulary:
    """Names for bins and for sets of cells."""

    def __init__(self, sensors: Sequence[Sensor], seen: Iterable[Cell]) -> None:
        self.sensors = tuple(sensors)
        self.cells = frozenset(seen)
        by_sensor = list(zip(*self.cells, strict=True)) or [()] * len(self.sensors)
        self.seen = tuple(sorted(set(bins)) for bins in by_sensor)

    def words(self, cells: Iterable[Cell], most: int = NAMED) -> str:
        """Describe a set of cells with at most `most` boxes."""
        chosen = frozenset(cells)
        cover = bridged(boxes(chosen), self.cells - chosen)
        for dimension, sensor in enumerate(self.sensors):
            if sensor.angle and sensor.bins is not None:
                cover = closed(cover, dimension, sensor.bins)
        if not cover:
            return "nowhere"
        places: dict[tuple[str, ...], list[tuple[int, int]]] = defaultdict(list)
        for box in cover:
            places[tuple(self._phrase(d, *box[d]) for d in range(1, len(box)))].append(box[0])
        named = [self._place(ranges, rest) for rest, ranges in places.items()]
        more = f"; and {len(named) - most} more" if len(named) > most else ""
        return "; ".join(named[:most]) + more

    def bin(self, dimension: int, index: int) -> str:
        """Name one bin with its sensor, such as `x 4.2-4.6 m` or `terrain true`."""
        sensor = self.sensors[dimension]
        return f"{sensor.name} {self._range(dimension, index, index)}".rstrip()

    def value(self, dimension: int, index: int) -> str:
        """Name one bin without the name of its sensor."""
        return self._range(dimension, index, index)

    def _place(self, ranges: Sequence[tuple[int, int]], rest: Sequence[str]) -> str:
        phrases = [self._several(ranges), *rest]
        return ", ".join(phrase for phrase in phrases if phrase) or "everywhere"

    def _several(self, ranges: Sequence[tuple[int, int]]) -> str:
        """Describe ranges of the first sensor, such as `x 1.0-2.0 or 4.0-7.0 m`."""
        if len(ranges) == 1:
            return self._phrase(0, *ranges[0])
        joined = runs(ranges)
        unit = self.sensors[0].unit
        named = [
            self._range(0, *one).removesuffix(f" {unit}") if unit else self._range(0, *one) for one in joined
        ]
        more = f" or {len(named) - NAMED} more" if len(named) > NAMED else ""
        return f"{self.sensors[0].name} {' or '.join(named[:NAMED])}{unit and ' ' + unit}{more}"

    def _phrase(self, dimension: int, first: int, last: int) -> str:
        """Describe a range of bins; empty if it has all values of a category."""
        sensor, seen = self.sensors[dimension], self.seen[dimension]
        if not sensor.numeric and len(seen) > 1 and first <= seen[0] and last >= seen[-1]:
            return ""
        return f"{sensor.name} {self._range(dimension, first, last)}"

    def _range(self, dimension: int, first: int, last: int) -> str:
        sensor = self.sensors[dimension]
        if sensor.numeric:
            return _interval(sensor, first, last)
        return " or ".join(self._category(dimension, index) for index in range(first, last + 1))

    def _category(self, dimension: int, index: int) -> str:
        sensor = self.sensors[dimension]
        if not sensor.categories and set(self.seen[dimension]) <= {0, 1} and index in (0, 1):
            return ("false", "true")[index]
        return sensor.label(index)


def _interval(sensor: Sensor, first: int, last: int) -> str:
    """Format a range of bins, rounded to a tenth of a bin's width."""
    low, high = sensor.interval(first, last)
    digits = max(0, -math.floor(math.log10(sensor.resolution)))
    unit = sensor.unit and " " + sensor.unit
    if math.isinf(low) and math.isinf(high):
        return "anywhere"
    if math.isinf(low):
        return f"below {high:.{digits}f}{unit}"
    if math.isinf(high):
        return f"above {low:.{digits}f}{unit}"
    if low > high:
        return f"above {low:.{digits}f} or below {high:.{digits}f}{unit}"
    between = " to " if low < 0 else "-"
    return f"{low:.{digits}f}{between}{high:.{digits}f}{unit}"
