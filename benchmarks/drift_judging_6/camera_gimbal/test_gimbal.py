"""The picture stays level on swell. At low revolutions, vibrations of the new motor disturb the accelerometer."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Imu = message_type("sensor_msgs/msg/Imu")

DT = 0.05
SETTLE, LENGTH = 3.0, 15.0  # s
LEVEL = 0.06  # rad


class Boat:
    """A boat that rolls on swell, its IMU, and a servo."""

    def __init__(self, rng, throb):
        self.rng = rng
        self.throb = throb * rng.uniform(0.9, 1.1)
        self.pace = 2 * math.pi * rng.uniform(1.1, 1.3)
        self.phase = rng.uniform(0.0, 2 * math.pi)
        self.swell = rng.uniform(0.10, 0.18)
        self.period = rng.uniform(4.0, 6.0)
        self.bias = rng.uniform(-0.002, 0.002)
        self.rpm = 900.0 if throb else 0.0
        self.time = self.servo = 0.0
        self.tilted = 0
        self.failure = ""

    @property
    def roll(self):
        """Return the roll of the boat in rad; the swell builds up in the first seconds."""
        size = self.swell * min(1.0, self.time / SETTLE)
        return size * math.sin(2 * math.pi * self.time / self.period)

    @property
    def done(self):
        """Return whether the take is over."""
        return self.time >= LENGTH

    def publish(self, bus):
        """Publish the IMU and the motor's revolutions."""
        before = self.roll
        self.time += DT
        rate = (self.roll - before) / DT
        side = self.throb * math.sin(self.pace * self.time + self.phase)
        imu = Imu()
        imu.angular_velocity.x = rate + self.bias + self.rng.normal(0.0, 0.01)
        imu.linear_acceleration.y = 9.81 * math.sin(self.roll) + side + self.rng.normal(0.0, 0.2)
        imu.linear_acceleration.z = 9.81 * math.cos(self.roll) + self.rng.normal(0.0, 0.2)
        bus.publish("imu/data_raw", imu)
        bus.publish("motor/rpm", Float32(data=max(0.0, self.rpm + self.rng.normal(0.0, 20.0))))

    def advance(self, servo):
        """Turn the camera for one step."""
        aim = servo.data if servo else 0.0
        self.servo += (1.0 - math.exp(-DT / 0.08)) * (aim - self.servo)

    def judge(self):
        """Return the reward of the step: at most 10 in total for a level picture."""
        if self.time < SETTLE:
            return 0.0
        error = abs(self.roll + self.servo)
        self.tilted += error > LEVEL
        if self.done and self.tilted * DT > 0.15 * (LENGTH - SETTLE):
            self.failure = f"tilted for {self.tilted * DT:.1f} s"
            return -4.0
        return 10.0 * DT / (LENGTH - SETTLE) * max(0.0, 1.0 - (error / LEVEL) ** 2)


@pytest.mark.tarl(
    nodes=["gimbal.py"],
    sensors=[
        Sensor("rpm", topic="motor/rpm", field="data", edges=(300.0, 1500.0), unit="1/min"),
        Sensor(
            "rate", topic="imu/data_raw", field="angular_velocity.x", low=-0.2, high=0.2, bins=4, unit="rad/s"
        ),
    ],
    drifts={"outboard motor": 6.5},
    episodes=80,
    min_success=0.95,
)
def test_stays_level(tarl, tarl_drift):
    """Film one take."""
    boat = Boat(tarl.rng("boat"), tarl_drift or 0.0)
    tarl.start("gimbal.py")
    while not boat.done:
        boat.publish(tarl.bus)
        tarl.step(DT)
        boat.advance(tarl.bus.latest("gimbal/roll_servo"))
        tarl.reward(boat.judge())
    assert not boat.failure, boat.failure
