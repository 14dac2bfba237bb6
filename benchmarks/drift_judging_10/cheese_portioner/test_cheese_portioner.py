"""A machine cuts cheese into portions of 250 g. Cheese with large holes weighs less than its outline says."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Float32MultiArray = message_type("std_msgs/msg/Float32MultiArray")

DT = 0.05
PORTIONS = 4
GRAMS = 250.0
MAY_MISS = 0.12
KERF = 0.10  # cm
TIME_BOUND = 40.0


class Block:
    """A block of cheese 9 cm wide, whose height varies along it."""

    def __init__(self, rng, holes):
        self.rng = rng
        self.holes = rng.uniform(0.21, 0.25) if holes else rng.uniform(0.005, 0.03)
        self.height = rng.uniform(6.5, 8.0)
        self.waves = rng.uniform(0.2, 0.5), rng.uniform(0.0, 6.0)
        self.place, self.speed = 0.0, 0.0
        self.passed = 0.0  # mass since the last cut (g)
        self.down = False
        self.cut, self.bad = 0, 0
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all portions are cut, or the episode has failed."""
        return self.cut >= PORTIONS or bool(self.failure)

    @property
    def top(self):
        """Return the height under the scanner, cm."""
        return self.height + self.waves[0] * math.sin(0.8 * self.place + self.waves[1])

    def publish(self, bus):
        """Publish the scanner, the pusher and the share of holes in the X-ray image."""
        heights = [self.top + self.rng.normal(0.0, 0.05) for _ in range(10)]
        bus.publish("scanner/heights", Float32MultiArray(data=heights))
        bus.publish("pusher/place", Float32(data=self.place + self.rng.normal(0.0, 0.0005)))
        bus.publish("xray/holes", Float32(data=self.holes + self.rng.normal(0.0, 0.005)))

    def advance(self, cmd, blade):
        """Push and cut for one step."""
        self.time += DT
        self.gained = 0.0
        self.speed += 0.7 * ((cmd.data if cmd else 0.0) - self.speed)
        grams = 1.11 * (1.0 - self.holes) * 9.0 * self.top
        self.place += self.speed * DT
        self.passed += grams * self.speed * DT * self.rng.normal(1.0, 0.03)
        down = bool(blade and blade.data)
        if down and not self.down:
            self.weigh(self.passed - KERF * grams)
        self.down = down

    def weigh(self, grams):
        """Weigh a portion that is cut off."""
        off = grams / GRAMS - 1.0
        self.passed = 0.0
        self.cut += 1
        if abs(off) > MAY_MISS:
            self.bad += 1
        else:
            self.gained = 10.0 / PORTIONS * (1.0 - 0.4 * (off / MAY_MISS) ** 2)

    def judge(self):
        """Return the reward of the step."""
        if self.bad > 1:
            self.failure = "two portions have the wrong weight"
        elif self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        return -4.0 if self.failure else self.gained - 0.0005


@pytest.mark.tarl(
    nodes=["cheese_portioner.py", "profile_of_block.py"],
    sensors=[
        Sensor("holes", topic="xray/holes", field="data", low=0.0, high=0.3, bins=5),
        Sensor("height", low=6.0, high=8.5, bins=4, unit="cm"),
    ],
    drifts={"large holes": Drift(True)},
    episodes=100,
    min_success=0.95,
)
def test_cuts_portions(tarl, tarl_drift):
    """Cut one block."""
    block = Block(tarl.rng("block"), bool(tarl_drift))
    tarl.start("cheese_portioner.py")
    while not block.done:
        tarl.observe(height=block.top)
        block.publish(tarl.bus)
        tarl.step(DT)
        block.advance(tarl.bus.latest("pusher/speed"), tarl.bus.latest("blade/down"))
        tarl.reward(block.judge())
    assert not block.failure, block.failure
