"""Boards get the ordered film. Cold paint is viscous: the colder it is, the less paint leaves the gun."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float64 = message_type("std_msgs/Float64")

DT = 0.05
STRIP = 0.1  # length of the strips in which boards are measured, m
WRONG = 0.24  # tolerated relative error of the film in a strip
STRIPS = 3  # maximum number of wrong strips
TIME_BOUND = 20.0


class Booth:
    """A board below a gun; `flow` is the flow of paint as a share of that of warm paint."""

    def __init__(self, rng, flow):
        self.rng = rng
        self.temperature = 20.0 - 40.0 * (1.0 - flow) + rng.uniform(-1.0, 1.0)
        self.flow = 12.0 * flow * rng.uniform(0.98, 1.02)
        self.film = rng.uniform(90.0, 150.0)
        self.strips = int(rng.integers(9, 14))
        self.film_on = [0.0] * self.strips
        self.x, self.speed, self.spray = -0.3, 0.0, 0.0
        self.judged, self.wrong = 0, 0
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the whole board is painted and measured."""
        return self.judged == self.strips

    def publish(self, bus):
        """Publish order, position and the temperature in the pot."""
        bus.publish("paint/temperature", Float64(data=self.temperature + self.rng.normal(0.0, 0.2)))
        bus.publish("order/film", Float64(data=self.film))
        bus.publish("order/length", Float64(data=self.strips * STRIP))
        bus.publish("gantry/position", Float64(data=self.x))

    def advance(self, speed, gun):
        """Move and spray for one step."""
        self.speed += ((speed.data if speed else 0.0) - self.speed) * 0.6
        self.spray += ((1.0 if gun and gun.data else 0.0) - self.spray) * 0.5
        for _ in range(5):
            self.x += self.speed * DT / 5
            strip = int(self.x // STRIP)
            if 0 <= strip < self.strips:
                left = self.flow * self.spray * 0.75 * DT / 5 * (1.0 + self.rng.normal(0.0, 0.05))
                self.film_on[strip] += left / (0.30 * STRIP)
        self.time += DT

    def judge(self):
        """Return the reward of the step, for the strips that the gun has just finished."""
        reward = 0.0
        while not self.done and self.x > (self.judged + 1) * STRIP:
            wrong = abs(self.film_on[self.judged] / self.film - 1.0)
            self.wrong += wrong > WRONG
            reward += 10.0 / self.strips * (1.0 - 0.4 * wrong) if wrong <= WRONG else 0.0
            self.judged += 1
        if self.wrong > STRIPS:
            self.failure = "the film is too thin or too thick"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        return reward - 5.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["sprayer.py"],
    sensors=[
        Sensor("temperature", topic="paint/temperature", field="data", low=0, high=24, bins=8, unit="°C"),
        Sensor("film", topic="order/film", field="data", low=90, high=150, bins=4, unit="µm"),
    ],
    drifts={"cold paint": Drift.range(0.56, 0.74)},
    episodes=100,
    min_success=0.95,
)
def test_leaves_the_ordered_film(tarl, tarl_drift):
    """Spray one board."""
    booth = Booth(tarl.rng("booth"), tarl_drift or 1.0)
    tarl.start("sprayer.py")
    while not (booth.done or booth.failure):
        booth.publish(tarl.bus)
        tarl.step(DT)
        booth.advance(tarl.bus.latest("gantry/speed"), tarl.bus.latest("gun/open"))
        tarl.reward(booth.judge())
    assert not booth.failure, booth.failure
