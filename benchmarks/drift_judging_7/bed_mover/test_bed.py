"""A bed reaches its bay in time. With a patient in the bed, the speed must not exceed 0.75 m/s."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float64 = message_type("std_msgs/msg/Float64")
Odometry = message_type("nav_msgs/msg/Odometry")

DT = 0.2
GENTLE = 0.75  # maximum speed with a patient, m/s
TIME_BOUND = 16.0


class Ward:
    """A corridor of a ward with a bed on wheels."""

    def __init__(self, rng, patient):
        self.rng = rng
        self.patient = patient
        self.bay = rng.uniform(4.0, 6.5)
        self.x, self.y = 0.0, rng.uniform(-0.15, 0.15)
        self.vx = self.vy = 0.0
        self.time = self.rough = 0.0
        self.stood = 0

    @property
    def arrived(self):
        """Return whether the bed stands in its bay."""
        return self.stood >= 3

    @property
    def done(self):
        """Return whether the bed stands in its bay or the time is over."""
        return self.arrived or self.time > TIME_BOUND

    def publish(self, bus):
        """Publish bay, load cell and odometry."""
        odom = Odometry()
        odom.pose.pose.position.x = self.x + self.rng.normal(0.0, 0.003)
        odom.pose.pose.position.y = self.y + self.rng.normal(0.0, 0.003)
        odom.twist.twist.linear.x, odom.twist.twist.linear.y = self.vx, self.vy
        bus.publish("bay", Float64(data=self.bay))
        bus.publish("bed/occupied", Bool(data=self.patient))
        bus.publish("odom", odom)

    def advance(self, cmd):
        """Move one step and return its reward."""
        self.time += DT
        if cmd is None:
            return 0.0
        self.vx += 0.6 * (max(-2.5, min(2.5, cmd.linear.x)) - self.vx)
        self.vy += 0.6 * (cmd.linear.y - self.vy)
        self.x += self.vx * DT
        self.y += self.vy * DT
        reward = -0.02
        if self.patient and abs(self.vx) > GENTLE:
            self.rough += DT
            reward -= 1.5 * (abs(self.vx) - GENTLE)
        near = abs(self.x - self.bay) < 0.1 and abs(self.y) < 0.1 and abs(self.vx) < 0.1
        self.stood = self.stood + 1 if near else 0
        return reward + (11.0 if self.arrived else 0.0)


@pytest.mark.tarl(
    nodes=["bed_mover.py"],
    sensors=[
        Sensor("occupied", topic="bed/occupied", field="data"),
        Sensor("x", topic="odom", field="pose.pose.position.x", low=0, high=6.5, bins=5, unit="m"),
    ],
    drifts={"patient": True},
    episodes=100,
    min_success=0.95,
)
def test_brings(tarl, tarl_drift):
    """Bring one bed to its bay."""
    ward = Ward(tarl.rng("ward"), bool(tarl_drift))
    tarl.start("bed_mover.py")
    while not ward.done:
        ward.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(ward.advance(tarl.bus.latest("cmd_vel")))
    assert ward.arrived, "late"
    assert ward.rough < 0.5, f"too fast for the patient for {ward.rough:.1f} s"
