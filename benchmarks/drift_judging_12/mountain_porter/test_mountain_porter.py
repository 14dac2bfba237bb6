"""A porter carries supplies to a hut. In snow it needs more energy; only the delivery earns a reward."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

BatteryState = message_type("sensor_msgs/msg/BatteryState")
Float32 = message_type("std_msgs/msg/Float32")
Odometry = message_type("nav_msgs/msg/Odometry")
Range = message_type("sensor_msgs/msg/Range")

DT = 2.0
HUT = (520.0, 240.0)
NEAR = 5.0
NIGHT = 1300.0  # s
FORCE = 260.0 * 9.81  # N
CHARGE = 1.06e6  # J


class Mountain:
    """A path up to a hut under `snow` metres of snow, which drags more the faster the porter ploughs it."""

    def __init__(self, rng, snow):
        self.rng = rng
        self.snow = snow * rng.uniform(0.9, 1.1)
        self.x, self.y, self.yaw = 0.0, rng.normal(0.0, 0.5), rng.normal(0.0, 0.2)
        self.left = CHARGE * rng.uniform(0.98, 1.02)
        self.roll = rng.uniform(0.075, 0.085)
        self.time = 0.0
        self.delivered = False
        self.failure = ""

    @property
    def done(self):
        """Return whether the supplies are at the hut, or will not be."""
        return self.delivered or bool(self.failure)

    @property
    def slope(self):
        """Return the slope of the path here."""
        return 0.12 + 0.08 * math.sin(self.x / 60.0)

    def publish(self, bus):
        """Publish pose, slope, charge and the distance below the belly."""
        odom = Odometry()
        odom.pose.pose.position.x = self.x + self.rng.normal(0.0, 0.3)
        odom.pose.pose.position.y = self.y + self.rng.normal(0.0, 0.3)
        odom.pose.pose.orientation.z = math.sin(self.yaw / 2)
        odom.pose.pose.orientation.w = math.cos(self.yaw / 2)
        bus.publish("odom", odom)
        bus.publish("imu/slope", Float32(data=self.slope + self.rng.normal(0.0, 0.02)))
        bus.publish("battery", BatteryState(percentage=max(0.0, self.left / CHARGE)))
        bus.publish("belly/range", Range(range=max(0.0, 0.35 - self.snow + self.rng.normal(0.0, 0.01))))

    def advance(self, cmd):
        """Drive for one step."""
        v, w = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        v = max(0.0, v * self.rng.uniform(0.97, 1.03)) if self.left > 0.0 else 0.0
        self.yaw += w * DT + self.rng.normal(0.0, 0.02)
        self.x += v * math.cos(self.yaw) * DT
        self.y += v * math.sin(self.yaw) * DT
        drag = FORCE * (self.roll + self.slope) + 2600.0 * self.snow * v * v
        self.left -= (drag * v / 0.7 + 60.0) * DT
        self.time += DT
        self.delivered = math.dist((self.x, self.y), HUT) < NEAR
        if not self.delivered and self.left < 0.02 * CHARGE:
            self.failure = "the battery is empty"
        elif not self.delivered and self.time > NIGHT:
            self.failure = "night falls"

    def judge(self):
        """Return the reward of the step: only the delivery counts."""
        return 10.0 if self.delivered else 0.0


@pytest.mark.tarl(
    nodes=["mountain_porter.py"],
    sensors=[
        Sensor("belly", topic="belly/range", field="range", low=0.0, high=0.4, bins=4, unit="m"),
        Sensor("x", topic="odom", field="pose.pose.position.x", low=0.0, high=520.0, bins=8, unit="m"),
    ],
    drifts={"snow": 0.2},
    episodes=200,
    min_success=0.97,
)
def test_delivers(tarl, tarl_drift):
    """Carry one load."""
    mountain = Mountain(tarl.rng("mountain"), tarl_drift or 0.0)
    tarl.start("mountain_porter.py")
    while not mountain.done:
        mountain.publish(tarl.bus)
        tarl.step(DT)
        mountain.advance(tarl.bus.latest("cmd_vel"))
        tarl.reward(mountain.judge())
    assert not mountain.failure, mountain.failure
