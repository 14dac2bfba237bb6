"""A robot carries tools along a corridor with people. Today it carries a ladder, which sticks out over its bumper."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

LaserScan = message_type("sensor_msgs/LaserScan")
Odometry = message_type("nav_msgs/Odometry")
Float32 = message_type("std_msgs/Float32")

DT = 0.05
BUMPER, LADDER = 0.34, 1.1  # m from the lidar to the foremost part
GOAL = 13.0


class Corridor:
    """A corridor with two people who stop in the way; `front` is how far the robot reaches ahead of its lidar."""

    def __init__(self, rng, front):
        self.rng = rng
        self.front = front + rng.uniform(-0.04, 0.04)
        self.x, self.y, self.yaw, self.speed = (
            0.0,
            float(rng.normal(0.0, 0.1)),
            float(rng.normal(0.0, 0.05)),
            0.0,
        )
        self.people = [float(rng.uniform(3.5, 5.0)), float(rng.uniform(8.0, 10.0))]
        self.steps_in = [float(rng.uniform(2.4, 3.5)) for _ in self.people]  # m ahead of the robot
        self.stays = [float(rng.uniform(3.0, 6.0)) for _ in self.people]  # s
        self.there = [False, False]
        self.time, self.gained, self.failure, self.arrived = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the robot has arrived, or something went wrong."""
        return bool(self.failure) or self.arrived

    @property
    def ahead(self):
        """Return the distance from the lidar to the next person in the way, in m."""
        return min(
            (p - self.x for p, here in zip(self.people, self.there, strict=True) if here), default=20.0
        )

    def publish(self, bus):
        """Publish the goal, the pose, and a scan of the corridor, 2.2 m wide."""
        odom = Odometry()
        odom.pose.pose.position.x = self.x
        odom.pose.pose.position.y = self.y + self.rng.normal(0.0, 0.01)
        odom.pose.pose.orientation.z = math.sin(self.yaw / 2)
        odom.pose.pose.orientation.w = math.cos(self.yaw / 2)
        bus.publish("odom", odom)
        if round(self.time / DT) % 20 == 0:
            bus.publish("runner/goal", Float32(data=GOAL))
        scan = LaserScan(angle_min=-0.6, angle_max=0.6, angle_increment=0.1, range_min=0.05, range_max=8.0)
        scan.ranges = [self.beam(-0.6 + 0.1 * i) for i in range(13)]
        bus.publish("scan", scan)

    def beam(self, angle):
        """Return the range of one beam: a person is 0.4 m wide."""
        wall = 1.1 / max(1e-3, abs(math.sin(angle)))
        reach = self.ahead / math.cos(angle)
        hit = reach if abs(reach * math.sin(angle)) < 0.2 else 20.0
        return min(8.0, wall, hit + self.rng.normal(0.0, 0.01))

    def advance(self, cmd, there):
        """Drive for one step; people step into the way and go on after some seconds."""
        speed, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        self.speed += 0.35 * (speed - self.speed)
        self.yaw += DT * turn
        self.x += DT * self.speed * math.cos(self.yaw)
        self.y += DT * self.speed * math.sin(self.yaw)
        self.time += DT
        self.gained = 0.1 * DT * self.speed - 0.002
        for i, place in enumerate(self.people):
            if place - self.x < self.steps_in[i] and self.stays[i] > 0.0:
                self.there[i] = True
                self.stays[i] -= DT
            else:
                self.there[i] = False
        gap = self.ahead - self.front
        if gap < 0.1:
            self.gained -= 0.02
        if gap < 0.0:
            self.failure = "robot hits a person"
            self.gained -= 8.0
        elif self.time > 60.0:
            self.failure = "robot takes too long"
            self.gained -= 4.0
        elif there and there.data:
            self.arrived = True
            self.gained += 3.0


@pytest.mark.tarl(
    nodes=["front_guard.py", "runner.py"],
    sensors=[
        Sensor("gap", topic="guard/gap", field="data", low=-0.6, high=8.0, bins=5, unit="m"),
        Sensor("speed", topic="cmd_vel", field="linear.x", low=0.0, high=1.1, bins=4, unit="m/s"),
    ],
    drifts={"ladder": LADDER},
    episodes=200,
    min_success=0.97,
)
def test_carries(tarl, tarl_drift):
    """Carry the load from one door to the next."""
    corridor = Corridor(tarl.rng("corridor"), tarl_drift or BUMPER)
    tarl.start("front_guard.py")
    tarl.start("runner.py")
    while not corridor.done:
        corridor.publish(tarl.bus)
        tarl.step(DT)
        corridor.advance(tarl.bus.latest("cmd_vel"), tarl.bus.latest("runner/there"))
        tarl.reward(corridor.gained)
    assert not corridor.failure, corridor.failure
