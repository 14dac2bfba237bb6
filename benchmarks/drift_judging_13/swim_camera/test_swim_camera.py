"""A camera beside a pool follows a swimmer. A new detector needs more time, so the camera stays behind."""

import math
from collections import deque
from pathlib import Path

import pytest
import yaml

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

JointState = message_type("sensor_msgs/msg/JointState")
PointStamped = message_type("geometry_msgs/msg/PointStamped")

DT = 0.1
POOL = 25.0
STEPS = 280
FRAME = 0.70  # distance from the middle of the picture to its edge (m)
MISSED = 6.0  # s
OLD, NEW = 0.12, 0.62  # s


class Race:
    """A swimmer who turns once, and a trolley on a rail; `delay` is that of the detector in s."""

    def __init__(self, rng, delay):
        self.rng = rng
        self.steady = rng.uniform(1.65, 1.85)
        self.strokes = rng.uniform(0.12, 0.22), rng.uniform(5.6, 7.0), rng.uniform(0.0, 6.28)
        self.x, self.way = 2.0, 1.0
        self.turning = 0.0
        self.trolley, self.speed = 2.0, 0.0
        self.delay = delay * rng.uniform(0.95, 1.05)
        self.past = deque([2.0] * 12, maxlen=12)
        self.step, self.outside, self.gained = 0, 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the race or the broadcast is over."""
        return bool(self.failure) or self.step >= STEPS

    def publish(self, bus):
        """Publish where the detector has seen the swimmer, and the trolley."""
        behind = self.delay / DT
        whole = int(behind)
        later, earlier = self.past[-1 - whole], self.past[-2 - whole]
        seen = PointStamped()
        seen.point.x = later + (behind - whole) * (earlier - later) + self.rng.normal(0.0, 0.03)
        bus.publish("swimmer", seen)
        state = JointState(name=["trolley"], position=[self.trolley + self.rng.normal(0.0, 0.003)])
        bus.publish("trolley/state", state)

    def advance(self, command):
        """Swim and drive for one step."""
        size, rate, phase = self.strokes
        if self.turning > 0.0:
            self.turning -= DT
            swum = 0.2
        else:
            swum = self.steady + size * math.sin(rate * self.step * DT + phase)
        self.x += self.way * swum * DT
        if self.x > POOL - 0.4 and self.way > 0.0:
            self.way, self.turning = -1.0, 0.6
        self.past.append(self.x)
        wanted = command.data if command else 0.0
        self.speed += (wanted - self.speed) * (1.0 - math.exp(-DT / 0.2))
        self.trolley = min(max(self.trolley + self.speed * DT, 0.0), POOL)
        self.step += 1
        off = abs(self.x - self.trolley) / FRAME
        self.outside += DT if off > 1.0 else 0.0
        self.gained = 10.0 / STEPS * max(-0.5, 1.0 - 0.6 * off**2)

    def judge(self):
        """Return the reward of the step: the swimmer in the picture."""
        if self.outside > MISSED:
            self.failure = "the director switches to another camera"
        return self.gained - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["swim_camera.py", "alpha_beta.py"],
    sensors=[
        Sensor("swimmer", topic="swimmer", field="point.x", low=0.0, high=25.0, bins=6, unit="m"),
        Sensor(
            "trolley", topic="trolley/state", field=lambda msg: msg.position[0], low=0.0, high=25.0, bins=6
        ),
    ],
    drifts={"new detector": Drift(NEW, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_follows(tarl, tarl_drift):
    """Broadcast one race."""
    race = Race(tarl.rng("race"), tarl_drift or OLD)
    config = yaml.safe_load(Path(__file__).with_name("config.yaml").read_text())
    tarl.start("swim_camera.py", parameters=config["swim_camera"]["ros__parameters"])
    while not race.done:
        race.publish(tarl.bus)
        tarl.step(DT)
        race.advance(tarl.bus.latest("trolley/speed"))
        tarl.reward(race.judge())
    assert not race.failure, race.failure
