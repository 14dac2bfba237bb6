"""A yard tractor backs trailers into a bay. The farm has sold its short trailer and bought a long one."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Pose2D = message_type("geometry_msgs/msg/Pose2D")

DT = 0.1
SHORT, LONG = 3.4, 9.5  # m from the axle to the hitch
WHEELBASE = 2.1


class Yard:
    """A trailer before its bay; `y` is the offset of its axle from the middle, `range` the way to the dock."""

    def __init__(self, rng, length):
        self.rng = rng
        self.length = length * rng.normal(1.0, 0.005)
        self.range = float(rng.uniform(13.0, 15.0))
        self.x, self.y = 0.0, float(rng.choice((-1.0, 1.0)) * rng.uniform(0.8, 1.3))
        self.heading = float(rng.uniform(-0.08, 0.08))
        self.joint, self.steer = float(rng.normal(0.0, 0.03)), 0.0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the trailer is parked, or something went wrong."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the trailer's pose, the angle at the hitch and the range to the dock."""
        pose = Pose2D(x=self.x, y=self.y + self.rng.normal(0.0, 0.006))
        pose.theta = self.heading + self.rng.normal(0.0, 0.004)
        bus.publish("trailer/pose", pose)
        bus.publish("hitch/angle", Float32(data=self.joint + self.rng.normal(0.0, 0.004)))
        bus.publish("dock/range", Float32(data=self.range + self.rng.normal(0.0, 0.01)))

    def advance(self, drive, parked):
        """Roll for one step; the heading is that of the way backwards."""
        speed = -drive.speed if drive else 0.0
        wish = drive.steering_angle if drive else 0.0
        self.steer += max(-0.12, min(0.12, wish - self.steer))
        turn = speed * math.sin(self.joint) / self.length
        self.joint += DT * (speed * math.tan(self.steer) / WHEELBASE - turn)
        self.heading += DT * turn
        way = DT * speed * math.cos(self.joint)
        self.x += way * math.cos(self.heading)
        self.y += way * math.sin(self.heading)
        self.range -= way * math.cos(self.heading)
        self.time += DT
        self.gained = 0.04 * DT * speed - 0.003
        if abs(self.joint) > 1.2:
            self.failure = "trailer jackknifes"
        elif self.range < 0.0:
            self.failure = "trailer rams the dock"
        elif self.time > 60.0:
            self.failure = "trailer is not parked"
        elif parked and parked.data:
            self.over = True
            if abs(self.y) > 0.14 or abs(self.heading) > 0.09:
                self.failure = f"trailer stands {100 * abs(self.y):.0f} cm beside the middle"
            else:
                self.gained += 5.0 - 8.0 * abs(self.y)
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["trailer_backer.py", "hitch.py"],
    sensors=[
        Sensor("offset", topic="trailer/pose", field="y", low=-1.5, high=1.5, bins=6, unit="m"),
        Sensor("joint", topic="hitch/angle", field="data", low=-1.0, high=1.0, bins=4, unit="rad"),
    ],
    drifts={"long trailer": Drift(LONG, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_backs_in(tarl, tarl_drift):
    """Back one trailer into the bay."""
    yard = Yard(tarl.rng("yard"), tarl_drift or SHORT)
    tarl.start("trailer_backer.py")
    while not yard.done:
        yard.publish(tarl.bus)
        tarl.step(DT)
        yard.advance(tarl.bus.latest("drive"), tarl.bus.latest("backer/parked"))
        tarl.reward(yard.gained)
    assert not yard.failure, yard.failure
