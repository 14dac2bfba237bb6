"""donkey_car's obstacle_avoid_sonar.py steers round a pillar. Worn front tyres turn the car less."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Range = message_type("sensor_msgs/Range")

NODE = "donkey_car/src/obstacle_avoid_sonar.py"
DT = 0.2
PILLAR = 0.2  # its radius, m
CAR = 0.1
CONE = 0.45  # half of a sonar's field of view, rad
GOAL = 5.0
TIME_BOUND = 25.0
SONARS = (("/dkcar/sonar/0", 0.7, -0.5), ("/dkcar/sonar/1", 0.0, 0.0), ("/dkcar/sonar/2", -0.7, 0.5))


class Path:
    """A pillar in the way; `grip` is the turn rate of the car as a share of that on new tyres."""

    def __init__(self, rng, grip):
        self.rng = rng
        self.grip = grip
        self.pillar = (rng.uniform(2.4, 3.2), rng.uniform(-0.1, 0.1))
        self.x, self.y, self.heading = 0.0, rng.uniform(-0.05, 0.05), rng.uniform(-0.03, 0.03)
        self.speed, self.turn = 0.0, 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def past(self):
        """Return whether the car has reached the end of the course."""
        return self.x >= GOAL

    @property
    def gap(self):
        """Return the distance to the surface of the pillar, m."""
        return math.hypot(self.pillar[0] - self.x, self.pillar[1] - self.y) - PILLAR

    def publish(self, bus):
        """Publish what three sonars measure; the node distinguishes them by the sign of their field of view."""
        bearing = math.atan2(self.pillar[1] - self.y, self.pillar[0] - self.x) - self.heading
        for topic, angle, view in SONARS:
            heard = self.gap if abs(bearing - angle) < CONE else 3.0
            heard = max(0.02, min(3.0, heard + self.rng.normal(0.0, 0.01)))
            bus.publish(topic, Range(field_of_view=view, max_range=3.0, range=heard))

    def advance(self, cmd):
        """Drive for one step."""
        speed, steer = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        self.speed += (0.5 * speed - self.speed) * 0.5
        self.turn += (self.grip * steer - self.turn) * 0.7
        self.heading += self.turn * 0.8 * DT
        self.moved = self.speed * math.cos(self.heading) * DT
        self.x += self.moved
        self.y += self.speed * math.sin(self.heading) * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step."""
        if self.gap < CAR:
            self.failure = "hit the pillar"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        elif abs(self.y) > 5.0:
            self.failure = "left the path"
        return -10.0 if self.failure else 10.0 * self.moved / GOAL


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[Sensor("ahead", topic="/dkcar/sonar/1", field="range", low=0, high=3, bins=6, unit="m")],
    drifts={"worn tyres": Drift(0.25, permanent=True)},
    episodes=60,
    min_success=0.95,
)
def test_passes_the_pillar(tarl, tarl_drift):
    """Get past."""
    path = Path(tarl.rng("path"), tarl_drift or 1.0)
    tarl.start(NODE)
    while not (path.past or path.failure):
        path.publish(tarl.bus)
        tarl.step(DT)
        path.advance(tarl.bus.latest("/dkcar/control/cmd_vel"))
        tarl.reward(path.judge())
    assert path.past, path.failure
