"""The robot climbs to a mark and holds. On an iced pole, the full force of the clamp cannot carry the robot."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

BatteryState = message_type("sensor_msgs/msg/BatteryState")
Float64 = message_type("std_msgs/msg/Float64")
Imu = message_type("sensor_msgs/msg/Imu")
Range = message_type("sensor_msgs/msg/Range")

DT = 0.1
WEIGHT = 85.0  # N
SPRING = 320.0  # largest force of the clamp (N)
HELD = 10  # number of steps at the mark
TIME_BOUND = 22.0


class Pole:
    """A pole with some friction; wood is smoother towards the top."""

    def __init__(self, rng, friction):
        self.rng = rng
        self.air = rng.uniform(-6.0, -2.0) if friction < 0.2 else rng.uniform(3.0, 25.0)
        self.friction = friction * rng.uniform(0.9, 1.1)
        self.mark = rng.uniform(3.0, 4.5)
        self.lean = rng.uniform(0.0, 0.1)
        self.height, self.turned, self.speed, self.gained, self.held = 0.15, 0.0, 0.0, 0.0, 0
        self.charge = rng.uniform(0.5, 1.0)
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the inspection can begin or can no longer begin."""
        return self.held >= HELD or bool(self.failure)

    def publish(self, bus):
        """Publish job, thermometer, height, rollers, attitude and battery."""
        seen = self.height + self.rng.normal(0.0, 0.003)
        imu = Imu()
        imu.orientation.x, imu.orientation.w = math.sin(self.lean / 2.0), math.cos(self.lean / 2.0)
        bus.publish("inspection/mark", Float64(data=self.mark))
        bus.publish("air", Float64(data=self.air + self.rng.normal(0.0, 0.2)))
        bus.publish("ground", Range(min_range=0.05, max_range=8.0, range=seen))
        bus.publish("rollers/turned", Float64(data=self.turned))
        bus.publish("imu", imu)
        bus.publish("battery", BatteryState(percentage=self.charge))

    def advance(self, rollers, clamp):
        """Climb, or slide down, for one step."""
        wanted = max(-0.5, min(0.5, rollers.twist.linear.z)) if rollers else 0.0
        force = max(0.0, min(SPRING, clamp.data)) if clamp else 0.0
        grip = 2.0 * self.friction * (1.0 - 0.03 * self.height) * force / WEIGHT
        slide = 0.0 if grip > 1.1 else 3.0 * (1.1 - grip)
        self.turned += wanted * DT
        self.speed += (wanted - slide - self.speed) * 0.6
        before = self.height
        self.height = max(0.15, self.height + self.speed * DT)
        self.gained = self.height - before
        self.charge -= (0.0005 + 0.001 * abs(wanted)) * DT * force / 100.0
        self.held = self.held + 1 if abs(self.height - self.mark) < 0.1 else 0
        self.time += DT

    def judge(self):
        """Return the reward of the step: height gained, minus height lost by sliding."""
        if self.time > TIME_BOUND:
            self.failure = "not at the mark"
            return -3.0
        return 7.0 * self.gained / self.mark + (3.0 if self.held >= HELD else -0.005)


@pytest.mark.tarl(
    nodes=["climber.py"],
    sensors=[
        Sensor("air", topic="air", field="data", edges=(0.0,), unit="°C"),
        Sensor("height", topic="ground", field="range", low=0, high=4.5, bins=6, unit="m"),
    ],
    drifts={"ice": 0.09},
    episodes=100,
    min_success=0.95,
)
def test_climbs_to_the_mark(tarl, tarl_drift):
    """Climb one pole."""
    pole = Pole(tarl.rng("pole"), tarl_drift or 0.42)
    tarl.start("climber.py")
    while not pole.done:
        pole.publish(tarl.bus)
        tarl.step(DT)
        pole.advance(tarl.bus.latest("rollers/speed"), tarl.bus.latest("clamp/force"))
        tarl.reward(pole.judge())
    assert not pole.failure, pole.failure
