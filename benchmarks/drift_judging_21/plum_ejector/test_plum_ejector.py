"""Soft plums are blown off a belt. When the presses next door run, the air has 4.3 bar, and a blow is too weak."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

FluidPressure = message_type("sensor_msgs/msg/FluidPressure")
Float32 = message_type("std_msgs/msg/Float32")
Float32MultiArray = message_type("std_msgs/msg/Float32MultiArray")

DT = 0.2
FRUITS = 40
ALONE = {"bar": 6.2, "lag": 0.008}
PRESSES = {"bar": 4.3, "lag": 0.010}  # gauge pressure, s until a valve is open


class Belt:
    """A belt with four lanes and jets of air at `bar`, whose valves open after `lag` s."""

    def __init__(self, rng, bus, bar, lag):
        self.rng = rng
        self.bus = bus
        self.bar = bar * rng.uniform(0.97, 1.03)
        self.lag = lag
        self.speed = float(rng.uniform(0.7, 0.9))
        self.shots = []
        self.gone, self.left, self.hurt = 0, 0, 0
        self.gained, self.failure = 0.0, ""
        bus.subscribe("valves/fire", self.shots.append)

    @property
    def done(self):
        """Return whether the crate is full, or the batch is lost."""
        return bool(self.failure) or self.gone == FRUITS

    def publish(self):
        """Publish the belt, the air, and one fruit."""
        self.ripe = bool(self.rng.random() < 0.3)
        self.lane = int(self.rng.integers(0, 4))
        softness = self.rng.normal(0.72 if self.ripe else 0.36, 0.045)
        self.shots.clear()
        self.bus.publish("belt/speed", Float32(data=self.speed))
        pressure = self.bar + self.rng.normal(0.0, 0.05)
        self.bus.publish("air/pressure", FluidPressure(fluid_pressure=pressure * 1e5))
        self.bus.publish("camera/fruit", Float32MultiArray(data=[float(self.lane), softness]))

    def advance(self):
        """Let the fruit pass the jets."""
        self.gone += 1
        self.gained = -0.01
        blow = 0.0  # bar s
        for lane, delay, pulse in (shot.data for shot in self.shots):
            self.gained -= 0.7 * pulse
            if int(lane) == self.lane and abs(delay * self.speed - 0.42) < 0.04:
                blow += max(0.0, pulse - self.lag) * self.bar
        blow /= self.rng.normal(1.0, 0.05)  # heavy fruit takes more
        if self.ripe and blow < 0.072:
            self.left += 1
            self.gained -= 0.6
        elif self.ripe:
            self.gained += 0.5 - 7.0 * max(0.0, abs(blow - 0.1) - 0.01)
            if blow > 0.148:  # it bursts on the chute
                self.hurt += 1
                self.gained -= 0.6
        elif blow > 0.0:
            self.gained -= 0.5
        if self.left > 3:
            self.failure = "soft fruit is left in the crate"
        elif self.hurt > 3:
            self.failure = "the chute is full of pulp"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["plum_ejector.py"],
    sensors=[
        Sensor("air", topic="air/pressure", field="fluid_pressure", low=3e5, high=7e5, bins=8, unit="Pa"),
        Sensor("belt", topic="belt/speed", field="data", low=0.6, high=1.0, bins=4, unit="m/s"),
    ],
    drifts={"presses": PRESSES},
    episodes=200,
    min_success=0.97,
)
def test_grades(tarl, tarl_drift):
    """Grade one crate of plums."""
    belt = Belt(tarl.rng("belt"), tarl.bus, **(tarl_drift or ALONE))
    tarl.start("plum_ejector.py")
    tarl.step(DT)
    while not belt.done:
        belt.publish()
        tarl.step(DT)
        belt.advance()
        tarl.reward(belt.gained)
    assert not belt.failure, belt.failure
