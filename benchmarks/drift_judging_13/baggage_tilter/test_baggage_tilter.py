"""A tray of a baggage sorter tips bags into chutes. Now and then, a bag has a sticky bottom and slides late."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")

DT = 0.1
FINE = 10  # number of steps of the sliding bag per step of the world
BAGS = 4
LAP = 10.5  # m
CHUTES = {1: 3.4, 2: 6.4}
WIDE = 2.4  # m
TRAY = 0.6  # distance from the middle of the tray to its edge (m)
TILTING = 1.3  # rad/s


class Sorter:
    """One car on the chain of a sorter; in `share` of the shifts, one bag is sticky."""

    def __init__(self, rng, share):
        self.rng = rng
        self.friction = [rng.uniform(0.27, 0.33) for _ in range(BAGS)]
        if rng.random() < share:
            self.friction[int(rng.integers(BAGS))] = rng.uniform(0.48, 0.51)
        self.chutes = [int(rng.integers(1, 3)) for _ in range(BAGS)]
        self.speed = 1.5 * rng.uniform(0.985, 1.015)
        self.position, self.bag = 0.0, 0
        self.tilt, self.slid, self.sliding = 0.0, 0.0, 0.0
        self.on_tray = True
        self.gained = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all bags have been carried."""
        return bool(self.failure) or self.bag >= BAGS

    def publish(self, bus):
        """Publish the position of the car, the chute of its bag, and its photocell."""
        bus.publish("car/position", Float32(data=self.position + self.rng.normal(0.0, 0.01)))
        bus.publish("car/chute", Int32(data=self.chutes[self.bag]))
        bus.publish("car/occupied", Bool(data=self.on_tray))

    def advance(self, tilt):
        """Move the car for one step; the bag slides while the tray is steep."""
        wanted = tilt.data if tilt is not None else 0.0
        self.gained = -0.002
        for _ in range(FINE):
            dt = DT / FINE
            self.tilt += max(-TILTING * dt, min(TILTING * dt, wanted - self.tilt))
            self.position += self.speed * dt
            if self.on_tray:
                self._slide(dt)
        if self.position > LAP:
            if self.on_tray:
                self.failure = f"bag {self.bag + 1} misses its flight"
            self.bag += 1
            self.position -= LAP
            self.on_tray, self.slid, self.sliding = True, 0.0, 0.0

    def _slide(self, dt):
        friction = self.friction[self.bag]
        pull = 9.81 * (math.sin(self.tilt) - friction * math.cos(self.tilt))
        self.sliding = max(0.0, self.sliding + pull * dt)
        self.slid += self.sliding * dt
        if self.slid > TRAY:
            self.on_tray = False
            into = self.position - CHUTES[self.chutes[self.bag]]
            if 0.0 < into < WIDE:
                self.gained += 10.0 / BAGS * (1.0 - 0.4 * max(0.0, self.sliding - 1.9))
            else:
                self.failure = f"bag {self.bag + 1} falls beside its chute"

    def judge(self):
        """Return the reward of the step: bags that get into their chute softly."""
        return self.gained - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["baggage_tilter.py"],
    sensors=[
        Sensor("position", topic="car/position", field="data", low=0.0, high=10.5, bins=7, unit="m"),
        Sensor("occupied", topic="car/occupied", field="data"),
        Sensor("chute", topic="car/chute", field="data"),
    ],
    drifts={"sticky bags": 0.12},
    episodes=300,
    min_success=0.97,
)
def test_sorts(tarl, tarl_drift):
    """Carry the bags of one shift."""
    sorter = Sorter(tarl.rng("sorter"), tarl_drift or 0.0)
    tarl.start("baggage_tilter.py")
    while not sorter.done:
        sorter.publish(tarl.bus)
        tarl.step(DT)
        sorter.advance(tarl.bus.latest("car/tilt"))
        tarl.reward(sorter.judge())
    assert not sorter.failure, sorter.failure
