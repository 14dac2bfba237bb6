"""The corners of a court are painted in the right places. On wet artificial turf all wheels slip, mostly in turns."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32MultiArray = message_type("std_msgs/Float32MultiArray")
Int32MultiArray = message_type("std_msgs/Int32MultiArray")

DT = 0.1
WHEEL, TICKS = 0.105, 1024
# whether the turf is wet → share of the wheels' roll that moves the robot, effective track in m
TURF = {False: (1.0, 0.52), True: (0.87, 0.66)}
NEAR = 0.35  # m
TIME_BOUND = 40.0


class Turf:
    """A robot on turf."""

    def __init__(self, rng, wet):
        self.rng = rng
        self.wet = wet
        grip, track = TURF[wet]
        self.grip = grip * rng.uniform(0.99, 1.01)
        self.track = track * rng.uniform(0.99, 1.01)
        self.length, self.width = rng.uniform(3.2, 4.2), rng.uniform(2.2, 3.0)
        self.corners = [(self.length, 0.0), (self.length, self.width), (0.0, self.width), (0.0, 0.0)]
        self.x = self.y = self.heading = self.time = 0.0
        self.left = self.right = 0.0
        self.painting = self.finished = False
        self.failure = ""

    @property
    def done(self):
        """Return whether the court is painted, or the episode has failed."""
        return self.finished or bool(self.failure)

    def publish(self, bus):
        """Publish the job, the encoders and the turf's wetness."""
        bus.publish("court", Float32MultiArray(data=[self.length, self.width]))
        bus.publish("turf/wet", Bool(data=self.wet))
        bus.publish("encoders", Int32MultiArray(data=[int(self.left), int(self.right)]))

    def advance(self, command, valve, finished):
        """Drive for one step; return the ends of lines that were painted in it."""
        self.time += DT
        linear = command.linear.x if command else 0.0
        angular = command.angular.z if command else 0.0
        sides = [
            (linear + sign * angular * 0.26) * DT * (1.0 + self.rng.normal(0.0, 0.01)) for sign in (-1, 1)
        ]
        self.left += sides[0] / (2 * math.pi * WHEEL) * TICKS
        self.right += sides[1] / (2 * math.pi * WHEEL) * TICKS
        forward = self.grip * (sides[0] + sides[1]) / 2
        turn = (sides[1] - sides[0]) / self.track
        self.x += forward * math.cos(self.heading + turn / 2)
        self.y += forward * math.sin(self.heading + turn / 2)
        self.heading += turn + self.rng.normal(0.0, 0.001)
        self.finished = bool(finished and finished.data)
        painted, self.painting = self.painting, bool(valve and valve.data)
        return painted and not self.painting

    def judge(self, corner):
        """Return the reward of the step: 2.5 for each corner in its place."""
        reward = -0.002
        if corner and self.corners:
            x, y = self.corners.pop(0)
            off = math.hypot(self.x - x, self.y - y)
            if off > NEAR:
                self.failure = f"a corner is {100 * off:.0f} cm off"
            reward += 2.5
        if self.finished and self.corners:
            self.failure = "not all lines are painted"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        return -4.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["marker.py", "odometry.py"],
    sensors=[
        Sensor("wet", topic="turf/wet", field="data"),
        Sensor("length", topic="court", field="data.0", low=3.2, high=4.2, bins=2, unit="m"),
    ],
    drifts={"wet turf": True},
    episodes=80,
    min_success=0.95,
)
def test_paints(tarl, tarl_drift):
    """Paint one court."""
    turf = Turf(tarl.rng("turf"), bool(tarl_drift))
    tarl.start("marker.py")
    while not turf.done:
        turf.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        corner = turf.advance(latest("cmd_vel"), latest("paint/valve"), latest("paint/finished"))
        tarl.reward(turf.judge(corner))
    assert not turf.failure, turf.failure
