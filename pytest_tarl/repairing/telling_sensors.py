"""Find telling sensors, whose values usually show whether the world is the drifted or the designed one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import exp, isfinite, log

from pytest_tarl.learning.tables import Sample
from pytest_tarl.repairing.request import Order
from pytest_tarl.sensors import Sensor

VARIES = 1.5  # a sensor is said to vary if its number of visited bins grows at least by this factor
OVERLAP = 0.25  # a sensor is telling if at most this share of steps is in the same bins in both worlds


def telling(order: Order) -> list[Sensor]:
    """Return the telling numeric sensors, in their order."""
    return [one for one in order.comparison.sensors if continuous(one) and _overlap(order, one) <= OVERLAP]


def varies(order: Order, sensor: Sensor) -> bool:
    """Return whether a sensor uses more bins after the drift, so no constant fits all values.

    A bin counts by its share of the steps: the number is the exponential of the entropy of the shares.
    """
    designed = _shares(order, order.fixture.sample, sensor)
    drifted = _shares(order, order.online.recorded.sample, sensor)
    return bool(designed and drifted) and _used(drifted) >= VARIES * _used(designed)


def continuous(sensor: Sensor) -> bool:
    """Return whether a program can use a sensor's value in calculations."""
    return sensor.numeric and not sensor.angle and sensor.guardable


def usual(order: Order, sensor: Sensor, world: Sample | None = None) -> float:
    """Return a sensor's mean absolute value, computed from the middles of its bins; 1 if the mean is 0.

    `world` defaults to the drifted world.
    """
    seen = [
        (abs(low + high) / 2, count)
        for low, high, count in bins(order, world or order.online.recorded.sample, sensor)
        if isfinite(high - low)
    ]
    steps = sum(count for _, count in seen)
    return (sum(middle * count for middle, count in seen) / steps if steps else 0.0) or 1.0


def bins(order: Order, world: Sample, sensor: Sensor) -> Iterator[tuple[float, float, float]]:
    """For each entry of the Markov chain, yield the two ends of the sensor's bin and the number of steps."""
    names = [one.name for one in order.comparison.sensors]
    at = names.index(sensor.name)
    for cell, count in zip(world.chain.cell.tolist(), world.chain.count.tolist(), strict=True):
        low, high = sensor.interval(world.cells[cell][at], world.cells[cell][at])
        yield low, high, count


def _used(shares: Mapping[tuple[float, float], float]) -> float:
    return exp(-sum(share * log(share) for share in shares.values() if share))


def _overlap(order: Order, sensor: Sensor) -> float:
    """Return the share of steps that are in the same bins in both worlds; 1 if one world has no steps."""
    designed = _shares(order, order.fixture.sample, sensor)
    drifted = _shares(order, order.online.recorded.sample, sensor)
    if not designed or not drifted:
        return 1.0
    return sum(min(part, drifted.get(bin_, 0.0)) for bin_, part in designed.items())


def _shares(order: Order, world: Sample, sensor: Sensor) -> dict[tuple[float, float], float]:
    found: dict[tuple[float, float], float] = {}
    for low, high, count in bins(order, world, sensor):
        found[low, high] = found.get((low, high), 0.0) + count
    steps = sum(found.values())
    return {place: count / steps for place, count in found.items()} if steps else {}
