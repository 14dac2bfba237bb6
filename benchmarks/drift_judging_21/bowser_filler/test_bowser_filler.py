"""A water bowser is filled. Its tank got a new lid with a hatch, and the sensor sits higher than it did, for good."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Range = message_type("sensor_msgs/Range")

DT = 0.5
LID = {"mount": 1.62}
HATCH = {"mount": 1.83}  # m above the bottom


class Tank:
    """A tank of 1.45 m with a sensor at `mount`, in m."""

    def __init__(self, rng, mount):
        self.rng = rng
        self.mount = mount + rng.normal(0.0, 0.003)
        self.flow = 0.036 * rng.uniform(0.9, 1.1)  # m/s
        self.water, self.slot, self.spilt = float(rng.uniform(0.05, 0.4)), 0.0, 0.0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the filling is over."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the echo, and every few seconds the contact of the hydrant."""
        if round(self.time / DT) == 2:
            bus.publish("hydrant/docked", Bool(data=True))
        bus.publish("tank/echo", Range(range=self.mount - self.water + self.rng.normal(0.0, 0.006)))

    def advance(self, valve, status):
        """Let water in for one step."""
        self.time += DT
        self.gained = -0.01
        self.slot += 0.4 * ((valve.data if valve else 0.0) - self.slot)
        self.water += DT * self.flow * self.slot
        if self.water > 1.45:
            self.spilt += self.water - 1.45
            self.gained -= 30.0 * (self.water - 1.45)
            self.water = 1.45
        if self.spilt > 0.05:
            self.failure = "water runs over the road"
        elif self.time > 90.0:
            self.failure = "bowser blocks the hydrant"
        elif status and status.data == "full" and self.slot < 0.02:
            self.over = True
            missing = abs(1.305 - self.water)
            self.gained += 6.0 - 25.0 * max(0.0, missing - 0.01)
            if missing > 0.1:
                self.failure = "bowser leaves with too little or too much"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["bowser_filler.py"],
    sensors=[
        Sensor("echo", topic="tank/echo", field="range", low=0.0, high=2.0, bins=8, unit="m"),
    ],
    drifts={"hatch": Drift(HATCH, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_fills(tarl, tarl_drift):
    """Fill the tank once."""
    tank = Tank(tarl.rng("tank"), **(tarl_drift or LID))
    tarl.start("bowser_filler.py")
    while not tank.done:
        tank.publish(tarl.bus)
        tarl.step(DT)
        tank.advance(tarl.bus.latest("bowser/valve"), tarl.bus.latest("bowser/status"))
        tarl.reward(tank.gained)
    assert not tank.failure, tank.failure
