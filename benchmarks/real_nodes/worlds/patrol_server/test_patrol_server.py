"""TurtleBot3's patrol drives a square by the clock. On worn tyres it drives less far in a second."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Odometry = message_type("nav_msgs/msg/Odometry")

NODE = "turtlebot3_example/turtlebot3_example/turtlebot3_patrol/turtlebot3_patrol_server.py"
DT = 0.05
SIDE = 0.8
WIDE = 0.15  # tolerated distance between a corner and the place of the turn, m
TIME_BOUND = 90.0
TURNS = 4


class Yard:
    """A yard; `grip` is the distance that the robot drives as a share of that on new tyres."""

    def __init__(self, rng, grip):
        self.grip = grip * rng.uniform(0.98, 1.02)
        self.rng = rng
        self.x, self.y, self.heading = 0.0, 0.0, rng.uniform(-0.5, 0.5)
        self.side = 0.0  # driven since the last corner
        self.driving = False
        self.corners = 0
        self.time = 0.0
        self.failure = ""

    def publish(self, bus):
        """Publish odometry: a gyroscope measures the heading, but no sensor measures the distance."""
        odom = Odometry()
        heading = self.heading + self.rng.normal(0.0, 0.0005)
        odom.pose.pose.orientation.z, odom.pose.pose.orientation.w = (
            math.sin(heading / 2),
            math.cos(heading / 2),
        )
        bus.publish("/odom", odom)

    def advance(self, cmd):
        """Drive for one step."""
        speed, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        self.cornered = 0.0
        if self.driving and turn:
            self.cornered = max(0.0, 1.0 - abs(self.side - SIDE) / WIDE)
            if not self.cornered:
                self.failure = "turns away from the corner"
            self.corners += 1
            self.side = 0.0
        self.driving = turn == 0.0
        self.heading += turn * DT
        self.side += self.grip * speed * DT
        self.time += DT

    @property
    def round(self):
        """Return whether the robot has been at every corner."""
        return self.corners >= TURNS

    def judge(self):
        """Return the reward of the step: up to 2.5 for each corner."""
        if self.time > TIME_BOUND:
            self.failure = "late"
        return -3.0 if self.failure else 2.5 * math.sqrt(self.cornered) - 0.0005


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[Sensor("turned", topic="/odom", field="pose.pose.orientation.z", low=-1, high=1, bins=8)],
    drifts={"worn tyres": Drift(0.75, permanent=True)},
    episodes=40,
    min_success=0.95,
)
def test_goes_round(tarl, tarl_drift):
    """Drive a square and turn at its corners."""
    yard = Yard(tarl.rng("yard"), tarl_drift or 1.0)
    yard.publish(tarl.bus)
    tarl.start(NODE)
    tarl.start("ask.py")
    while not (yard.round or yard.failure):
        yard.publish(tarl.bus)
        tarl.step(DT)
        yard.advance(tarl.bus.latest("/cmd_vel"))
        tarl.reward(yard.judge())
    assert not yard.failure, yard.failure
