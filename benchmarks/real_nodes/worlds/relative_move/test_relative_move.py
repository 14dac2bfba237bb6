"""TurtleBot3's relative move makes a step that is typed in. Over a wireless link its odometry arrives late."""

import math
from collections import deque

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Odometry = message_type("nav_msgs/msg/Odometry")

NODE = "turtlebot3_example/turtlebot3_example/turtlebot3_relative_move/turtlebot3_relative_move.py"
DT = 0.05
TIME_BOUND = 60.0
FAR = 0.8  # m
WIDE = 0.08  # tolerated distance from the target pose, m and rad


class Floor:
    """A floor; odometry is `late` steps old when it arrives."""

    def __init__(self, rng, late):
        self.goal = (rng.uniform(0.25, 0.45), rng.uniform(-0.3, 0.3), rng.uniform(-80.0, 80.0))
        self.x, self.y, self.heading = 0.0, 0.0, 0.0
        self.typed = iter((*self.goal, *(0.0, 0.0, 0.0)))
        self.asked = 0
        self.poses = deque(maxlen=late + 1)
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

    @property
    def off(self):
        """Return the error of the robot's pose: the larger one of metres and radians."""
        turn = self.heading - math.radians(self.goal[2])
        turned = math.atan2(math.sin(turn), math.cos(turn))
        return max(math.hypot(self.goal[0] - self.x, self.goal[1] - self.y), abs(turned))

    def publish(self, bus):
        """Send the odometry that arrives now."""
        self.poses.append((self.x, self.y, self.heading))
        x, y, heading = self.poses[0]
        odom = Odometry()
        odom.pose.pose.position.x, odom.pose.pose.position.y = x, y
        odom.pose.pose.orientation.z, odom.pose.pose.orientation.w = (
            math.sin(heading / 2),
            math.cos(heading / 2),
        )
        bus.publish("/odom", odom)

    def advance(self, cmd):
        """Drive for one step."""
        speed, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        before = math.hypot(self.goal[0] - self.x, self.goal[1] - self.y)
        self.heading += turn * DT
        self.x += speed * math.cos(self.heading) * DT
        self.y += speed * math.sin(self.heading) * DT
        self.gained = before - math.hypot(self.goal[0] - self.x, self.goal[1] - self.y)
        self.time += DT

    def judge(self):
        """Return the reward of the step."""
        if self.time > TIME_BOUND:
            self.failure = "does not reach its pose"
        elif self.there and self.off > WIDE:
            self.failure = "stops at a wrong pose"
        elif math.hypot(self.x, self.y) > FAR:
            self.failure = "drives past its pose"
        if self.failure:
            return -5.0
        return 4.0 * self.gained - 0.0002 + (8.0 if self.there else 0.0)


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[Sensor("x", topic="/odom", field="pose.pose.position.x", low=0, high=0.5, bins=4, unit="m")],
    drifts={"wireless": Drift(2, permanent=True)},
    episodes=40,
    min_success=0.95,
)
def test_makes_its_step(tarl, tarl_drift, monkeypatch):
    """Turn, go there and turn."""
    floor = Floor(tarl.rng("floor"), int(tarl_drift or 0))
    monkeypatch.setattr("builtins.input", floor.type)
    monkeypatch.setattr("termios.tcgetattr", lambda _: [])
    monkeypatch.setattr("termios.tcsetattr", lambda *_: None)
    monkeypatch.setenv("ROS_DISTRO", "humble")
    tarl.start(NODE)
    while not (floor.there or floor.failure):
        floor.publish(tarl.bus)
        tarl.step(DT)
        floor.advance(tarl.bus.latest("/cmd_vel"))
        tarl.reward(floor.judge())
    assert not floor.failure, floor.failure
