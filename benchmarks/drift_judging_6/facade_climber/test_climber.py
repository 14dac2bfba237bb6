"""A robot climbs glass to the next window. Plaster lets more air leak below the skirt, each wall a different amount."""

from pathlib import Path

import pytest
import yaml

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
FluidPressure = message_type("sensor_msgs/msg/FluidPressure")
String = message_type("std_msgs/msg/String")

DT = 0.1
SLIPS, FALLS = 2.0, 1.2  # kPa
TIME_BOUND = 22.0


class Wall:
    """A wall and a climber on it, which a rope holds until the fan runs."""

    def __init__(self, rng, leak):
        self.rng = rng
        self.leak = (leak or 1.0) * rng.uniform(0.97, 1.03)
        self.surface = "plaster" if leak else "glass"
        self.pressure, self.low = 3.0, 0.0
        self.height = self.moved = self.fan = self.time = 0.0
        self.goal = rng.uniform(3.0, 4.0)
        self.failure = ""

    @property
    def there(self):
        """Return whether the robot is at its window."""
        return abs(self.goal - self.height) < 0.06

    @property
    def done(self):
        """Return whether the climb is over."""
        return self.there or bool(self.failure)

    def publish(self, bus):
        """Publish goal, height, chamber pressure and the surface that the inspector entered."""
        bus.publish("goal", Float32(data=self.goal))
        bus.publish("height", Float32(data=self.height + self.rng.normal(0.0, 0.01)))
        bus.publish("surface", String(data=self.surface))
        bus.publish(
            "chamber", FluidPressure(fluid_pressure=1000.0 * (self.pressure + self.rng.normal(0.0, 0.05)))
        )

    def advance(self, fan, command):
        """Climb for one step."""
        self.time += DT
        self.fan = max(0.0, min(1.0, fan.data if fan else 0.35))
        self.low += -0.3 * self.low + self.rng.normal(0.0, 0.02)
        self.pressure += 0.25 * (8.0 * self.fan / (self.leak + self.low) - self.pressure)
        speed = command.linear.x if command else 0.0
        if self.pressure < SLIPS:
            speed -= 0.15 * (SLIPS - self.pressure)
        self.moved = speed * DT
        self.height += self.moved

    def judge(self):
        """Return the reward of the step: 6 for the window, 4 for progress, minus costs of time and energy."""
        if self.pressure < FALLS:
            self.failure = "hangs in the rope"
        elif self.time > TIME_BOUND:
            self.failure = f"late at {self.height:.1f} m"
        if self.failure:
            return -5.0
        return 4.0 * self.moved / self.goal + 6.0 * self.there - 0.002 - 0.002 * self.fan


@pytest.mark.tarl(
    nodes=["climber.py"],
    sensors=[
        Sensor("surface", topic="surface", field="data", categories=("glass", "plaster")),
        Sensor("pressure", topic="chamber", field="fluid_pressure", low=1000, high=3500, bins=5, unit="Pa"),
        Sensor("height", topic="height", field="data", low=0, high=4, bins=4, unit="m"),
    ],
    drifts={"plaster": Drift.range(1.7, 2.2)},
    episodes=80,
    min_success=0.95,
)
def test_climbs(tarl, tarl_drift):
    """Climb to one window."""
    wall = Wall(tarl.rng("wall"), tarl_drift)
    config = yaml.safe_load(Path(__file__).with_name("config.yaml").read_text())
    tarl.start("climber.py", parameters=config["facade_climber"]["ros__parameters"])
    while not wall.done:
        wall.publish(tarl.bus)
        tarl.step(DT)
        wall.advance(tarl.bus.latest("fan"), tarl.bus.latest("cmd_vel"))
        tarl.reward(wall.judge())
    assert not wall.failure, wall.failure
