"""The robot drives and stops where the operator expects it. A new battery shifts its centre of mass."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Imu = message_type("sensor_msgs/Imu")
Odometry = message_type("nav_msgs/Odometry")
Twist = message_type("geometry_msgs/Twist")

DT = 0.02
LENGTH = 0.35  # distance from the axle to the centre of mass (m)
GO, HOLD = 4.0, 3.0  # s
OFF = 0.6  # tolerated distance from the commanded place, m


class Segway:
    """An inverted pendulum on wheels whose acceleration is commanded."""

    def __init__(self, rng, balance):
        self.rng = rng
        self.balance = balance + rng.normal(0.0, 0.0015)
        self.pitch = self.balance + rng.normal(0.0, 0.02)
        self.rate = self.x = self.speed = self.time = self.reference = 0.0
        self.cruise = rng.uniform(0.35, 0.55)
        self.failure = ""

    @property
    def wanted(self):
        """Return the commanded speed, m/s."""
        return self.cruise if self.time < GO else 0.0

    @property
    def done(self):
        """Return whether the mission is over."""
        return bool(self.failure) or self.time > GO + HOLD

    def publish(self, bus):
        """Publish the command, the wheels' odometry and the IMU."""
        command, odometry, imu = Twist(), Odometry(), Imu()
        command.linear.x = self.wanted
        odometry.twist.twist.linear.x = self.speed + self.rng.normal(0.0, 0.01)
        pitch = self.pitch + self.rng.normal(0.0, 0.002)
        imu.orientation.w, imu.orientation.y = math.cos(pitch / 2), math.sin(pitch / 2)
        imu.angular_velocity.y = self.rate + self.rng.normal(0.0, 0.01)
        bus.publish("cmd_vel", command)
        bus.publish("odom", odometry)
        bus.publish("imu", imu)

    def advance(self, accel):
        """Move by one step."""
        push = (accel.data if accel else 0.0) + self.rng.normal(0.0, 0.1)
        self.time += DT
        self.rate += (9.81 * math.sin(self.pitch - self.balance) - push * math.cos(self.pitch)) / LENGTH * DT
        self.pitch += self.rate * DT
        self.speed += push * DT
        self.x += self.speed * DT
        self.reference += self.wanted * DT

    def judge(self):
        """Return the reward of the step: at most 10 in total for following the commanded motion."""
        gap = abs(self.x - self.reference)
        if abs(self.pitch) > 0.7:
            self.failure = "fell over"
        elif gap > OFF:
            self.failure = f"{gap:.1f} m from where it should be"
        if self.failure:
            return -5.0
        return 10.0 * DT / (GO + HOLD) * max(0.0, 1.0 - gap / (2.0 * OFF))


@pytest.mark.tarl(
    nodes=["balancer.py"],
    sensors=[
        Sensor("wanted", topic="cmd_vel", field="linear.x", edges=(0.1,), unit="m/s"),
        Sensor("speed", topic="odom", field="twist.twist.linear.x", low=-0.6, high=1.2, bins=6, unit="m/s"),
    ],
    drifts={"new battery": Drift(0.055, permanent=True)},
    episodes=80,
    min_success=0.95,
)
def test_balances(tarl, tarl_drift):
    """Drive, stop and stand."""
    robot = Segway(tarl.rng("segway"), -0.012 if tarl_drift is None else tarl_drift)
    tarl.start("balancer.py")
    while not robot.done:
        robot.publish(tarl.bus)
        tarl.step(DT)
        robot.advance(tarl.bus.latest("wheels/accel"))
        tarl.reward(robot.judge())
    assert not robot.failure, robot.failure
