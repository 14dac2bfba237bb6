"""The shuttle hits nobody. People cross in one of eight missions; on a wet road the shuttle takes longer to stop."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Bool = message_type("std_msgs/msg/Bool")

DT = 0.1
LENGTH = 30.0
SIGHT = 12.0  # m
CROSSING = 0.12  # share of missions in which a person steps on the road
TIME_BOUND = 40.0


class Road:
    """A road; `grip` is the possible braking and acceleration of the shuttle as a share of that on a dry road."""

    def __init__(self, rng, grip):
        self.rng = rng
        self.grip = grip * rng.uniform(0.95, 1.05)
        self.wet = grip < 1.0
        self.x, self.speed = 0.0, 0.0
        self.person = rng.uniform(14.0, 26.0) if rng.random() < CROSSING else None
        self.steps_out = rng.uniform(6.5, 11.0)  # distance at which the person steps out, m
        self.crossing = 6.0  # s
        self.time = 0.0
        self.gained = 0.0
        self.failure = ""

    @property
    def through(self):
        """Return whether the shuttle is at its stop."""
        return self.x >= LENGTH

    @property
    def ahead(self):
        """Return the free distance on the road, m."""
        if self.person is None or self.crossing <= 0.0:
            return SIGHT
        away = self.person - self.x
        return away if away < self.steps_out else SIGHT

    def publish(self, bus):
        """Publish the measurements of wheels, lidar and rain sensor."""
        bus.publish("/rain", Bool(data=self.wet))
        bus.publish("/speed", Float32(data=self.speed + self.rng.normal(0.0, 0.03)))
        bus.publish("/ahead", Float32(data=self.ahead + self.rng.normal(0.0, 0.05)))

    def advance(self, pedal):
        """Drive for one step; the grip of the road limits the acceleration."""
        pressed = max(-1.0, min(1.0, pedal.data)) if pedal else 0.0
        wanted = 3.5 * pressed if pressed < 0.0 else 2.0 * pressed
        most = 3.5 * self.grip
        self.speed = max(0.0, self.speed + max(-most, min(most, wanted)) * DT)
        self.gained = self.speed * DT
        self.x += self.gained
        if self.ahead < SIGHT:
            self.crossing -= DT
        self.time += DT

    def judge(self):
        """Return the reward of the step."""
        if self.ahead < 0.3:
            self.failure = "hit a person"
            return -30.0
        if self.time > TIME_BOUND:
            self.failure = "late"
            return -5.0
        return 10.0 * self.gained / LENGTH - 0.01


@pytest.mark.tarl(
    nodes=["shuttle.py", "braking.py"],
    sensors=[
        Sensor("rain", topic="/rain", field="data"),
        Sensor("ahead", topic="/ahead", field="data", low=0, high=12, bins=6, unit="m"),
    ],
    drifts={"wet road": 0.25},
    episodes=150,
    min_success=0.95,
)
def test_hits_nobody(tarl, tarl_drift):
    """Come to the stop."""
    road = Road(tarl.rng("road"), tarl_drift or 1.0)
    tarl.start("shuttle.py")
    while not (road.through or road.failure):
        road.publish(tarl.bus)
        tarl.step(DT)
        road.advance(tarl.bus.latest("/pedal"))
        tarl.reward(road.judge())
    assert road.through, road.failure
