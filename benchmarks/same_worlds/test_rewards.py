"""Worlds with partly constant rewards, so that only rounding might distinguish a recorded world from a live one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import pytest

from pytest_tarl import Sensor
from pytest_tarl.episode import Tarl
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
Bool = message_type("std_msgs/msg/Bool")

PLACE = Sensor("place", topic="/place", field="data", low=0, high=5, bins=10, unit="m")
LOADED = Sensor("loaded", topic="/loaded", field="data")
STILL = Sensor("still", low=0, high=1, bins=4)
DT = 0.5  # duration of a step (s)


@dataclass
class Way:
    """A robot that slips at random on its way from 0 to 5 m."""

    tarl: Tarl
    steps: int = 40
    place: float = 0.0
    before: float = 0.0
    done: int = 0

    def __post_init__(self) -> None:
        self.draws = self.tarl.rng("world")
        self.tarl.start("mover.py")
        self.place = self.before = float(self.draws.uniform(0.0, 0.5))
        self.loaded = bool(self.draws.random() < 0.5)

    @property
    def arrived(self) -> bool:
        """Return whether the goal is reached."""
        return self.place > 4.8

    def step(self) -> None:
        """Publish, let the node run, and move."""
        self.tarl.bus.publish("/place", Float64(data=self.place))
        self.tarl.bus.publish("/loaded", Bool(data=self.loaded))
        self.tarl.step(DT)
        speed = self.tarl.bus.latest("/speed")
        slip = 0.3 if self.draws.random() < 0.3 else 1.0
        self.before = self.place
        self.place += DT * slip * (speed.data if speed else 0.0)
        self.done += 1

    def steps_to_goal(self) -> Iterator[Way]:
        """Yield after every step until the goal, or the last step."""
        while not self.arrived and self.done < self.steps:
            self.step()
            yield self


@pytest.mark.tarl(nodes=["mover.py"], sensors=[PLACE, LOADED])
def test_constant_cost(tarl: Tarl) -> None:
    """Each step costs a reward of 0.1."""
    for _ in Way(tarl).steps_to_goal():
        tarl.reward(-0.1)


@pytest.mark.tarl(nodes=["mover.py"], sensors=[PLACE])
def test_bonus_at_the_goal(tarl: Tarl) -> None:
    """Each step costs reward, and the goal gives reward."""
    for way in Way(tarl).steps_to_goal():
        tarl.reward(cost=-0.1, goal=10.0 if way.arrived else 0.0)


@pytest.mark.tarl(nodes=["mover.py"], sensors=[PLACE])
def test_saturated_speed(tarl: Tarl) -> None:
    """Speed gives reward, up to a limit that is usually reached."""
    for way in Way(tarl).steps_to_goal():
        tarl.reward(min(0.13, way.place - way.before))


@pytest.mark.tarl(nodes=["mover.py"], sensors=[PLACE, LOADED])
def test_whole_numbers(tarl: Tarl) -> None:
    """Rewards are whole."""
    for way in Way(tarl).steps_to_goal():
        tarl.reward(-3 if way.place - way.before < 0.2 else 7)


@pytest.mark.tarl(nodes=["mover.py"], sensors=[PLACE])
def test_one_off_damage(tarl: Tarl) -> None:
    """In one of thirty missions, the robot is damaged once."""
    unlucky = tarl.rng("damage").random() < 1 / 30
    for way in Way(tarl).steps_to_goal():
        tarl.reward(-100.0 if unlucky and way.done == 5 else 0.0)


@pytest.mark.tarl(nodes=["mover.py"], sensors=[PLACE, LOADED])
def test_a_single_step(tarl: Tarl) -> None:
    """An episode is one step."""
    way = Way(tarl)
    way.step()
    tarl.reward(1.0 if way.loaded else 0.3)


@pytest.mark.tarl(nodes=["mover.py"], sensors=[PLACE, LOADED])
def test_equal_lengths(tarl: Tarl) -> None:
    """All episodes have the same number of steps, and all steps cost the same."""
    way = Way(tarl)
    for _ in range(20):
        way.step()
        tarl.reward(-0.7)


@pytest.mark.tarl(nodes=["mover.py"], sensors=[STILL])
def test_a_sensor_that_never_moves(tarl: Tarl) -> None:
    """All steps are in one cell."""
    tarl.observe(still=0.5)
    for way in Way(tarl).steps_to_goal():
        tarl.reward(-0.1 if way.place < 2.5 else -0.3)


@pytest.mark.tarl(nodes=["mover.py"], sensors=[PLACE, LOADED])
def test_there_and_back(tarl: Tarl) -> None:
    """Progress gives reward that is later taken back, so that totals cancel out except for rounding."""
    way = Way(tarl)
    gains = []
    for _ in range(10):
        way.step()
        gains.append(way.place - way.before)
        tarl.reward(gains[-1])
    for gain in reversed(gains):
        way.step()
        tarl.reward(-gain)
