"""A robot takes the lift. Since a ward has moved, one ride in eight finds the lift busy for long."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")

DT = 0.25
FLOOR = 3
TIME_BOUND = 120.0
BUSY = 0.12  # share of the rides for which the lift is busy


class Hospital:
    """A lift and a robot in front of it; `busy` is how often the lift is busy for long."""

    def __init__(self, rng, busy):
        self.rng = rng
        self.left = rng.uniform(3.0, 5.0)  # distance to the door (m)
        long = rng.random() < busy
        self.wait = rng.uniform(32.0, 45.0) if long else rng.uniform(5.0, 14.0)
        self.ride = rng.uniform(8.0, 14.0)
        self.speed, self.gap, self.called, self.floor = 0.0, 0.0, None, 0
        self.time, self.gained, self.failure, self.state = 0.0, 0.0, "", ""

    @property
    def done(self):
        """Return whether the robot is on its floor, or has failed."""
        return bool(self.failure) or self.floor == FLOOR

    def publish(self, bus):
        """Publish what the robot sees of the lift."""
        bus.publish("lift/distance", Float32(data=self.left + self.rng.normal(0.0, 0.01)))
        bus.publish("lift/door_gap", Float32(data=self.gap + self.rng.normal(0.0, 0.01)))
        bus.publish("lift/floor", Int32(data=self.floor))
        bus.publish("battery/charge", Float32(data=0.8 - 0.001 * self.time))

    def advance(self, bus):
        """Move robot and lift for one step."""
        command, status = bus.latest("cmd_vel"), bus.latest("rider/status")
        self.state = status.data if status else ""
        self.speed += 0.6 * ((command.linear.x if command else 0.0) - self.speed)
        before = self.left
        self.left -= self.speed * DT
        self.time += DT
        if self.called is None and bus.latest("lift/call"):
            self.called = self.time
        arrived = self.called is not None and self.time > self.called + self.wait
        inside = self.left < -1.2
        self.gap += max(-0.1, min(0.2, (1.1 if arrived and not inside else 0.0) - self.gap))
        if inside and self.gap < 0.05:
            self.ride -= DT
            self.floor = FLOOR if self.ride <= 0.0 else 0
        self.gained = 0.4 * (before - self.left) - 0.004
        if self.floor == FLOOR:
            self.gained += 6.0
        self.judge(before)

    def judge(self, before):
        """Find failures."""
        if before > 0.0 >= self.left and self.gap < 0.8:
            self.failure = "robot hits the door"
        elif self.state == "GIVE_UP":
            self.failure = "robot has given up and must be fetched"
        elif self.time > TIME_BOUND:
            self.failure = "robot takes too long"
        if self.failure:
            self.gained -= 16.0


@pytest.mark.tarl(
    nodes=["lift_rider.py"],
    sensors=[
        Sensor("distance", topic="lift/distance", field="data", low=-2.0, high=5.0, bins=5, unit="m"),
        Sensor("gap", topic="lift/door_gap", field="data", low=0.0, high=1.2, bins=3, unit="m"),
    ],
    drifts={"busy lift": BUSY},
    episodes=300,
    min_success=0.97,
)
def test_rides(tarl, tarl_drift):
    """Take the lift once."""
    hospital = Hospital(tarl.rng("hospital"), tarl_drift or 0.0)
    tarl.start("lift_rider.py", parameters={"target_floor": FLOOR})
    while not hospital.done:
        hospital.publish(tarl.bus)
        tarl.step(DT)
        hospital.advance(tarl.bus)
        tarl.reward(hospital.gained)
    assert not hospital.failure, hospital.failure
