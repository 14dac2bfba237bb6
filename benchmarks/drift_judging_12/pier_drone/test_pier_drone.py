"""A drone looks at the pier of a bridge. In one flight of ten, a gust between the piers pushes it."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Imu = message_type("sensor_msgs/msg/Imu")
Range = message_type("sensor_msgs/msg/Range")

DT = 0.2
TOP = 14.0
PICTURES = 16
ROTORS = 0.45  # distance from the middle of the drone (m)
SHARP_FROM, SHARP_TO = 1.0, 3.6  # m
TIME_BOUND = 70.0


class Pier:
    """A drone in front of a pier, in a breeze; `share` of the flights meet a gust."""

    def __init__(self, rng, share):
        self.rng = rng
        self.distance = rng.uniform(3.4, 4.0)
        self.forward, self.up = 0.0, 0.0
        self.height = 0.0
        self.breeze = 0.0
        strong = rng.random() < share
        self.gust = rng.uniform(1.7, 2.2) if strong else 0.0  # m/s
        self.from_height = rng.uniform(4.0, 11.0)
        self.blows = 0.0
        self.time, self.taken, self.gained = 0.0, 0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the drone is at the top, or has crashed."""
        return bool(self.failure) or self.height > TOP - 0.2

    def publish(self, bus):
        """Publish the distance, the height and the attitude."""
        bus.publish("front/range", Range(range=self.distance + self.rng.normal(0.0, 0.02)))
        bus.publish("altimeter", Float32(data=self.height + self.rng.normal(0.0, 0.05)))
        imu = Imu()
        imu.orientation.y = 0.5 * (-0.08 * self.breeze + self.rng.normal(0.0, 0.01))
        imu.orientation.w = 1.0
        bus.publish("imu", imu)

    def advance(self, cmd, shot):
        """Fly for one step; `shot` is whether a picture is taken."""
        ahead, up = (cmd.twist.linear.x, cmd.twist.linear.z) if cmd else (0.0, 0.0)
        self.forward += (ahead - self.forward) * DT / 0.5
        self.up += (up - self.up) * DT / 0.4
        self.breeze += 0.1 * (self.rng.normal(0.0, 0.35) - self.breeze)
        if self.gust and self.height > self.from_height and self.blows < 1.4:
            self.blows += DT
            push = self.gust
        else:
            push = 0.0
        self.distance -= (self.forward + self.breeze + push) * DT
        self.height += self.up * DT
        self.time += DT
        self.gained = 0.0
        if shot and self.taken < PICTURES:
            self.taken += 1
            self.gained = 10.0 / PICTURES * self._sharpness()

    def _sharpness(self):
        if self.distance < SHARP_FROM:
            return 0.5
        return max(0.0, 1.0 - 0.5 * max(0.0, self.distance - SHARP_TO))

    def judge(self):
        """Return the reward of the step: sharp pictures."""
        if self.distance < ROTORS:
            self.failure = "rotors touch the pier"
        elif self.time > TIME_BOUND:
            self.failure = "battery"
        return self.gained - 0.002 - (6.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["pier_drone.py"],
    sensors=[
        Sensor("distance", topic="front/range", field="range", low=0.4, high=4.4, bins=8, unit="m"),
        Sensor("height", topic="altimeter", field="data", low=0.0, high=15.0, bins=3, unit="m"),
    ],
    drifts={"gusts": 0.1},
    episodes=300,
    min_success=0.97,
)
def test_inspects(tarl, tarl_drift):
    """Fly up one pier."""
    pier = Pier(tarl.rng("pier"), tarl_drift or 0.0)
    tarl.start("pier_drone.py")
    last = None
    while not pier.done:
        pier.publish(tarl.bus)
        tarl.step(DT)
        shot = tarl.bus.latest("camera/shutter")
        pier.advance(tarl.bus.latest("cmd_vel"), shot is not last)
        last = shot
        tarl.reward(pier.judge())
    assert not pier.failure, pier.failure
