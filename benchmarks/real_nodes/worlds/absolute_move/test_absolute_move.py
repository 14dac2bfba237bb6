"""TurtleBot3's absolute move reaches a pose that is typed in. On carpet the base does not turn at slow commands."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Odometry = message_type("nav_msgs/msg/Odometry")
String = message_type("std_msgs/msg/String")

NODE = "turtlebot3_example/turtlebot3_example/turtlebot3_absolute_move/turtlebot3_absolute_move.py"
DT = 0.05
TIME_BOUND = 25.0


class Floor:
    """A floor; below `stick` rad/s the wheels do not turn the base."""

    def __init__(self, rng, stick):
        self.rng = rng
        self.stick = stick
        self.goal = (rng.uniform(0.3, 0.6), rng.uniform(-0.3, 0.3), rng.uniform(-80.0, 80.0))
        self.x, self.y, self.heading, self.turn = 0.0, 0.0, rng.uniform(-0.3, 0.3), 0.0
        self.typed = iter((*self.goal, *(0.0, 0.0, 0.0)))
        self.asked = 0
        self.time = 0.0
        self.failure = ""

    def type(self, _prompt=""):
        """Type the next number; the node prompts again after its arrival."""
        self.asked += 1
        return str(next(self.typed))

    @property
    def there(self):
        """Return whether the node says that it has arrived."""
        return self.asked > 3

    def publish(self, bus):
        """Publish odometry and floor."""
        odom = Odometry()
        odom.pose.pose.position.x, odom.pose.pose.position.y = self.x, self.y
        heading = self.heading + self.rng.normal(0.0, 0.001)
        odom.pose.pose.orientation.z, odom.pose.pose.orientation.w = (
            math.sin(heading / 2),
            math.cos(heading / 2),
        )
        bus.publish("/floor", String(data="carpet" if self.stick else "tiles"))
        bus.publish("/odom", odom)

    def advance(self, cmd):
        """Drive for one step."""
        speed, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        self.turn = turn if abs(turn) >= self.stick else 0.0
        before = math.hypot(self.goal[0] - self.x, self.goal[1] - self.y)
        self.heading += self.turn * DT
        self.x += speed * math.cos(self.heading) * DT
        self.y += speed * math.sin(self.heading) * DT
        self.gained = before - math.hypot(self.goal[0] - self.x, self.goal[1] - self.y)
        self.time += DT

    def judge(self):
        """Return the reward of the step."""
        if self.time > TIME_BOUND:
            self.failure = "does not reach its pose"
            return -5.0
        return 4.0 * self.gained - 0.002 + (8.0 if self.there else 0.0)


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[
        Sensor("floor", topic="/floor", field="data", categories=("tiles", "carpet")),
        Sensor("x", topic="/odom", field="pose.pose.position.x", low=0, high=0.6, bins=4, unit="m"),
    ],
    drifts={"carpet": 0.18},
    episodes=40,
    min_success=0.95,
)
def test_comes_to_its_pose(tarl, tarl_drift, monkeypatch):
    """Go there and turn."""
    floor = Floor(tarl.rng("floor"), tarl_drift or 0.0)
    monkeypatch.setattr("builtins.input", floor.type)
    monkeypatch.setenv("ROS_DISTRO", "humble")
    tarl.start(NODE)
    while not (floor.there or floor.failure):
        floor.publish(tarl.bus)
        tarl.step(DT)
        floor.advance(tarl.bus.latest("/cmd_vel"))
        tarl.reward(floor.judge())
    assert floor.there, floor.failure
