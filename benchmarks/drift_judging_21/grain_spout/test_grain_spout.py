"""A harvester unloads into a trailer beside it. Behind a hill, the trailer's position comes by a relay, and is old."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Odometry = message_type("nav_msgs/Odometry")
UInt8 = message_type("std_msgs/UInt8")

DT = 0.2
STEPS = 100
OPEN = {"late": 0, "link": 0}
HILL = {"late": 6, "link": 1}  # steps until a position arrives


class Field:
    """A harvester that drives at an even speed, and a trailer whose driver keeps beside it, more or less."""

    def __init__(self, rng, late, link):
        self.rng = rng
        self.late = late
        self.link = link
        self.speed = float(rng.uniform(1.1, 2.4))
        self.beside = float(rng.uniform(5.6, 6.4))
        self.sway, self.period, self.phase = (
            rng.uniform(0.4, 0.8),
            rng.uniform(10.0, 16.0),
            rng.uniform(0.0, 6.0),
        )
        self.log = []
        self.step, self.loaded, self.spilt = 0, 0.0, 0.0
        self.gained, self.failure = 0.0, ""

    @property
    def done(self):
        """Return whether the trailer has its share, or the field has it."""
        return bool(self.failure) or self.step == STEPS

    def trailer(self, time):
        """Return place and speed of the trailer along the row."""
        turn = 2.0 * math.pi / self.period
        swing = turn * time + self.phase
        return (
            1.2 + self.speed * time + self.sway * math.sin(swing),
            self.speed + self.sway * turn * math.cos(swing),
        )

    def publish(self, bus, now):
        """Publish the harvester, and the trailer as it was when it sent its position."""
        time = self.step * DT
        combine = Odometry()
        combine.pose.pose.position.x = self.speed * time + self.rng.normal(0.0, 0.02)
        combine.twist.twist.linear.x = self.speed
        bus.publish("combine/odom", combine)
        at, speed = self.trailer(time)
        odom = Odometry()
        odom.header.stamp.secs, odom.header.stamp.nsecs = int(now), round(now % 1.0 * 1e9)
        odom.pose.pose.position.x = at + self.rng.normal(0.0, 0.02)
        odom.pose.pose.position.y = self.beside + self.rng.normal(0.0, 0.02)
        odom.twist.twist.linear.x = speed + self.rng.normal(0.0, 0.03)
        self.log.append(odom)
        if len(self.log) > self.late:
            bus.publish("trailer/odom", self.log[-1 - self.late])
        if self.step % 10 == 0:
            bus.publish("radio/link", UInt8(data=self.link))

    def advance(self, angle, auger):
        """Drive and unload for one step; the grain falls where the spout points."""
        self.step += 1
        self.gained = -0.01
        if not (auger and auger.data):
            return
        lands = self.speed * self.step * DT + 1.2 + math.tan(angle.data) * (self.beside - 2.0)
        off = abs(lands - self.trailer(self.step * DT)[0]) + abs(self.rng.normal(0.0, 0.05))
        if off < 0.9:
            self.loaded += 1.0
            self.gained += 0.08 - 0.05 * max(0.0, off - 0.3)  # an uneven load shifts
        else:
            self.spilt += 1.0
            self.gained -= 0.3
        if self.spilt > 10:
            self.failure = "grain lies on the field"
        elif self.step == STEPS and self.loaded < 60:
            self.failure = "trailer is half empty"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["grain_spout.py"],
    sensors=[
        Sensor("link", topic="radio/link", field="data", low=0.0, high=2.0, bins=3),
        Sensor(
            "speed", topic="combine/odom", field="twist.twist.linear.x", low=0.0, high=3.0, bins=6, unit="m/s"
        ),
    ],
    drifts={"hill": HILL},
    episodes=200,
    min_success=0.97,
)
def test_unloads(tarl, tarl_drift):
    """Unload for twenty seconds."""
    field = Field(tarl.rng("field"), **(tarl_drift or OPEN))
    tarl.start("grain_spout.py")
    while not field.done:
        field.publish(tarl.bus, tarl.now)
        tarl.step(DT)
        field.advance(tarl.bus.latest("spout/angle"), tarl.bus.latest("auger/on"))
        tarl.reward(field.gained)
    assert not field.failure, field.failure
