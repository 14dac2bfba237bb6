"""A robot drives onto its dock. Its contacts are worn and burnt, so less of the charger's voltage arrives."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

PointStamped = message_type("geometry_msgs/PointStamped")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
CHARGER = 29.4  # V
DIODE = 21.0  # voltage that leaks from the pack to the open contacts (V)
WORN = 5.0  # voltage lost at the contacts (V)


class Room:
    """A dock at the origin and a robot in front of it; `lost` is the voltage lost at the contacts."""

    def __init__(self, rng, lost):
        self.rng = rng
        self.lost = lost * rng.uniform(0.94, 1.06)
        self.x = -rng.uniform(0.8, 1.3)
        self.y = rng.uniform(-0.25, 0.25)
        self.heading = math.atan2(-self.y, -self.x) + rng.uniform(-0.5, 0.5)
        self.pack = rng.uniform(23.5, 25.0)
        self.time, self.charged, self.gained, self.failure = 0.0, 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the robot has charged for 3 s, or something went wrong."""
        return bool(self.failure) or self.charged >= 3.0

    @property
    def touching(self):
        """Return whether the contacts touch."""
        return self.x > -0.025

    def publish(self, bus):
        """Publish the beacon and the voltages."""
        seen = PointStamped()
        along, across = -self.x + 0.03, -self.y
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        seen.point.x = cos * along + sin * across + self.rng.normal(0.0, 0.003)
        seen.point.y = cos * across - sin * along + self.rng.normal(0.0, 0.002)
        bus.publish("dock/beacon", seen)
        volts = CHARGER - self.lost if self.touching else DIODE
        bus.publish("contacts/volts", Float32(data=volts + self.rng.normal(0.0, 0.12)))
        bus.publish("battery/volts", Float32(data=self.pack + self.rng.normal(0.0, 0.05)))

    def advance(self, cmd, status):
        """Drive for one step; the dock stops the wheels."""
        speed, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        before = math.hypot(self.x, self.y)
        self.heading += DT * turn
        self.x = min(-0.01, self.x + DT * speed * math.cos(self.heading))
        self.y += DT * speed * math.sin(self.heading)
        self.time += DT
        self.gained = 0.5 * (before - math.hypot(self.x, self.y)) - 0.005
        if status == "charge":
            self.charged += DT
            self.gained += 0.1
            if not self.touching:
                self.failure = "robot believes that it charges"
        if status == "failed":
            self.failure = "robot has given up"
        elif self.time > 60.0:
            self.failure = "robot takes too long"
        if self.failure:
            self.gained -= 6.0


@pytest.mark.tarl(
    nodes=["docker.py", "battery_watch.py"],
    sensors=[
        Sensor("contacts", topic="contacts/volts", field="data", low=20.0, high=30.0, bins=5, unit="V"),
        Sensor("ahead", topic="dock/beacon", field="point.x", low=0.0, high=1.4, bins=4, unit="m"),
    ],
    drifts={"worn contacts": WORN},
    episodes=200,
    min_success=0.97,
)
def test_docks(tarl, tarl_drift):
    """Dock once and charge."""
    room = Room(tarl.rng("room"), tarl_drift or 0.4)
    tarl.start("battery_watch.py")
    tarl.start("docker.py")
    while not room.done:
        room.publish(tarl.bus)
        tarl.step(DT)
        told = tarl.bus.latest("docker/status")
        room.advance(tarl.bus.latest("cmd_vel"), told.data if told else "")
        tarl.reward(room.gained)
    assert not room.failure, room.failure
