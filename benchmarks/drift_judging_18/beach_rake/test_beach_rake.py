"""A robot rakes a beach in lanes. After a repair, its inertial unit is mounted upside down."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Imu = message_type("sensor_msgs/Imu")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
LANES, LANE, SHIFT = 4, 6.0, 1.0
UPRIGHT, UPSIDE_DOWN = 1.0, -1.0


class Beach:
    """A beach with the sea to the right of the first lane; `up` is the direction of the unit's z axis."""

    def __init__(self, rng, up):
        self.rng = rng
        self.up = up
        self.bias = float(rng.normal(0.0, 0.01))
        self.grip = float(rng.uniform(0.75, 0.95))
        self.x, self.y, self.heading = 0.0, 0.0, 0.0
        self.speed, self.turn, self.pull, self.rate = 0.0, 0.0, 0.0, 0.0
        self.raked = set()
        self.time, self.gained, self.failure, self.finished = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the robot has finished, or something went wrong."""
        return bool(self.failure) or self.finished

    def publish(self, bus):
        """Publish the inertial unit and the speed of the wheels."""
        imu = Imu()
        imu.angular_velocity.z = self.up * self.rate + self.bias + self.rng.normal(0.0, 0.004)
        imu.linear_acceleration.x = self.rng.normal(0.0, 0.3)
        imu.linear_acceleration.y = self.up * self.rng.normal(0.4, 0.3)
        imu.linear_acceleration.z = self.up * 9.8
        bus.publish("imu", imu)
        bus.publish("wheel/speed", Float32(data=self.speed * self.rng.normal(1.01, 0.02)))

    def advance(self, cmd, down, status):
        """Drive for one step; the sand pulls the robot to one side or the other."""
        speed, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        self.speed += 0.6 * (speed - self.speed)
        self.turn += 0.5 * (self.grip * turn - self.turn)
        self.pull += 0.08 * (self.rng.normal(0.0, 0.22) - self.pull)
        self.rate = self.turn + self.pull * min(1.0, abs(self.speed) / 0.5)
        self.heading += DT * self.rate
        self.x += DT * self.speed * math.cos(self.heading)
        self.y += DT * self.speed * math.sin(self.heading)
        self.time += DT
        self.gained = -0.003
        lane = round(self.y / SHIFT)
        if down and down.data and 0 <= lane < LANES and abs(self.y - lane * SHIFT) < 0.45:
            cell = (lane, math.floor(self.x / 0.5))
            if 0 <= cell[1] < 12 and cell not in self.raked:
                self.raked.add(cell)
                self.gained += 0.2
        self.finished = status == "done"
        if not (-1.6 < self.x < LANE + 1.6 and -1.0 < self.y < LANES * SHIFT + 0.6):
            self.failure = "robot leaves its part of the beach"
        elif self.time > 130.0:
            self.failure = "beach is not raked in time"
        elif self.finished and len(self.raked) < 36:
            self.failure = f"{len(self.raked)} of 48 parts are raked"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["beach_rake.py"],
    sensors=[
        Sensor(
            "turn_rate", topic="imu", field="angular_velocity.z", low=-1.0, high=1.0, bins=5, unit="rad/s"
        ),
        Sensor("speed", topic="wheel/speed", field="data", low=0.0, high=0.7, bins=3, unit="m/s"),
    ],
    drifts={"unit upside down": Drift(UPSIDE_DOWN, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_rakes(tarl, tarl_drift):
    """Rake four lanes."""
    beach = Beach(tarl.rng("beach"), tarl_drift or UPRIGHT)
    tarl.start("beach_rake.py")
    while not beach.done:
        beach.publish(tarl.bus)
        tarl.step(DT)
        told = tarl.bus.latest("rake/status")
        beach.advance(tarl.bus.latest("cmd_vel"), tarl.bus.latest("rake/down"), told.data if told else "")
        tarl.reward(beach.gained)
    assert not beach.failure, beach.failure
