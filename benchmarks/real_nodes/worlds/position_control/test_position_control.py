"""TurtleBot3 drives to a pose that a person types. On a carpet the base does not turn slowly."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Odometry = message_type("nav_msgs/msg/Odometry")
Bool = message_type("std_msgs/msg/Bool")

PACKAGE = "turtlebot3_example/turtlebot3_example/turtlebot3_position_control"
NODE = f"{PACKAGE}/main.py"
FILES = [NODE, f"{PACKAGE}/turtlebot3_position_control.py", f"{PACKAGE}/turtlebot3_path.py"]
DT = 0.05
TIME_BOUND = 45.0
STILL = 2.0  # a robot that stands for so long after its drive has finished, s


class Floor:
    """A floor on which the base does not turn at less than `stiction` rad/s."""

    def __init__(self, rng, stiction):
        self.rng = rng
        self.stiction = stiction
        self.x, self.y, self.heading = rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-0.5, 0.5)
        self.forward, self.left = rng.uniform(0.3, 0.6), rng.uniform(-0.25, 0.25)
        self.degrees = float(round(rng.uniform(-50, 50)))
        self.goal = (self.x + self.forward, self.y + self.left, self.heading + math.radians(self.degrees))
        self.time, self.still, self.moved = 0.0, 0.0, False
        self.failure = ""

    @property
    def typed(self):
        """Return what the person types."""
        return f"{self.forward:.3f}\n{self.left:.3f}\n{self.degrees}\n"

    def publish(self, bus):
        """Publish the odometry and whether the robot is on a carpet."""
        odom = Odometry()
        odom.pose.pose.position.x, odom.pose.pose.position.y = self.x, self.y
        heading = self.heading + self.rng.normal(0.0, 0.0003)
        odom.pose.pose.orientation.z = math.sin(heading / 2)
        odom.pose.pose.orientation.w = math.cos(heading / 2)
        bus.publish("/odom", odom)
        bus.publish("/carpet", Bool(data=self.stiction > 0.0))

    @property
    def far(self):
        """Return the distance to the goal, m, and the angle to its direction, rad."""
        x, y, heading = self.goal
        return math.hypot(x - self.x, y - self.y), abs(heading - self.heading)

    def advance(self, cmd):
        """Drive for one step."""
        before = self.far
        speed, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        turn = turn if abs(turn) >= self.stiction else 0.0
        self.heading += turn * DT
        self.x += speed * math.cos(self.heading) * DT
        self.y += speed * math.sin(self.heading) * DT
        self.moved = self.moved or bool(speed)
        self.still = 0.0 if speed or turn else self.still + DT
        self.time += DT
        self.gained = before[0] - self.far[0]

    @property
    def over(self):
        """Return whether the mission has ended."""
        return bool(self.failure) or (self.moved and self.still > STILL)

    def judge(self):
        """Return the reward of the step: for progress, and for the pose at the end."""
        if self.time > TIME_BOUND:
            self.failure = "late"
        elif self.moved and self.still > STILL:
            distance, angle = self.far
            if distance > 0.03 or angle > 0.05:
                self.failure = "not at the goal"
            else:
                return 5.0
        return (-5.0 if self.failure else 0.0) + 5.0 * self.gained - 0.05 * DT


@pytest.mark.tarl(
    nodes=FILES,
    sensors=[
        Sensor("carpet", topic="/carpet", field="data"),
        Sensor("heading", topic="/odom", field="pose.pose.orientation.z", low=-0.6, high=0.6, bins=6),
    ],
    drifts={"carpet": 0.15},
    episodes=40,
    min_success=0.95,
)
def test_drives_to_the_pose(tarl, tarl_drift):
    """Type a pose and wait."""
    floor = Floor(tarl.rng("floor"), tarl_drift or 0.0)
    tarl.start(NODE)
    tarl.type(floor.typed)
    while not floor.over:
        floor.publish(tarl.bus)
        tarl.step(DT)
        floor.advance(tarl.bus.latest("/cmd_vel"))
        tarl.reward(floor.judge())
    assert not floor.failure, floor.failure
