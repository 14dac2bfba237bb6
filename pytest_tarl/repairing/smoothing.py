"""Replace a change that jumps at a sensor's threshold by a change that grows with the sensor's value.

`margin + self.length` reads better than `margin * 1.5 if self.length >= 0.3 else margin`, and suits other lengths.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

from pytest_tarl.model import Conjunct
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import Template, templates
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.telling_sensors import bins, continuous
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, effective_value
from pytest_tarl.sensors import Sensor

SUM, SCALE = "sum", "scale"
# a plain sum is tried if the constant's change and the sensor's value have at most this ratio
ALIKE = 2.0
REST = 0.9  # the sensor must be about zero in at least this share of the recorded steps


def smoothed(order: Order, candidate: Candidate) -> Iterator[Candidate]:
    """Yield unconditional candidates that add the sensor to the constant or scale the constant with the sensor.

    The candidate must change one constant, under one condition on a sensor that is about zero in the designed world.
    """
    if len(candidate.guard.conjuncts) != 1 or len(candidate.mutations) != 1:
        return
    (conjunct,), (mutation,) = candidate.guard.conjuncts, candidate.mutations
    value, sensor = mutation.operand.value, conjunct.sensor
    if not value or isinstance(value, bool) or mutation.form is not None or not continuous(sensor):
        return
    typical = _mean_where(order, conjunct)
    if not typical or not _rests_at_zero(order, sensor):
        return
    known = {one.name: one for one in templates(order.root)}
    ratio = (effective_value(mutation) - value) / typical
    if SUM in known and 1 / ALIKE <= ratio <= ALIKE:
        yield _formed(mutation, Form(known[SUM], sensor=sensor))
    if SCALE in known:
        share = float(f"{ratio / value:.2g}")
        yield _formed(
            mutation, Form(known[SCALE], defaults=((_parameter(known[SCALE]), share),), sensor=sensor)
        )


def _formed(mutation: Mutation, form: Form) -> Candidate:
    return Candidate((Mutation(mutation.operand, True, form=form),), ALWAYS)


def _parameter(template: Template) -> str:
    return template.parameters[0].name


def _mean_where(order: Order, conjunct: Conjunct) -> float | None:
    """Return a sensor's mean over the drifted steps in which a condition on it holds."""
    seen = [
        ((low + high) / 2, count)
        for low, high, count in bins(order, order.online.recorded.sample, conjunct.sensor)
        if conjunct.low <= low and high <= conjunct.high and isfinite(high - low)
    ]
    steps = sum(count for _, count in seen)
    return sum(middle * count for middle, count in seen) / steps if steps else None


def _rests_at_zero(order: Order, sensor: Sensor) -> bool:
    """Return whether a sensor is about zero in nearly all recorded steps."""
    seen = list(bins(order, order.fixture.sample, sensor))
    near = sum(count for low, high, count in seen if low <= 0.0 < high)
    return near >= REST * sum(count for _, _, count in seen) > 0.0
