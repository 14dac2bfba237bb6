"""JSK's odometry offset corrects the velocity that a biped's odometry reports. New soles change by how much it errs."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Odometry = message_type("nav_msgs/Odometry")

PACKAGE = "jsk_robot_common/jsk_robot_startup"
LAUNCH = f"{PACKAGE}/launch/particle_odometry.launch"
FILES = [
    f"{PACKAGE}/scripts/odometry_offset.py",
    f"{PACKAGE}/src/jsk_robot_startup/OdometryOffset.py",
    f"{PACKAGE}/src/jsk_robot_startup/odometry_utils.py",
]
DT = 0.1
LENGTH = 3.0  # of the walk, m
SPEED = 0.3
TIME_BOUND = 20.0


class Walk:
    """A straight walk; the soles slip `forward` and `left` m/s more than the odometry reports."""

    def __init__(self, rng, forward=0.01, left=0.0):
        self.rng = rng
        self.slip = (forward, left)
        self.x, self.y = 0.0, rng.uniform(-0.05, 0.05)
        self.believed_x, self.believed_y = 0.0, self.y
        self.ahead, self.aside = 0.0, 0.0
        self.time = 0.0
        self.arrived = False
        self.failure = ""

    def publish(self, bus):
        """Publish the odometry of the legs."""
        odom = Odometry()
        odom.pose.pose.position.x, odom.pose.pose.position.y = self.x, self.y
        odom.pose.pose.orientation.w = 1.0
        odom.twist.twist.linear.x = self.ahead + self.rng.normal(0.0, 0.005)
        odom.twist.twist.linear.y = self.aside + self.rng.normal(0.0, 0.005)
        bus.publish("/odom", odom)

    def advance(self, corrected):
        """Walk for one step, to where the robot believes that the goal is."""
        if corrected:
            twist = corrected.twist.twist.linear
            self.believed_x += twist.x * DT
            self.believed_y += twist.y * DT
        self.arrived = self.believed_x >= LENGTH
        self.ahead = SPEED
        self.aside = max(-0.1, min(0.1, -0.8 * self.believed_y))
        before = self.x
        self.x += (self.ahead + self.slip[0]) * DT
        self.y += (self.aside + self.slip[1]) * DT
        self.gained = self.x - before
        self.time += DT

    @property
    def over(self):
        """Return whether the mission has ended."""
        return bool(self.failure) or self.arrived

    def judge(self):
        """Return the reward of the step: for walking in the middle, and for the place at the end."""
        reward = 2.0 * self.gained * max(0.0, 1.0 - abs(self.y))
        if self.time > TIME_BOUND:
            self.failure = "late"
        elif self.arrived and math.hypot(self.x - LENGTH, self.y) > 0.3:
            self.failure = "not at the goal"
        elif self.arrived:
            reward += 5.0
        return reward - (5.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=FILES,
    sensors=[
        Sensor("ahead", topic="/odom", field="twist.twist.linear.x", low=0.0, high=0.4, bins=4, unit="m/s"),
        Sensor("aside", topic="/odom", field="twist.twist.linear.y", low=-0.1, high=0.1, bins=4, unit="m/s"),
    ],
    drifts={
        "soles": Drift({"forward": 0.06}, permanent=True),
        "crooked": Drift({"left": 0.04}, permanent=True),
    },
    episodes=30,
    min_success=0.95,
)
def test_walks_to_the_goal(tarl, tarl_drift):
    """Walk."""
    walk = Walk(tarl.rng("walk"), **(tarl_drift or {}))
    tarl.launch(LAUNCH, only=["biped_odometry_offset"])
    while not walk.over:
        walk.publish(tarl.bus)
        tarl.step(DT)
        walk.advance(tarl.bus.latest("/biped_odom_offset"))
        tarl.reward(walk.judge())
    assert not walk.failure, walk.failure
