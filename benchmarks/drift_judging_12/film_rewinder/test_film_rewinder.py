"""A brake keeps film tight. The powder of the brake is worn and it brakes less, for good."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Range = message_type("sensor_msgs/msg/Range")

DT = 0.1
STEPS = 250
WANTED = 80.0  # N
LOOSE, TIGHT = 66.0, 100.0  # mean tension over half a second (N)
THICKNESS = 0.0012  # thickness of a coarse foamed film (m)
SETTLED = 6.0  # s


class Line:
    """Film from a braked roll over a dancer; `brake` is the torque of the brake in Nm per A."""

    def __init__(self, rng, brake):
        self.rng = rng
        self.brake = brake * rng.uniform(0.98, 1.02)
        self.radius = rng.uniform(0.33, 0.38)
        self.current = 0.25
        self.speed = 0.0
        self.pace = rng.uniform(1.8, 2.2)
        self.tension = WANTED
        self.felt = WANTED
        self.dancer = 0.5
        self.step = 0
        self.outside = 0
        self.failure = ""

    @property
    def done(self):
        """Return whether the film has been rewound."""
        return bool(self.failure) or self.step >= STEPS

    def publish(self, bus):
        """Publish the roll's distance, the dancer and the speed of the line."""
        bus.publish("roll/range", Range(range=0.60 - self.radius + self.rng.normal(0.0, 0.002)))
        bus.publish("dancer/position", Float32(data=self.dancer + self.rng.normal(0.0, 0.004)))
        bus.publish("line/speed", Float32(data=self.speed))

    def advance(self, cmd):
        """Rewind for one step."""
        wanted = cmd.data if cmd else 0.0
        self.current += (wanted - self.current) * 0.4
        before = self.speed
        self.speed = min(self.pace, self.speed + 0.5 * DT)
        gains = (self.speed - before) / DT
        inertia = 26.0 * self.radius * gains * (self.radius / 0.36) ** 2
        torque = self.brake * self.current + 0.4 + inertia + self.rng.normal(0.0, 0.3)
        self.tension = max(0.0, torque / self.radius)
        self.felt += 0.2 * (self.tension - self.felt)
        self.dancer += 0.3 * (0.5 + (self.felt - WANTED) / 100.0 - self.dancer)
        self.dancer = max(0.0, min(1.0, self.dancer))
        self.radius -= THICKNESS * self.speed * DT / (2 * math.pi * self.radius)
        self.step += 1
        if self.step * DT > SETTLED:
            self.outside += not LOOSE < self.felt < TIGHT
        if self.outside > 20:
            self.failure = "the film wrinkles" if self.felt < WANTED else "the film stretches"

    def judge(self):
        """Return the reward of the step: film that is wound with the right tension."""
        if self.step * DT <= SETTLED:
            return 0.0
        good = 1.0 - abs(self.felt - WANTED) / 80.0
        return 10.0 / (STEPS - SETTLED / DT) * good - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["roll_gauge.py", "brake_control.py"],
    sensors=[
        Sensor("dancer", topic="dancer/position", field="data", low=0.0, high=1.0, bins=6),
        Sensor("range", topic="roll/range", field="range", low=0.2, high=0.5, bins=3, unit="m"),
    ],
    drifts={"worn brake": Drift(8.6, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_rewinds(tarl, tarl_drift):
    """Rewind for half a minute."""
    line = Line(tarl.rng("line"), tarl_drift or 14.0)
    tarl.start("roll_gauge.py")
    tarl.start("brake_control.py")
    while not line.done:
        line.publish(tarl.bus)
        tarl.step(DT)
        line.advance(tarl.bus.latest("brake/current"))
        tarl.reward(line.judge())
    assert not line.failure, line.failure
