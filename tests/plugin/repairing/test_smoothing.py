"""Smooth repairs: instead of a jump at a threshold, the sensor is added to the constant or scales it."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.mutate import Mutation, form_values
from pytest_tarl.repairing.smoothing import smoothed
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate
from pytest_tarl.sensors import Sensor
from tests.plugin.searching.test_search import operand

TOOL = Sensor("tool", topic="/tool", field="data", low=0, high=1, bins=10)
NAMED = replace(operand(4, "MARGIN", 0.5), definition=operand(1, "0.5", 0.5).span)
LONG = Guard((Conjunct(TOOL, 0.3, inf),))


def order(designed: int, drifted: int, sensor: Sensor = TOOL) -> Any:
    """Return an order in which the sensor is always in one bin of each world."""

    def world(place: int) -> Any:
        chain = SimpleNamespace(cell=np.zeros(3, int), count=np.full(3, 5.0))
        return SimpleNamespace(cells=[(place,)], chain=chain)

    return SimpleNamespace(
        root=Path("nowhere"),
        comparison=SimpleNamespace(sensors=(sensor,)),
        fixture=SimpleNamespace(sample=world(designed)),
        online=SimpleNamespace(recorded=SimpleNamespace(sample=world(drifted))),
    )


def names(found: list[Candidate]) -> list[str]:
    return [one.mutations[0].form.template.name for one in found if one.mutations[0].form is not None]


def test_sensor_is_added_where_its_size_matches_the_change() -> None:
    found = list(smoothed(order(0, 3), Candidate((Mutation(NAMED, 1.5),), LONG)))  # 0.5 → 0.75 at 0.35
    assert names(found) == ["sum", "scale"]
    assert all(one.guard == ALWAYS for one in found)
    assert form_values(found[1].mutations[0]) == {"share": pytest.approx(0.25 / 0.5 / 0.35, rel=0.05)}


@pytest.mark.parametrize("factor", [1.1, 0.5, 5.0])
def test_change_unlike_any_sensor_is_only_scaled(factor: float) -> None:
    found = list(smoothed(order(0, 3), Candidate((Mutation(NAMED, factor),), LONG)))
    assert names(found) == ["scale"]


@pytest.mark.parametrize(
    ("candidate", "designed"),
    [
        (Candidate((Mutation(NAMED, 1.5),), ALWAYS), 0),
        (Candidate((Mutation(NAMED, 1.5),), LONG), 2),
        (Candidate((Mutation(NAMED, 1.5), Mutation(operand(5, "2.0", 2.0), 3.0)), LONG), 0),
        (Candidate((Mutation(operand(5, "0.0", 0.0), 1.2),), LONG), 0),
        (Candidate((Mutation(operand(5, "True", True), value=False),), LONG), 0),
    ],
)
def test_smoothing_needs_a_jump_or_a_resting_sensor(candidate: Candidate, designed: int) -> None:
    assert list(smoothed(order(designed, 3), candidate)) == []


def visited(*bins: tuple[int, float]) -> Any:
    """Return a world in which the sensor is in bins, each for a number of steps."""
    chain = SimpleNamespace(cell=np.arange(len(bins)), count=np.array([steps for _, steps in bins]))
    return SimpleNamespace(cells=[(place,) for place, _ in bins], chain=chain)


def test_change_size_is_compared_with_the_sensor_mean() -> None:
    asked = order(0, 3)
    # 0.35 for 30 steps and 0.75 for 10 steps; the condition does not hold in the other bins
    asked.online.recorded.sample = visited((3, 30.0), (7, 10.0), (0, 500.0), (2, 100.0), (10, 70.0))
    found = list(smoothed(asked, Candidate((Mutation(NAMED, 1.5),), LONG)))
    assert form_values(found[1].mutations[0]) == {"share": pytest.approx(0.25 / 0.5 / 0.45, rel=0.05)}


def test_idle_conditional_change_is_not_smoothed() -> None:
    asked = order(0, 3)
    asked.online.recorded.sample = visited((1, 30.0), (2, 100.0))
    assert list(smoothed(asked, Candidate((Mutation(NAMED, 1.5),), LONG))) == []


@pytest.mark.parametrize(("away", "smooth"), [(10.0, True), (10.1, False)])
def test_resting_sensor_is_near_zero_in_nine_of_ten_steps(away: float, smooth: bool) -> None:
    asked = order(0, 3)
    asked.fixture.sample = visited((0, 50.0), (5, away), (0, 40.0))
    assert bool(list(smoothed(asked, Candidate((Mutation(NAMED, 1.5),), LONG)))) is smooth


@pytest.mark.parametrize(
    ("factor", "summed"), [(1.35, True), (1.349, False), (2.4, True), (2.41, False), (0.65, False)]
)
def test_plain_sum_is_tried_within_a_factor_of_two(factor: float, summed: bool) -> None:
    found = list(smoothed(order(0, 3), Candidate((Mutation(NAMED, factor),), LONG)))  # 0.35 / 2 to 0.35 * 2
    assert ("sum" in names(found)) is summed
