"""A robot serves a table. Since winter it serves soup, which spills when the robot starts or stops abruptly."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

LaserScan = message_type("sensor_msgs/msg/LaserScan")
Odometry = message_type("nav_msgs/msg/Odometry")

DT = 0.1
PARTS = 4  # number of steps of the soup per step of the world
TABLE = 9.0
TIME_BOUND = 24.0
RIM = 0.11  # slope of the soup's surface at which a full bowl spills


class Restaurant:
    """An aisle with a guest in it; `full` says whether there is soup on the tray."""

    def __init__(self, rng, full):
        self.rng = rng
        self.full = full
        self.x, self.y, self.yaw = 0.0, rng.uniform(-0.15, 0.15), rng.uniform(-0.1, 0.1)
        self.v, self.turn = 0.0, 0.0
        self.guest = rng.uniform(3.5, 6.0)
        self.crossing = rng.uniform(1.6, 2.2)  # where the guest steps into the aisle (m)
        self.stay, self.stands = rng.uniform(1.5, 2.5), False
        self.wave = 2 * math.pi * rng.uniform(1.5, 1.8)
        self.slope, self.sway = 0.0, 0.0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the robot stands at the table, or has failed."""
        return bool(self.failure) or (self.x > TABLE - 0.1 and self.v < 0.05)

    def publish(self, bus):
        """Publish the pose and a scan of nine beams."""
        at = Odometry()
        at.pose.pose.position.x, at.pose.pose.position.y = float(self.x), float(self.y)
        at.pose.pose.orientation.z, at.pose.pose.orientation.w = (
            math.sin(self.yaw / 2),
            math.cos(self.yaw / 2),
        )
        bus.publish("odom", at)
        scan = LaserScan(angle_min=-0.8, angle_increment=0.2, range_min=0.1, range_max=8.0)
        ahead = self.guest - self.x if self.stands else 9.0
        scan.ranges = [ahead + self.rng.normal(0.0, 0.02) if abs(k - 4) < 2 else 9.0 for k in range(9)]
        bus.publish("scan", scan)

    def advance(self, command):
        """Drive for one step; the surface of the soup swings."""
        wanted = command.linear.x if command else 0.0
        for _ in range(PARTS):
            pull = max(-3.0, min(3.0, (wanted - self.v) / 0.08))
            self.v += pull * DT / PARTS
            force = self.wave**2 * (-pull / 9.81 - self.slope) - 0.35 * self.wave * self.sway
            self.sway += force * DT / PARTS
            self.slope += self.sway * DT / PARTS
            if self.full and abs(self.slope) > RIM:
                self.failure = "soup spilt"
        self.turn += 0.6 * ((command.angular.z if command else 0.0) - self.turn)
        self.yaw += self.turn * DT
        before = self.x
        self.x += self.v * math.cos(self.yaw) * DT
        self.y += self.v * math.sin(self.yaw) * DT
        self.time += DT
        self.gained = 1.2 * (self.x - before) - 0.002
        self.people()

    def people(self):
        """Let the guest step into the aisle and out of it; find failures."""
        if not self.stands and self.stay > 0.0 and 0.0 < self.guest - self.x < self.crossing:
            self.stands = True
        if self.stands:
            self.stay -= DT
            self.stands = self.stay > 0.0
            if self.guest - self.x < 0.35:
                self.failure = "robot hits a guest"
        if self.time > TIME_BOUND:
            self.failure = "soup is cold"
        if self.failure:
            self.gained -= 8.0


@pytest.mark.tarl(
    nodes=["soup_waiter.py"],
    sensors=[
        Sensor("x", topic="odom", field="pose.pose.position.x", low=0.0, high=9.0, bins=6, unit="m"),
        Sensor("aside", topic="odom", field="pose.pose.position.y", low=-0.2, high=0.2, bins=2, unit="m"),
    ],
    drifts={"soup": True},
    episodes=200,
    min_success=0.97,
)
def test_serves(tarl, tarl_drift):
    """Serve one table."""
    aisle = Restaurant(tarl.rng("restaurant"), bool(tarl_drift))
    tarl.start("soup_waiter.py")
    while not aisle.done:
        aisle.publish(tarl.bus)
        tarl.step(DT)
        aisle.advance(tarl.bus.latest("cmd_vel"))
        tarl.reward(aisle.gained)
    assert not aisle.failure, aisle.failure
