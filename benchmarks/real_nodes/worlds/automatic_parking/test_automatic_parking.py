"""TurtleBot3 finds a parking spot by its reflective tape and backs into it. The tape fades; a basket is added."""

import math

import numpy as np
import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

LaserScan = message_type("sensor_msgs/LaserScan")
Odometry = message_type("nav_msgs/Odometry")

NODE = "turtlebot3_automatic_parking/nodes/automatic_parking"
DT = 0.2  # the scanner's period, s
TIME_BOUND = 90.0
STILL = 8.0  # a robot that stands for so long has finished, s
REAR = 0.1  # from the scanner to the rear, m
ROOM = 2.5  # distance of the other walls, m
WIDE = 0.15  # tolerated distance between the robot and the middle of the spot, m
RAYS = np.radians(np.arange(360.0))


class Garage:
    """A wall with a tape at the left; `tape` is the tape's brightness, `basket` its length behind the robot in m."""

    def __init__(self, rng, tape=1.0, basket=0.0):
        self.rng = rng
        self.bright = 6000.0 * tape
        self.rear = REAR + basket
        self.wall = rng.uniform(0.75, 0.95)  # distance of the wall from the start, m
        self.spot = rng.uniform(-0.25, 0.25)  # middle of the tape along the wall, m
        self.slant = rng.uniform(-0.3, 0.3)  # direction of the wall, rad
        self.x, self.y, self.heading = 0.0, 0.0, -self.slant  # along the wall and away from it
        self.origin = (0.0, 0.0, self.heading)
        self.time, self.still, self.speed, self.turn = 0.0, 0.0, 0.0, 0.0
        self.failure = ""

    def publish(self, bus):
        """Publish the scan with intensities, and the odometry since the last reset."""
        angles = RAYS + self.heading
        cos, sin = np.cos(angles), np.sin(angles)
        with np.errstate(divide="ignore"):
            back = np.where(sin > 1e-6, (self.wall - self.y) / sin, 99.0)
            sides = np.where(cos > 0, ROOM - self.x, ROOM + self.x) / np.maximum(np.abs(cos), 1e-9)
            front = np.where(sin < -1e-6, (ROOM + self.y) / -sin, 99.0)
        ranges = np.minimum(np.minimum(back, sides), front)
        taped = (ranges == back) & (np.abs(self.x + ranges * cos - self.spot) < 0.2)
        ranges = ranges + self.rng.normal(0.0, 0.003, 360)
        bright = np.where(taped, self.bright, 300.0) * self.rng.uniform(0.97, 1.03, 360)
        bus.publish("/scan", LaserScan(ranges=ranges.tolist(), intensities=bright.tolist()))
        odom = Odometry()
        x, y, heading = self.origin
        along, across = self.x - x, self.y - y
        odom.pose.pose.position.x = along * math.cos(heading) + across * math.sin(heading)
        odom.pose.pose.position.y = -along * math.sin(heading) + across * math.cos(heading)
        odom.pose.pose.orientation.z = math.sin((self.heading - heading) / 2)
        odom.pose.pose.orientation.w = math.cos((self.heading - heading) / 2)
        bus.publish("/odom", odom)

    def reset(self, _):
        """Count odometry from here."""
        self.origin = (self.x, self.y, self.heading)

    def advance(self, cmd):
        """Drive for one step."""
        speed, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        self.heading += turn * DT
        self.x += speed * math.cos(self.heading) * DT
        self.y += speed * math.sin(self.heading) * DT
        self.still = 0.0 if speed or turn else self.still + DT
        self.time += DT

    @property
    def gap(self):
        """Return the free space behind the robot, m."""
        return self.wall - self.y - self.rear

    def judge(self):
        """Return the reward of the step: up to 10 for a robot that is parked."""
        if self.gap < 0.0:
            self.failure = "touched the wall"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        elif self.still > STILL:
            off = abs(self.x - self.spot)
            if self.gap > 0.25 or off > WIDE or self.time < STILL + 1.0:
                self.failure = "not parked"
            else:
                return 10.0 - 20.0 * off
        return -5.0 if self.failure else -0.002

    @property
    def over(self):
        """Return whether the mission has ended."""
        return bool(self.failure) or self.still > STILL


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[
        Sensor("behind", topic="/scan", field="ranges[180]", low=0, high=2, bins=8, unit="m"),
        Sensor("driven", topic="/odom", field="pose.pose.position.x", low=-0.5, high=0.5, bins=5, unit="m"),
    ],
    drifts={"faded tape": {"tape": 0.5}, "basket": Drift({"basket": 0.15}, permanent=True)},
    episodes=40,
    min_success=0.95,
)
def test_parks(tarl, tarl_drift):
    """Park."""
    garage = Garage(tarl.rng("garage"), **(tarl_drift or {}))
    tarl.bus.subscribe("/reset", garage.reset)
    tarl.start(NODE)
    while not garage.over:
        garage.publish(tarl.bus)
        tarl.step(DT)
        garage.advance(tarl.bus.latest("/cmd_vel"))
        tarl.reward(garage.judge())
    assert not garage.failure, garage.failure
