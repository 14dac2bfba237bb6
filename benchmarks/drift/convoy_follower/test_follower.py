"""The follower stays close behind and never touches the vehicle in front, even on a wet road."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/Float64")
Float32 = message_type("std_msgs/Float32")
Range = message_type("sensor_msgs/Range")

DT = 0.1
DURATION = 18.0
WET = (60.0, 220.0)  # section of the road (m)


class Road:
    """Two vehicles; the first brakes hard once. `grip` is the braking that a wet road allows, m/s²."""

    def __init__(self, rng, grip):
        self.rng = rng
        self.grip = grip
        self.brakes = rng.uniform(7.0, 10.0)
        self.leader_speed = self.speed = 14.0
        self.x = 0.0
        self.leader = 13.0 + rng.uniform(0.0, 2.0)
        self.time = 0.0
        self.failure = ""

    @property
    def gap(self):
        """Return the gap between the vehicles, m."""
        return self.leader - self.x

    @property
    def wet(self):
        """Return whether the road is wet at the follower."""
        return self.grip < 9.0 and WET[0] <= self.x <= WET[1]

    def publish(self, bus):
        """Publish the measurements of rain sensor, wheels and radar."""
        bus.publish("/rain", Float32(data=(0.8 if self.wet else 0.05) + self.rng.normal(0.0, 0.02)))
        bus.publish("/speed", Float64(data=self.speed))
        bus.publish("/range", Range(range=self.gap + self.rng.normal(0.0, 0.02)))

    def advance(self, command):
        """Drive for one step."""
        wanted = command.data if command else 0.0
        most = self.grip if self.wet else 9.0
        self.speed = max(0.0, self.speed + max(-most, min(3.0, wanted)) * DT)
        braking = self.brakes <= self.time < self.brakes + 2.5
        change = -4.5 if braking else 1.5 if self.leader_speed < 14.0 else 0.0
        self.leader_speed = max(0.0, self.leader_speed + change * DT)
        self.x += self.speed * DT
        self.leader += self.leader_speed * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step: it grows as the gap shrinks, down to a gap that is too small."""
        if self.gap < 1.0:
            self.failure = "drove into the vehicle in front"
            return -5.0
        return 0.06 - 0.0004 * max(0.0, self.gap - 12.0)


@pytest.mark.tarl(
    nodes=["follower.py"],
    sensors=[
        Sensor("rain", topic="/rain", field="data", low=0, high=1, bins=5),
        Sensor("speed", topic="/speed", field="data", low=0, high=16, bins=4, unit="m/s"),
    ],
    drifts={"wet road": 2.5},
    episodes=100,
    min_success=0.95,
)
def test_follows_without_touching(tarl, tarl_drift):
    """Never touch the vehicle in front."""
    road = Road(tarl.rng("road"), tarl_drift or 9.0)
    tarl.start("follower.py")
    while road.time < DURATION and not road.failure:
        road.publish(tarl.bus)
        tarl.step(DT)
        road.advance(tarl.bus.latest("/acceleration"))
        tarl.reward(road.judge())
    assert not road.failure, road.failure
