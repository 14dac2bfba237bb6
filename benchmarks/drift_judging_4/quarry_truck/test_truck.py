"""A truck tips at the edge, and stops when the supervisor requires it. A rock face sometimes blocks the radio."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Empty = message_type("std_msgs/msg/Empty")
Float64 = message_type("std_msgs/msg/Float64")

DT = 0.1
STOPS = 0.3  # share of the missions in which the supervisor releases the handheld
STOP_WAY = 25.0  # maximum stopping distance after that, m
TIME_BOUND = 35.0


class Road:
    """The way to the edge; a share `shade` of the missions has a gap in the radio signal."""

    def __init__(self, rng, shade):
        self.rng = rng
        self.face = shade > 0.0
        self.length = rng.uniform(70.0, 90.0)
        self.place, self.speed, self.gained = 0.0, 0.0, 0.0
        self.release_at = rng.uniform(35.0, 55.0) if rng.random() < STOPS else None
        gap = rng.uniform(1.0, 1.25)
        self.shaded = rng.random() < shade and self.release_at is None
        start = rng.uniform(5.0, 9.0)
        self.gap = (start, start + gap)
        self.steps = 0
        self.tipped = self.stopped = False
        self.released_at = None
        self.failure = ""

    @property
    def done(self):
        """Return whether the load is tipped or the truck has stopped for the supervisor, or the episode has failed."""
        return self.tipped or self.stopped or bool(self.failure)

    def publish(self, bus):
        """Publish position and speed, and, in every other step, a heartbeat if one is received."""
        bus.publish("map/rock_face", Bool(data=self.face))
        to_edge = self.length - self.place + self.rng.normal(0.0, 0.05)
        bus.publish("gps/to_edge", Float64(data=to_edge))
        bus.publish("truck/speed", Float64(data=self.speed))
        now = self.steps * DT
        if self.release_at is not None and self.place > self.release_at and self.released_at is None:
            self.released_at = self.place
        lost = self.shaded and self.gap[0] <= now < self.gap[1]
        if self.steps % 2 == 0 and self.released_at is None and not lost:
            bus.publish("supervisor/heartbeat", Empty())

    def advance(self, command, brake, tip):
        """Drive for one step."""
        self.steps += 1
        if brake and brake.data:
            self.speed = max(0.0, self.speed - 2.8 * DT)
        elif command:
            wanted = max(0.0, min(9.0, command.twist.linear.x))
            self.speed += max(-2.0 * DT, min(1.6 * DT, wanted - self.speed))
        self.gained = self.speed * DT
        self.place += self.gained
        self.tipped = bool(tip and tip.data)
        self.stopped = self.released_at is not None and self.speed < 0.05

    def judge(self):
        """Return the reward of the step: progress, and the full reward for a required stop."""
        if self.place > self.length:
            self.failure = "over the edge"
        elif self.released_at is not None and self.place - self.released_at > STOP_WAY:
            self.failure = "does not stop"
        elif self.released_at is None and self.speed < 0.01 and 2.0 < self.place < self.length - 8.0:
            self.failure = "stopped on the road"
        elif self.steps * DT > TIME_BOUND:
            self.failure = "late"
        if self.failure:
            return -6.0
        if self.stopped:
            return 10.0 - 8.0 * self.place / self.length
        return 8.0 * self.gained / self.length + 2.0 * self.tipped


@pytest.mark.tarl(
    nodes=["haul_truck.py"],
    sensors=[
        Sensor("rock_face", topic="map/rock_face", field="data"),
        Sensor("to_edge", topic="gps/to_edge", field="data", low=0, high=90, bins=6, unit="m"),
        Sensor("speed", topic="truck/speed", field="data", low=0, high=8, bins=3, unit="m/s"),
    ],
    drifts={"shaded radio": 0.18},
    episodes=100,
    min_success=0.95,
)
def test_hauls(tarl, tarl_drift):
    """Haul one load."""
    road = Road(tarl.rng("road"), tarl_drift or 0.0)
    tarl.start("haul_truck.py")
    while not road.done:
        road.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        road.advance(latest("truck/cmd"), latest("relay/brake"), latest("truck/tip"))
        tarl.reward(road.judge())
    assert not road.failure, road.failure
