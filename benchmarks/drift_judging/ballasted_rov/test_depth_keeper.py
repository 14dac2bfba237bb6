"""The robot reaches its depth and stays near it. A tool in its claw sinks or floats; no sensor measures which."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
Bool = message_type("std_msgs/msg/Bool")

DT = 0.2
TIME = 46.0
SETTLED = 30.0  # time from which the depth is rewarded, s
BAND = 0.15  # m
MOST_OUT = 4.0  # maximum time out of the band, s
LATENCY = 5  # periods until a command reaches the thruster


class Water:
    """A robot in water; `load` is the acceleration by its tools, up or down, m/s²."""

    def __init__(self, rng, load):
        self.rng = rng
        self.tool = load > 0.0
        self.load = load * rng.uniform(0.7, 1.2) * (1 if rng.random() < 0.5 else -1)
        self.wanted = rng.uniform(2.0, 4.0)
        self.depth, self.speed, self.thrust = self.wanted + rng.uniform(-1.0, 1.0), 0.0, 0.0
        self.waiting = [0.0] * LATENCY
        self.out = 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the dive is over."""
        return self.time >= TIME

    def publish(self, bus):
        """Publish the measurements of claw and pressure sensor."""
        bus.publish("/tool", Bool(data=self.tool))
        bus.publish("/wanted_depth", Float64(data=self.wanted))
        bus.publish("/pressure", Float64(data=10.1 * self.depth + self.rng.normal(0.0, 0.05)))

    def advance(self, thrust):
        """Sink for one step; commands and thrusters act with a delay."""
        self.waiting.append(max(-1.0, min(1.0, thrust.data)) if thrust else 0.0)
        self.thrust += (self.waiting.pop(0) - self.thrust) * DT / 0.5
        self.speed += (self.thrust + self.load - 0.3 * self.speed) * DT
        self.depth += self.speed * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step."""
        if self.time < SETTLED:
            return 0.0
        if abs(self.depth - self.wanted) <= BAND:
            return 10.0 * DT / (TIME - SETTLED)
        self.out += DT
        if self.out > MOST_OUT:
            self.failure = "does not hold its depth"
            return -4.0
        return 0.0


@pytest.mark.tarl(
    nodes=["depth_keeper.py"],
    sensors=[
        Sensor("tool", topic="/tool", field="data"),
        Sensor("pressure", topic="/pressure", field="data", low=10, high=50, bins=4, unit="kPa"),
    ],
    drifts={"tools": 0.08},
    episodes=100,
    min_success=0.95,
)
def test_holds_its_depth(tarl, tarl_drift):
    """Stay at the depth that the operator requests."""
    water = Water(tarl.rng("water"), tarl_drift or 0.0)
    tarl.start("depth_keeper.py")
    while not (water.done or water.failure):
        water.publish(tarl.bus)
        tarl.step(DT)
        water.advance(tarl.bus.latest("/thrust"))
        tarl.reward(water.judge())
    assert not water.failure, water.failure
