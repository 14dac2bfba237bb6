"""A carrier travels through a tube.

With bottles of blood the carrier is heavy, and the air brakes it less.
"""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Int32 = message_type("std_msgs/msg/Int32")
String = message_type("std_msgs/msg/String")

DT = 0.05
LENGTH = 70.0  # m
GENTLE = 2.4  # speed at the buffer (m/s)
TIME_BOUND = 50.0


class Tube:
    """A straight tube with a carrier, a blower and a reed switch every half metre."""

    def __init__(self, rng, mass):
        self.rng = rng
        self.mass = mass
        self.force = 1.9 * rng.uniform(0.97, 1.03)  # force of the blower at full drive (N)
        self.place, self.speed, self.drive = 0.0, 0.0, 0.0
        self.reeds = 0
        self.time, self.moved = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the carrier has arrived, or the episode has failed."""
        return self.place >= LENGTH or bool(self.failure)

    def publish(self, bus):
        """Publish the request, the weight on the sender's scale, and reed switches that closed."""
        if self.time < 0.3:
            bus.publish("sender/request", String(data="ward 4"))
        bus.publish("sender/scale", Float32(data=self.mass + self.rng.normal(0.0, 0.01)))
        while self.reeds < int(2.0 * self.place):
            self.reeds += 1
            bus.publish("tube/reed", Int32(data=self.reeds))

    def advance(self, cmd):
        """Move the carrier for one step."""
        self.time += DT
        self.drive += 0.4 * ((cmd.data if cmd else 0.0) - self.drive)
        force = self.force * self.drive - 0.03 * self.speed + self.rng.normal(0.0, 0.1)
        self.speed = max(0.0, self.speed + force / self.mass * DT)
        self.moved = self.speed * DT
        self.place += self.moved

    def judge(self):
        """Return the reward of the step: metres are rewarded, and time costs a little."""
        if self.place >= LENGTH and self.speed > GENTLE:
            self.failure = f"the carrier hit the buffer at {self.speed:.1f} m/s"
        elif self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        reward = 10.0 * self.moved / LENGTH - 0.0005
        return reward - 14.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["tube_post.py"],
    sensors=[
        Sensor("mass", topic="sender/scale", field="data", low=0.3, high=2.4, bins=5, unit="kg"),
        Sensor("reed", topic="tube/reed", field="data", low=0.0, high=140.0, bins=7),
    ],
    drifts={"bottles of blood": Drift.range(1.5, 2.1)},
    episodes=100,
    min_success=0.95,
)
def test_arrives_gently(tarl, tarl_drift):
    """Send one carrier."""
    rng = tarl.rng("tube")
    tube = Tube(rng, tarl_drift or rng.uniform(0.5, 0.7))
    tarl.start("tube_post.py")
    while not tube.done:
        tube.publish(tarl.bus)
        tarl.step(DT)
        tube.advance(tarl.bus.latest("blower/drive"))
        tarl.reward(tube.judge())
    assert not tube.failure, tube.failure
