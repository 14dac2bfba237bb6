"""Fins damp the roll of a ferry. On one engine the ferry sails slowly, the fins lift less, and it rolls."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Odometry = message_type("nav_msgs/msg/Odometry")
Vector3Stamped = message_type("geometry_msgs/msg/Vector3Stamped")

DT = 0.2
STEPS = 200
FAST = 7.0  # m/s
SETTLED = 8.0  # s
WORST = 0.135  # rad


class Sea:
    """A ferry in beam waves near the period of its roll."""

    def __init__(self, rng, speed):
        self.rng = rng
        self.speed = speed * rng.normal(1.0, 0.01)
        self.waves = [
            (rng.uniform(0.060, 0.066), rng.uniform(0.92, 0.96), rng.uniform(0.0, 6.28)),
            (rng.uniform(0.028, 0.032), rng.uniform(1.02, 1.08), rng.uniform(0.0, 6.28)),
        ]
        self.roll, self.rate, self.fin = rng.normal(0.0, 0.01), 0.0, 0.0
        self.time, self.step = 0.0, 0
        self.failure = ""

    @property
    def done(self):
        """Return whether the crossing has ended."""
        return bool(self.failure) or self.step >= STEPS

    def publish(self, bus):
        """Publish roll, roll rate and speed."""
        msg = Vector3Stamped()
        msg.vector.x = self.roll + self.rng.normal(0.0, 0.002)
        msg.vector.y = self.rate + self.rng.normal(0.0, 0.004)
        bus.publish("imu/roll", msg)
        odom = Odometry()
        odom.twist.twist.linear.x = self.speed + self.rng.normal(0.0, 0.08)
        bus.publish("gps/odom", odom)

    def advance(self, cmd):
        """Roll for one step."""
        wanted = max(-0.5, min(0.5, cmd.data if cmd else 0.0))
        lift = 0.9 * (self.speed / FAST) ** 2
        for _ in range(4):
            h = DT / 4
            self.fin += (wanted - self.fin) / 0.6 * h
            moment = sum(a * math.sin(w * self.time + p) for a, w, p in self.waves) + self.rng.normal(
                0.0, 0.01
            )
            self.rate += (moment + lift * self.fin - 0.12 * self.rate - 0.95 * self.roll) * h
            self.roll += self.rate * h
            self.time += h
        self.step += 1

    def judge(self):
        """Return the reward of the step, less for more roll."""
        if self.time > SETTLED and abs(self.roll) > WORST:
            self.failure = "cars shift"
        return 10.0 / STEPS - 0.15 * abs(self.roll) - (5.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["fin_stabiliser.py"],
    sensors=[
        Sensor(
            "speed", topic="gps/odom", field="twist.twist.linear.x", low=2.0, high=8.0, bins=6, unit="m/s"
        ),
        Sensor("roll", topic="imu/roll", field="vector.x", low=-0.2, high=0.2, bins=4, unit="rad"),
    ],
    drifts={"one engine": Drift.range(4.2, 4.8)},
    episodes=200,
    min_success=0.97,
)
def test_crosses(tarl, tarl_drift):
    """Cross once."""
    sea = Sea(tarl.rng("sea"), tarl_drift or FAST)
    tarl.start("fin_stabiliser.py")
    while not sea.done:
        sea.publish(tarl.bus)
        tarl.step(DT)
        sea.advance(tarl.bus.latest("fins/angle"))
        tarl.reward(sea.judge())
    assert not sea.failure, sea.failure
