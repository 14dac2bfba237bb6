"""A winch belays climbers. On the evenings of the club, they leap for holds and swing back."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/Float64")

DT = 0.05
WALL = 9.0  # m
CLUB = (1.45, 1.75)  # speed at which a climber drops back after a leap (m/s)
BEGINNER = (0.15, 0.35)


class Wall:
    """A climber on a wall with an automatic belay; `drops` are the speeds after a move, in m/s."""

    def __init__(self, rng, drops):
        self.rng = rng
        self.drops = drops
        self.weight = rng.uniform(55.0, 85.0)
        self.pace = rng.uniform(0.55, 0.75)
        self.falls_at = rng.uniform(5.5, 8.5)
        self.height, self.speed, self.slack = 0.0, 0.0, 0.1
        self.state, self.left, self.next_move = "climb", 0, 2.2
        self.fell_from, self.caught, self.time, self.gained, self.failure = 0.0, False, 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the climber is back on the ground, or something has happened."""
        return bool(self.failure) or (self.caught and self.height < 0.3)

    def publish(self, bus):
        """Publish what the winch measures."""
        out = max(0.0, -self.speed) if self.slack < 0.6 else 0.0
        tension = 12.0 if self.slack > 0.05 else 30.0
        if self.state == "hang":
            tension = 9.81 * self.weight
        bus.publish("rope/out_speed", Float64(data=out + self.rng.normal(0.0, 0.06)))
        bus.publish("rope/tension", Float64(data=tension + self.rng.normal(0.0, 2.0)))
        bus.publish("climber/height", Float64(data=self.height + self.rng.normal(0.0, 0.02)))
        if round(self.time / DT) % 100 == 0:
            bus.publish("winch/oil_temperature", Float64(data=41.0 + self.rng.normal(0.0, 1.0)))

    def advance(self, bus):
        """Climb, drop back, fall or hang for one step."""
        brake, winch = bus.latest("winch/brake"), bus.latest("winch/speed")
        locked, speed = bool(brake and brake.data), winch.data if winch else 0.0
        before, self.time = self.height, self.time + DT
        self.gained = -0.005
        getattr(self, "do_" + self.state)(locked, speed)
        self.height = max(0.0, self.height + DT * self.speed)
        if self.state in ("climb", "drop"):
            self.slack = max(0.0, min(1.5, self.slack + DT * (-self.speed - speed)))
            self.gained += 0.5 * max(0.0, self.height - before)
            if locked:
                self.failure = "climber held back by a locked rope"
        if self.height <= 0.0 and self.state == "fall":
            self.failure = "climber hits the ground"
        if self.time > 60.0:
            self.failure = "climber waits for too long"
        self.gained += 4.0 if self.done and not self.failure else 0.0
        self.gained -= 10.0 if self.failure else 0.0

    def do_climb(self, _locked, _speed):
        """Climb; every metre or so ends in a move, after which the body drops back."""
        self.speed = self.pace * (1.0 + 0.1 * self.rng.normal())
        if self.height > self.falls_at:
            self.state, self.fell_from, self.speed = "fall", self.height, 0.0
        elif self.height > self.next_move:
            self.next_move = self.height + self.rng.uniform(1.0, 1.4)
            self.state, self.left = "drop", 4
            self.speed = -self.rng.uniform(*self.drops)

    def do_drop(self, _locked, _speed):
        """Drop back until the arms are straight."""
        self.left -= 1
        if self.left == 0:
            self.state = "climb"

    def do_fall(self, locked, _speed):
        """Fall until the brake holds and the rope has stretched."""
        self.speed -= 9.3 * DT
        if locked:
            deep = self.fell_from - self.height + 0.05 * self.speed**2
            self.state, self.speed, self.caught = "hang", 0.0, True
            self.gained += 3.0 - 0.6 * deep
            if deep > 2.2:
                self.failure = f"climber fell {deep:.1f} m"

    def do_hang(self, locked, speed):
        """Hang in the rope and be lowered."""
        self.speed = 0.0 if locked else min(0.0, speed)


@pytest.mark.tarl(
    nodes=["belay_winch.py"],
    sensors=[
        Sensor("height", topic="climber/height", field="data", low=0.0, high=9.0, bins=4, unit="m"),
        Sensor("out", topic="rope/out_speed", field="data", low=0.0, high=4.0, bins=5, unit="m/s"),
        Sensor("tension", topic="rope/tension", field="data", low=0.0, high=900.0, bins=3, unit="N"),
    ],
    drifts={"club evening": CLUB},
    episodes=200,
    min_success=0.97,
)
def test_belays(tarl, tarl_drift):
    """Belay one climber until a fall, and lower the climber."""
    wall = Wall(tarl.rng("wall"), tarl_drift or BEGINNER)
    tarl.start("belay_winch.py")
    while not wall.done:
        wall.publish(tarl.bus)
        tarl.step(DT)
        wall.advance(tarl.bus)
        tarl.reward(wall.gained)
    assert not wall.failure, wall.failure
