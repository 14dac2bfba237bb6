"""A caddy follows the path to the next tee.

With a heavy bag the caddy answers late to its steering, and starts to weave.
"""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Odometry = message_type("nav_msgs/msg/Odometry")
Path = message_type("nav_msgs/msg/Path")
PoseStamped = message_type("geometry_msgs/msg/PoseStamped")
Range = message_type("sensor_msgs/msg/Range")

DT = 0.1
WIDE = 0.9  # half of the width of the path (m)
TIME_BOUND = 34.0


class Course:
    """A path with gentle bends, and a caddy on it."""

    def __init__(self, rng, late):
        self.rng = rng
        self.late = late * rng.uniform(0.95, 1.05)
        self.bend = rng.uniform(0.5, 0.9), rng.uniform(0.0, 6.0)
        self.length = 32.0
        self.x, self.y, self.heading = 0.0, self.middle(0.0) + rng.uniform(-0.25, 0.25), 0.0
        self.turn, self.speed = 0.0, 0.0
        self.person = rng.uniform(6.0, 14.0)  # time at which somebody crosses (s)
        self.time, self.moved = 0.0, 0.0
        self.failure = ""

    def middle(self, x):
        """Return the middle of the path."""
        return self.bend[0] * math.sin(0.25 * x + self.bend[1])

    @property
    def done(self):
        """Return whether the next tee is reached, or the episode has failed."""
        return self.x >= self.length - 1.0 or bool(self.failure)

    def publish(self, bus):
        """Publish the plan once, odometry and sonar."""
        if self.time == 0.0:
            plan = Path()
            for step in range(int(self.length * 5) + 1):
                pose = PoseStamped()
                pose.pose.position.x, pose.pose.position.y = step / 5.0, self.middle(step / 5.0)
                plan.poses.append(pose)
            bus.publish("plan", plan, latch=True)
        odom = Odometry()
        odom.pose.pose.position.x = self.x + self.rng.normal(0.0, 0.02)
        odom.pose.pose.position.y = self.y + self.rng.normal(0.0, 0.02)
        heading = self.heading + self.rng.normal(0.0, 0.01)
        odom.pose.pose.orientation.z = math.sin(heading / 2.0)
        odom.pose.pose.orientation.w = math.cos(heading / 2.0)
        odom.twist.twist.angular.z = self.turn
        bus.publish("odom", odom)
        crossing = 0.0 <= self.time - self.person < 1.5
        sonar = 3.0 if crossing else 5.0
        bus.publish("sonar", Range(range=sonar + self.rng.normal(0.0, 0.02), min_range=0.2, max_range=5.0))

    def advance(self, cmd):
        """Move the caddy for one step."""
        self.time += DT
        speed, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        self.speed += 0.4 * (speed - self.speed)
        self.turn += (1.0 - math.exp(-DT / self.late)) * (turn - self.turn) + self.rng.normal(0.0, 0.01)
        self.heading += self.turn * DT
        before = self.x
        self.x += self.speed * math.cos(self.heading) * DT
        self.y += self.speed * math.sin(self.heading) * DT
        self.moved = self.x - before

    def judge(self):
        """Return the reward of the step: metres are rewarded, more near the middle of the path."""
        aside = (self.y - self.middle(self.x)) / WIDE
        if abs(aside) > 1.0:
            self.failure = "the caddy is in the bunker"
        elif self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        reward = 10.0 * self.moved / self.length * (1.0 - 0.5 * aside**2) - 0.0005
        return reward - 4.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["golf_caddy.py", "steering.py"],
    sensors=[
        Sensor("turn", topic="odom", field="twist.twist.angular.z", low=-1.0, high=1.0, bins=4, unit="rad/s"),
        Sensor("x", topic="odom", field="pose.pose.position.x", low=0.0, high=32.0, bins=4, unit="m"),
    ],
    drifts={"heavy bag": Drift(1.8)},
    episodes=100,
    min_success=0.95,
)
def test_follows_the_path(tarl, tarl_drift):
    """Bring one bag to the next tee."""
    course = Course(tarl.rng("course"), tarl_drift or 0.2)
    tarl.start("golf_caddy.py")
    while not course.done:
        course.publish(tarl.bus)
        tarl.step(DT)
        course.advance(tarl.bus.latest("cmd_vel"))
        tarl.reward(course.judge())
    assert not course.failure, course.failure
