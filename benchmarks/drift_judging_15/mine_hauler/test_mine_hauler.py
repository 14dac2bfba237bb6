"""A truck backs up to the berm of a dump. With wet ore it is much heavier; only the pressure of the struts tells."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
FluidPressure = message_type("sensor_msgs/msg/FluidPressure")
Range = message_type("sensor_msgs/msg/Range")

DT = 0.1
TRUCK = 70.0  # t
USUAL, WET = 50.0, 170.0  # t of ore
TIME_BOUND = 60.0


class Dump:
    """A truck in front of a berm; `ore` is its load in t."""

    def __init__(self, rng, ore):
        self.rng = rng
        self.mass = TRUCK + ore * (1.0 + 0.03 * rng.normal())
        self.left, self.speed = rng.uniform(26.0, 28.0), 0.0
        self.slope = rng.normal(0.0, 0.01)
        self.brake, self.throttle = 0.0, 0.0
        self.time, self.still, self.gained, self.failure = 0.0, 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the truck stands at the berm, or has failed."""
        return bool(self.failure) or (self.still > 0.6 and self.left < 1.2)

    def publish(self, bus):
        """Publish the distance, the speed and the pressure of the struts."""
        seen = Range(min_range=0.2, max_range=60.0)
        seen.range = max(0.3, self.left + self.rng.normal(0.0, 0.03))
        bus.publish("berm", seen)
        bus.publish("wheel_speed", Float32(data=self.speed + self.rng.normal(0.0, 0.02)))
        bus.publish("struts", FluidPressure(fluid_pressure=4.5e4 * self.mass + self.rng.normal(0.0, 5e4)))

    def advance(self, command):
        """Drive for one step; brake and engine give a force, not an acceleration."""
        self.throttle += 0.4 * ((command.linear.x if command else 0.0) - self.throttle)
        self.brake += 0.5 * ((command.linear.y if command else 0.0) - self.brake)
        pull = (260.0 * self.throttle - 210.0 * self.brake - 4.0) / self.mass + 9.81 * self.slope
        before = self.left
        self.speed = max(0.0, self.speed + pull * DT)
        self.left -= self.speed * DT
        self.time += DT
        self.still = self.still + DT if self.speed < 0.02 else 0.0
        self.gained = 0.7 * (before - self.left) - 0.002
        if self.left < 0.25:
            self.failure = f"truck drives into the berm with {self.speed:.1f} m/s"
        elif self.time > TIME_BOUND:
            self.failure = "truck takes too long"
        if self.failure:
            self.gained -= 12.0


@pytest.mark.tarl(
    nodes=["mine_hauler.py"],
    sensors=[
        Sensor("distance", topic="berm", field="range", low=0.0, high=30.0, bins=6, unit="m"),
        Sensor("speed", topic="wheel_speed", field="data", low=0.0, high=4.0, bins=4, unit="m/s"),
        Sensor("struts", topic="struts", field="fluid_pressure", low=4.0e6, high=1.1e7, bins=5, unit="Pa"),
    ],
    drifts={"wet ore": WET},
    episodes=200,
    min_success=0.97,
)
def test_backs_up(tarl, tarl_drift):
    """Back up once."""
    dump = Dump(tarl.rng("dump"), tarl_drift or USUAL)
    tarl.start("mine_hauler.py")
    while not dump.done:
        dump.publish(tarl.bus)
        tarl.step(DT)
        dump.advance(tarl.bus.latest("drive"))
        tarl.reward(dump.gained)
    assert not dump.failure, dump.failure
