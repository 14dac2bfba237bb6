"""A wheelchair follows its joystick. The hand of a new user trembles at 4 to 5 Hz."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Joy = message_type("sensor_msgs/msg/Joy")
Odometry = message_type("nav_msgs/msg/Odometry")
Range = message_type("sensor_msgs/msg/Range")

DT = 0.05
TREMOR = 0.5  # share of the full deflection
DOOR = 7.0  # m
TIME_BOUND = 22.0


class Corridor:
    """A user who drives around a cupboard and through a door; `tremor` is the amplitude at the stick."""

    def __init__(self, rng, tremor):
        self.rng = rng
        self.tremor = tremor
        self.x, self.y, self.yaw = 0.0, rng.uniform(-0.1, 0.1), rng.normal(0.0, 0.05)
        self.bend = rng.choice([-1.0, 1.0]) * rng.uniform(0.7, 0.9)
        self.speed, self.turn, self.shake, self.time = 0.0, 0.0, 0.0, 0.0
        self.hz, self.phase = rng.uniform(4.0, 5.0), rng.uniform(0.0, 6.28)
        self.seen = [(0.0, 0.0)] * 4  # a user reacts after a fifth of a second
        self.gained, self.failure = 0.0, ""

    @property
    def done(self):
        """Return whether the chair is at the door, or has failed."""
        return bool(self.failure) or self.x >= DOOR

    def path(self, x):
        """Return the middle of the way, which leads around a cupboard."""
        return self.bend * 0.5 * (1.0 - math.cos(2.0 * math.pi * min(max(x - 0.5, 0.0), 6.0) / 6.0))

    def user(self):
        """Return the deflection of the stick that the user wants, to the front and to the left."""
        ahead = 0.9
        bearing = math.atan2(self.path(self.x + ahead) - self.y, ahead) - self.yaw
        self.seen.append((0.75, max(-1.0, min(1.0, 1.7 * bearing))))
        return self.seen.pop(0)

    def publish(self, bus):
        """Publish the stick with its tremor, and what the chair measures."""
        forward, left = self.user()
        shaking = self.tremor * (1.0 + 0.1 * self.rng.normal())
        angle = 2.0 * math.pi * self.hz * self.time + self.phase
        joy = Joy()
        joy.axes = [
            max(-1.0, min(1.0, left + shaking * math.sin(angle) + self.rng.normal(0.0, 0.01))),
            max(-1.0, min(1.0, forward + 0.3 * shaking * math.cos(angle) + self.rng.normal(0.0, 0.01))),
        ]
        joy.buttons = [0]
        bus.publish("joy", joy)
        front = 4.0 + self.rng.normal(0.0, 0.02)
        bus.publish("front_range", Range(min_range=0.1, max_range=4.0, range=front))
        odom = Odometry()
        odom.twist.twist.linear.x = self.speed + self.rng.normal(0.0, 0.01)
        bus.publish("odom", odom)
        bus.publish("charge", Float32(data=0.7))

    def advance(self, command):
        """Drive for one step; the chair shakes with its changes of turn."""
        wish = (command.linear.x, command.angular.z) if command else (0.0, 0.0)
        before, x = self.turn, self.x
        self.speed += 0.25 * (wish[0] - self.speed)
        self.turn += 0.35 * (wish[1] - self.turn)
        self.yaw += DT * self.turn
        self.x += DT * self.speed * math.cos(self.yaw)
        self.y += DT * self.speed * math.sin(self.yaw)
        self.time += DT
        self.shake += 0.03 * (abs(self.turn - before) / DT - self.shake)
        self.gained = 1.2 * (self.x - x) - 0.01 - 0.02 * max(0.0, self.shake - 0.7)
        off = abs(self.y - self.path(self.x))
        if off > 0.40:
            self.failure = "chair hits the cupboard"
        elif self.x >= DOOR and off > 0.25:
            self.failure = "chair hits the frame of the door"
        elif self.shake > 1.7:
            self.failure = "user is shaken out of the seat"
        elif self.time > TIME_BOUND:
            self.failure = "way takes too long"
        self.gained += 3.0 if self.done and not self.failure else 0.0
        self.gained -= 5.0 if self.failure else 0.0


@pytest.mark.tarl(
    nodes=["tremor_chair.py"],
    sensors=[
        Sensor("left", topic="joy", field="axes.0", low=-1.0, high=1.0, bins=5),
        Sensor("forward", topic="joy", field="axes.1", low=-1.0, high=1.0, bins=3),
        Sensor("speed", topic="odom", field="twist.twist.linear.x", low=0.0, high=0.9, bins=3, unit="m/s"),
    ],
    drifts={"tremor": TREMOR},
    episodes=200,
    min_success=0.97,
)
def test_drives(tarl, tarl_drift):
    """Drive around a cupboard and through a door."""
    corridor = Corridor(tarl.rng("corridor"), tarl_drift or 0.0)
    tarl.start("tremor_chair.py")
    while not corridor.done:
        corridor.publish(tarl.bus)
        tarl.step(DT)
        corridor.advance(tarl.bus.latest("cmd_vel"))
        tarl.reward(corridor.gained)
    assert not corridor.failure, corridor.failure
