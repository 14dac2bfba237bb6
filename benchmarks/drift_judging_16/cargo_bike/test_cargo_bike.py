"""A cargo bike helps its rider. With two children in the box, the usual help is not enough."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Vector3Stamped = message_type("geometry_msgs/Vector3Stamped")

DT = 0.1
STEPS = 300
EMPTY, CHILDREN = 6.0, 78.0  # load in the box (kg)


class Street:
    """A bike that climbs a gentle street; `load` is what its box holds, in kg."""

    def __init__(self, rng, load):
        self.rng = rng
        self.load = load
        self.mass = 112.0 + rng.normal(0.0, 2.0) + load
        self.legs = rng.uniform(0.98, 1.02)
        self.grade = rng.uniform(0.025, 0.027)
        self.speed, self.current, self.temp, self.now = 4.0, 0.0, 30.0, 0
        self.slow = self.fast = 0
        self.gained = 0.0

    @property
    def cadence(self):
        """Return the cadence in rev/min, in a fixed gear."""
        return 13.0 * self.speed

    @property
    def torque(self):
        """Return the torque of the rider, who pushes harder at a low cadence."""
        return self.legs * max(0.0, 36.0 - 0.24 * self.cadence)

    def publish(self, bus):
        """Publish what the bike measures."""
        pedal = Vector3Stamped()
        pedal.vector.x = self.torque * (1.0 + 0.1 * self.rng.normal())
        pedal.vector.y = self.cadence + self.rng.normal(0.0, 0.5)
        bus.publish("bike/pedal", pedal)
        bus.publish("bike/speed", Float32(data=self.speed + self.rng.normal(0.0, 0.03)))
        bus.publish("bike/grade", Float32(data=self.grade + self.rng.normal(0.0, 0.002)))
        bus.publish("motor/temperature", Float32(data=self.temp))
        bus.publish("box/load", Float32(data=self.load + self.rng.normal(0.0, 1.0)))

    def advance(self, command):
        """Ride on for one step; parents want to keep a speed of 5.0 to 6.3 m/s."""
        self.current += 0.5 * ((command.data if command else 0.0) - self.current)
        self.temp += DT * (0.0015 * self.current**2 - 0.01 * (self.temp - 25.0))
        drive = 1.36 * self.torque + 5.2 * self.current
        drag = 9.81 * self.mass * (self.grade + 0.008) + 0.42 * self.speed**2
        self.speed = max(0.3, self.speed + DT * (drive - drag) / self.mass)
        self.now += 1
        self.gained = 0.0
        if self.now > 120:
            low, high = max(0.0, 5.0 - self.speed), max(0.0, self.speed - 6.3)
            self.slow += low > 0.0
            self.fast += high > 0.0
            self.gained = 0.05 - 0.1 * low - 0.1 * high


@pytest.mark.tarl(
    nodes=["cargo_bike.py"],
    sensors=[
        Sensor("speed", topic="bike/speed", field="data", low=0.0, high=8.0, bins=4, unit="m/s"),
        Sensor("load", topic="box/load", field="data", low=0.0, high=120.0, bins=3, unit="kg"),
        Sensor("crank", topic="bike/pedal", field="vector.x", low=0.0, high=40.0, bins=4, unit="Nm"),
    ],
    drifts={"children": CHILDREN},
    episodes=200,
    min_success=0.97,
)
def test_rides(tarl, tarl_drift):
    """Ride for half a minute."""
    street = Street(tarl.rng("street"), tarl_drift or EMPTY)
    tarl.start("cargo_bike.py")
    for _ in range(STEPS):
        street.publish(tarl.bus)
        tarl.step(DT)
        street.advance(tarl.bus.latest("motor/current"))
        tarl.reward(street.gained)
    assert street.slow <= 22, f"too slow for {DT * street.slow:.0f} s"
    assert street.fast <= 22, f"too fast for {DT * street.fast:.0f} s"
