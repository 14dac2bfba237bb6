"""A tracked robot climbs stairs in houses. Cellar stairs are steeper, and their steps are higher."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Imu = message_type("sensor_msgs/Imu")
Range = message_type("sensor_msgs/Range")

DT = 0.1
EDGE = 0.12  # m before the top, where the front looks over it
HOUSE = {"riser": 0.16, "tread": 0.29}
CELLAR = {"riser": 0.205, "tread": 0.25}  # m


class Stairs:
    """A flight of stairs with steps of `riser` and `tread`, in m."""

    def __init__(self, rng, riser, tread):
        self.rng = rng
        self.riser = riser + rng.normal(0.0, 0.002)
        self.slope = math.atan2(self.riser, tread + rng.normal(0.0, 0.003))
        self.length = int(rng.integers(6, 10)) * math.hypot(riser, tread)
        self.gap, self.at = float(rng.uniform(0.8, 1.4)), 0.0  # m to the first riser, m up the flight
        self.load, self.drive = rng.normal(1.0, 0.03), rng.normal(1.0, 0.02)
        self.pitch, self.speed, self.flippers = 0.0, 0.0, 0.0
        self.where = "floor"
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the robot is at the top, or the climb is lost."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the inertial unit and the ranger at the front."""
        imu = Imu()
        pitch = self.pitch + self.rng.normal(0.0, 0.015)
        imu.orientation.w, imu.orientation.y = math.cos(pitch / 2.0), math.sin(pitch / 2.0)
        bus.publish("imu", imu)
        ahead = self.gap if self.where == "floor" else 0.2 if self.at < self.length - EDGE else 2.0
        bus.publish("front/range", Range(range=max(0.03, ahead + self.rng.normal(0.0, 0.008))))

    def advance(self, effort, flippers, state):
        """Drive for one step."""
        self.flippers += 0.3 * ((flippers.data if flippers else 0.0) - self.flippers)
        effort_now = effort.linear.x if effort else 0.0
        steep = self.slope if self.where == "flight" else 0.0
        steep *= 0.35 if self.at > self.length - EDGE else 1.0  # the body leans over the upper edge
        wish = 0.9 * (self.drive * effort_now - 0.85 * self.load * math.sin(steep) * math.cos(0.5 * steep))
        self.speed += 0.3 * (wish - self.speed)
        self.time += DT
        self.gained = -0.003
        tall = 0.05 + 0.32 * math.sin(self.flippers)
        if self.where == "floor":
            self.gap = max(0.0, self.gap - DT * max(0.0, self.speed))
            if self.gap == 0.0 and tall > self.riser:
                self.where = "flight"
            elif self.gap == 0.0:
                self.speed = 0.0
        elif self.where == "flight":
            self.at += DT * self.speed
            rear = max(0.0, self.flippers - 0.2) * 0.35 if self.at < 0.3 else 0.0
            self.pitch += 0.25 * (self.slope + rear - self.pitch)
            if self.at > self.length:
                self.crest()
        else:
            self.pitch += 0.2 * (0.0 - self.pitch)
        self.judge(state.data if state else "")

    def crest(self):
        """Tip over the upper edge; flippers that hang down soften it."""
        blow = self.speed + 0.3 * max(0.0, self.flippers + 0.25)
        self.where = "landing"
        self.gained += 1.0 - 4.0 * max(0.0, blow - 0.1)
        if blow > 0.32:
            self.failure = "robot slams on the landing"

    def judge(self, state):
        """Judge the step."""
        if self.at < -0.15:
            self.failure = "robot slides down the stairs"
        elif self.pitch > 0.95:
            self.failure = "robot tips over backwards"
        elif state == "abort":
            self.failure = "robot gives up"
        elif self.time > 60.0:
            self.failure = "climb takes too long"
        elif state == "landed" and self.where == "landing":
            self.over = True
            self.gained += 4.0
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["stair_climber.py"],
    sensors=[
        Sensor("range", topic="front/range", field="range", low=0.0, high=2.0, bins=5, unit="m"),
        Sensor("effort", topic="tracks/effort", field="linear.x", low=0.0, high=1.0, bins=4),
    ],
    drifts={"cellar": CELLAR},
    episodes=200,
    min_success=0.97,
)
def test_climbs(tarl, tarl_drift):
    """Climb one flight of stairs."""
    stairs = Stairs(tarl.rng("stairs"), **(tarl_drift or HOUSE))
    tarl.start("stair_climber.py")
    while not stairs.done:
        stairs.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        latest = (bus.latest(topic) for topic in ("tracks/effort", "flippers/angle", "climber/state"))
        stairs.advance(*latest)
        tarl.reward(stairs.gained)
    assert not stairs.failure, stairs.failure
