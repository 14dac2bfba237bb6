"""TurtleBot3's obstacle detection stops a robot that its operator drives towards a wall. A tool makes it longer."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

LaserScan = message_type("sensor_msgs/msg/LaserScan")
Twist = message_type("geometry_msgs/msg/Twist")
Float32 = message_type("std_msgs/msg/Float32")

NODE = "turtlebot3_example/turtlebot3_example/turtlebot3_obstacle_detection/turtlebot3_obstacle_detection.py"
DT = 0.1
TIME = 14.0
NEAR, FAR = 0.25, 0.65  # allowed final distances of the front from the wall, m


class Hall:
    """A wall ahead; the tool reaches `tool` m beyond the robot."""

    def __init__(self, rng, tool):
        self.rng = rng
        self.tool = tool
        self.gap = rng.uniform(1.3, 2.2)  # from the lidar to the wall
        self.start = self.gap
        self.speed = 0.0
        self.pushing = rng.uniform(0.18, 0.22)
        self.time = 0.0
        self.failure = ""

    def publish(self, bus):
        """Publish the measurements of the lidar and the commands of the operator."""
        ranges = []
        for degree in range(360):
            cos = math.cos(math.radians(degree))
            ranges.append(min(3.5, self.gap / cos) if cos > 0.1 else 3.5)
        bus.publish("/tool", Float32(data=self.tool))
        bus.publish("/scan", LaserScan(ranges=ranges))
        wanted = Twist()
        wanted.linear.x = self.pushing
        bus.publish("/cmd_vel_raw", wanted)

    def advance(self, cmd):
        """Drive for one step."""
        wanted = cmd.linear.x if cmd else 0.0
        self.speed += (wanted - self.speed) * 0.6
        self.moved = self.speed * DT
        self.gap -= self.moved + abs(self.rng.normal(0.0, 0.0005))
        self.time += DT

    def judge(self):
        """Return the reward of the step: progress up to the allowed distance from the wall."""
        front = self.gap - self.tool
        if front < NEAR:
            self.failure = "too close to the wall"
            return -10.0
        if self.time >= TIME and front > FAR:
            self.failure = "stopped too early"
            return -5.0
        return 10.0 * DT / TIME if front < FAR else 5.0 * self.moved / self.start


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[
        Sensor("tool", topic="/tool", field="data", low=0, high=0.5, bins=5, unit="m"),
        Sensor("ahead", topic="/scan", field="ranges.0", low=0, high=2.5, bins=10, unit="m"),
    ],
    drifts={"long tool": 0.35, "tool for good": Drift(0.35, permanent=True)},
    episodes=60,
    min_success=0.95,
)
def test_stops_before_the_wall(tarl, tarl_drift):
    """Stop near the wall, not at it."""
    hall = Hall(tarl.rng("hall"), tarl_drift or 0.0)
    tarl.start(NODE)
    while hall.time < TIME and not hall.failure:
        hall.publish(tarl.bus)
        tarl.step(DT)
        hall.advance(tarl.bus.latest("/cmd_vel"))
        tarl.reward(hall.judge())
    assert not hall.failure, hall.failure
