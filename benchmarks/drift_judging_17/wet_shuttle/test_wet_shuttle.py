"""A shuttle stops at three stations. After the floor was hosed down, its wheels slide."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Range = message_type("sensor_msgs/msg/Range")

DT = 0.05
DRY = 3.0  # maximum acceleration that the wheels can transmit (m/s²)
WET = 0.62
LOAD = 2


class Hall:
    """A lane with three stations; `grip` is the most that the wheels brake or push, in m/s²."""

    def __init__(self, rng, grip):
        self.rng = rng
        self.grip = grip * rng.uniform(0.9, 1.1)
        gaps = rng.uniform(4.0, 6.5, 3)
        self.stations = [float(gaps[: i + 1].sum()) for i in range(3)]
        self.place, self.speed, self.time, self.gained, self.failure = 0.0, 0.0, 0.0, 0.0, ""
        self.served, self.loading = 0, 0
        self.person = float(rng.uniform(1.0, 9.0))  # position where someone crosses (m)
        self.waits = 40

    @property
    def done(self):
        """Return whether the third station is served, or something went wrong."""
        return bool(self.failure) or self.served == 3

    def publish(self, bus):
        """Publish the laser and the sonar."""
        left = self.stations[self.served] - self.place
        bus.publish("laser/station", Range(range=left + self.rng.normal(0.0, 0.003)))
        free = 4.0
        if self.waits and 0.0 < self.person + 1.6 - self.place < 1.0:
            free, self.waits = 0.55, self.waits - 1
        bus.publish("sonar/front", Range(range=free + self.rng.normal(0.0, 0.02)))

    def advance(self, cmd, state):
        """Roll or slide for one step."""
        wish = cmd.linear.x if cmd else 0.0
        change = max(-self.grip * DT, min(self.grip * DT, 0.8 * (wish - self.speed)))
        self.speed = max(0.0, self.speed + change)
        self.place += DT * self.speed
        self.time += DT
        self.gained = 0.05 * DT * self.speed - 0.001
        off = self.place - self.stations[self.served]
        loads = state is not None and state.data == LOAD and self.speed < 0.02
        self.loading = self.loading + 1 if loads else 0
        if off > 0.07:
            self.failure = "shuttle slides past a station"
        elif self.loading == 25:
            self.served += 1
            self.gained += 2.0 - 5.0 * abs(off)
        if self.time > 90.0:
            self.failure = "shuttle takes too long"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["wet_shuttle.py"],
    sensors=[
        Sensor("left", topic="laser/station", field="range", low=0.0, high=6.5, bins=5, unit="m"),
        Sensor("free", topic="sonar/front", field="range", low=0.0, high=4.2, bins=3, unit="m"),
    ],
    drifts={"wet floor": WET},
    episodes=200,
    min_success=0.97,
)
def test_serves(tarl, tarl_drift):
    """Serve three stations."""
    hall = Hall(tarl.rng("hall"), tarl_drift or DRY)
    tarl.start("wet_shuttle.py")
    while not hall.done:
        hall.publish(tarl.bus)
        tarl.step(DT)
        hall.advance(tarl.bus.latest("cmd_vel"), tarl.bus.latest("shuttle/state"))
        tarl.reward(hall.gained)
    assert not hall.failure, hall.failure
