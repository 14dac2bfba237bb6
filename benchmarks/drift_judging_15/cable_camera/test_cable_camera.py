"""A camera on a cable follows athletes. In autumn the wind blows along the cable."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
Odometry = message_type("nav_msgs/msg/Odometry")
PointStamped = message_type("geometry_msgs/msg/PointStamped")

DT = 0.05
STEPS = 260
SETTLED = 120  # number of steps until the picture counts
CALM = 1.5  # m/s


class Track:
    """A carriage on a cable; `wind` blows against its way, in m/s."""

    def __init__(self, rng, wind):
        self.rng = rng
        self.wind = wind
        self.mass = rng.uniform(44.0, 48.0)
        self.athlete, self.pace = 12.0, rng.uniform(3.5, 5.0)
        self.place, self.speed, self.force = 12.0 + rng.normal(0.0, 0.2), 0.0, 0.0
        self.now, self.missed, self.gained = 0, 0, 0.0

    def publish(self, bus):
        """Publish where the athletes and the carriage are."""
        seen = PointStamped()
        seen.point.x = self.athlete + self.rng.normal(0.0, 0.02)
        bus.publish("athlete", seen)
        at = Odometry()
        at.pose.pose.position.x = self.place + self.rng.normal(0.0, 0.005)
        bus.publish("carriage", at)
        if self.now % 20 == 0:
            bus.publish("battery", Float64(data=50.0 + self.rng.normal(0.0, 0.2)))

    def advance(self, command):
        """Move the carriage for one step; the picture counts from the sixth second."""
        self.force += 0.5 * ((command.data if command else 0.0) - self.force)
        air = self.wind * (1.0 + 0.06 * self.rng.normal()) + 0.2 * self.speed
        self.speed += DT * (self.force - 0.9 * air * abs(air) - 6.0 * self.speed) / self.mass
        self.place += DT * self.speed
        self.athlete += DT * self.pace * min(1.0, self.now * DT / 2.0)
        self.now += 1
        self.gained = 0.0
        if self.now > SETTLED:
            off = abs(self.place - self.athlete - 0.35 * self.pace)
            self.missed += off > 0.9
            self.gained = 0.1 * (1.0 - min(2.0, 1.0 * max(0.0, off - 0.3)))


@pytest.mark.tarl(
    nodes=["cable_camera.py", "winch_pid.py"],
    sensors=[
        Sensor("athlete", topic="athlete", field="point.x", low=0.0, high=80.0, bins=5, unit="m"),
        Sensor(
            "carriage", topic="carriage", field="pose.pose.position.x", low=0.0, high=80.0, bins=5, unit="m"
        ),
    ],
    drifts={"wind": Drift.range(11.0, 14.5)},
    episodes=200,
    min_success=0.97,
)
def test_follows(tarl, tarl_drift):
    """Follow a group of athletes for thirteen seconds."""
    track = Track(tarl.rng("track"), CALM if tarl_drift is None else tarl_drift)
    tarl.start("cable_camera.py")
    for _ in range(STEPS):
        track.publish(tarl.bus)
        tarl.step(DT)
        track.advance(tarl.bus.latest("winch/force"))
        tarl.reward(track.gained)
    assert track.missed <= 10, f"athletes out of the picture for {track.missed} steps"
