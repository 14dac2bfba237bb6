"""A carton is lifted without being dropped. The power of the pump costs reward; otherwise only the end is rewarded."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
UInt8 = message_type("std_msgs/msg/UInt8")
String = message_type("std_msgs/msg/String")

DT = 0.05
TIME_BOUND = 7.0
MASS = (0.9, 1.5, 2.2)  # kg
CUP = 0.0011  # m²


class Carton:
    """A carton under the cup; `hold` is the share of the area of the cup that seals on the cardboard."""

    def __init__(self, rng, hold):
        self.rng = rng
        self.surface = "smooth" if hold == 1.0 else "rough"
        self.size = int(rng.integers(0, 3))
        self.mass = MASS[self.size] * rng.uniform(0.95, 1.05)
        self.area = CUP * hold
        self.vacuum, self.height, self.speed = 0.0, 0.0, 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def lifted(self):
        """Return whether the carton is at its goal."""
        return self.height >= 0.55

    def publish(self, bus):
        """Publish the measurements of camera, cup and arm."""
        bus.publish("/surface", String(data=self.surface))
        bus.publish("/size", UInt8(data=self.size))
        bus.publish("/vacuum", Float32(data=self.vacuum + self.rng.normal(0.0, 0.3)))
        bus.publish("/height", Float32(data=self.height + self.rng.normal(0.0, 0.001)))

    def advance(self, pump, lift):
        """Suck and lift for one step; a carton that is too heavy for the vacuum stays behind."""
        self.power = max(0.0, min(1.0, pump.data)) if pump else 0.0
        self.vacuum += (85.0 * self.power - self.vacuum) * DT / 0.25
        wanted = max(-0.5, min(0.8, lift.data)) if lift else 0.0
        before, self.speed = self.speed, self.speed + (wanted - self.speed) * 0.6
        pull = self.mass * (9.81 + (self.speed - before) / DT)
        if self.speed > 0.01 and self.vacuum * 1000.0 * self.area < pull:
            self.failure = "dropped the carton"
        self.height = max(0.0, self.height + self.speed * DT)
        self.time += DT

    def judge(self):
        """Return the reward of the step."""
        if self.time > TIME_BOUND:
            self.failure = "late"
        if self.failure:
            return -5.0
        return -0.005 * self.power + (10.0 if self.lifted else 0.0)


@pytest.mark.tarl(
    nodes=["gripper.py"],
    sensors=[
        Sensor("surface", topic="/surface", field="data", categories=("smooth", "rough")),
        Sensor("vacuum", topic="/vacuum", field="data", low=0, high=80, bins=8, unit="kPa"),
    ],
    drifts={"rough cardboard": 0.42},
    episodes=100,
    min_success=0.95,
)
def test_lifts(tarl, tarl_drift):
    """Lift the carton."""
    carton = Carton(tarl.rng("carton"), tarl_drift or 1.0)
    tarl.start("gripper.py")
    while not (carton.lifted or carton.failure):
        carton.publish(tarl.bus)
        tarl.step(DT)
        carton.advance(tarl.bus.latest("/pump"), tarl.bus.latest("/lift"))
        tarl.reward(carton.judge())
    assert carton.lifted, carton.failure
