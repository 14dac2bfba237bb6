"""A shield steers along a laser. In soft clay, the soil does not guide it, and it turns more easily."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Imu = message_type("sensor_msgs/msg/Imu")
PointStamped = message_type("geometry_msgs/msg/PointStamped")

DT = 3.0
GRAVEL = {"guide": 0.3, "turn": 0.1}
CLAY = {"guide": 0.02, "turn": 0.38}  # 1/m; mrad per m and mrad


class Ground:
    """Soil that guides the shield by `guide`, and in which its steering turns it by `turn`."""

    def __init__(self, rng, guide, turn):
        self.rng = rng
        self.guide = guide * rng.normal(1.0, 0.08)
        self.turn = turn * rng.normal(1.0, 0.05)
        self.push = rng.normal(0.0, 0.1)  # mrad per m, from the slope of the layer
        self.lump = 0.0
        self.offset = float(rng.uniform(8.0, 16.0)) * rng.choice([-1.0, 1.0])  # mm
        self.heading, self.steer, self.way = rng.normal(0.0, 1.0), 0.0, 0.0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the drive is through."""
        return bool(self.failure) or self.way >= 45.0

    def publish(self, bus):
        """Publish the target of the laser, the gyro and the jacks."""
        target, gyro = PointStamped(), Imu()
        target.point.x = 0.001 * (self.offset + self.rng.normal(0.0, 0.5))
        gyro.orientation.z = 0.0005 * (self.heading + self.rng.normal(0.0, 0.15))
        bus.publish("shield/target", target)
        bus.publish("shield/gyro", gyro)
        bus.publish("jacks/thrust", Float32(data=420.0 + 5.0 * self.way + self.rng.normal(0.0, 15.0)))
        if round(self.time / DT) % 20 == 0:
            bus.publish("shaft/release", Bool(data=True))

    def advance(self, steer, speed):
        """Jack for one step."""
        self.time += DT
        self.gained = 0.0
        self.steer += 0.1 * ((steer.data if steer else 0.0) - self.steer)
        step = DT * (speed.data if speed else 0.0)
        self.lump += 0.3 * (self.rng.normal(0.0, 0.4) - self.lump)
        self.heading += step * (self.turn * self.steer - self.guide * self.heading + self.push + self.lump)
        self.offset += step * self.heading
        self.way += step
        off = abs(self.offset)
        self.gained = 0.03 - 0.003 * max(0.0, off - 12.0)
        if off > 40.0:
            self.failure = "pipes leave their line"
        elif self.way > 25.0 and off > 20.0:
            self.failure = "shield misses the seal of the shaft"
        elif self.time > 1500.0:
            self.failure = "drive takes too long"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["pipe_jacker.py"],
    sensors=[
        Sensor("offset", topic="shield/target", field="point.x", low=-0.04, high=0.04, bins=8, unit="m"),
        Sensor("heading", topic="shield/gyro", field="orientation.z", low=-0.008, high=0.008, bins=6),
    ],
    drifts={"clay": CLAY},
    episodes=200,
    min_success=0.97,
)
def test_jacks(tarl, tarl_drift):
    """Drive one line of pipes."""
    ground = Ground(tarl.rng("ground"), **(tarl_drift or GRAVEL))
    tarl.start("pipe_jacker.py")
    while not ground.done:
        ground.publish(tarl.bus)
        tarl.step(DT)
        ground.advance(tarl.bus.latest("shield/steer"), tarl.bus.latest("jacks/speed"))
        tarl.reward(ground.gained)
    assert not ground.failure, ground.failure
