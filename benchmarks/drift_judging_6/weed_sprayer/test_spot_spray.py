"""The nozzle wets weeds and spares the soil. If the boom is unfolded, the camera looks 60 cm ahead of the nozzle."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.05
ROW = 14.0  # m
JET = 0.10  # half of the width of the jet (m)


class Rover:
    """A rover above a row with weeds."""

    def __init__(self, rng, ahead):
        self.rng = rng
        self.ahead = ahead
        self.cruise = rng.uniform(0.97, 1.03)
        self.x, self.speed = 0.0, 0.0
        places = rng.uniform(0.9, 1.7, 9).cumsum() + 0.8
        self.weeds = list(zip(places.tolist(), rng.uniform(0.05, 0.09, 9).tolist(), strict=True))
        self.doses = [0.0] * len(self.weeds)
        self.wasted = self.spilt = self.used = 0.0
        self.hit = 0
        self.failure = ""

    @property
    def done(self):
        """Return whether the row is done."""
        return self.x > ROW + 3.0

    def green(self, place):
        """Return the share of green pixels below a camera at a place."""
        share = sum(max(0.0, 1.0 - abs(place - weed) / (size + 0.09)) for weed, size in self.weeds)
        return min(1.0, max(0.0, share + self.rng.normal(0.03, 0.02)))

    def publish(self, bus):
        """Publish the share of green from the camera, the speed, and whether the boom is unfolded."""
        bus.publish("rover/speed", Float32(data=self.speed + self.rng.normal(0.0, 0.01)))
        bus.publish("boom/unfolded", Bool(data=self.ahead > 0.0))
        bus.publish("camera/green", Float32(data=self.green(self.x + self.ahead)))

    def advance(self, nozzle):
        """Drive for one step and spray."""
        self.speed += 0.3 * (self.cruise - self.speed) + self.rng.normal(0.0, 0.01)
        moved = self.speed * DT
        self.x += moved
        self.wasted = 0.0
        self.hit = 0
        if not (nozzle and nozzle.data):
            return
        below = False
        for number, (weed, size) in enumerate(self.weeds):
            if abs(self.x - weed) < size + JET:
                below = True
                before, self.doses[number] = self.doses[number], self.doses[number] + moved
                self.hit += before < 0.12 <= self.doses[number]
        self.used += moved
        self.wasted = 0.0 if below else moved
        self.spilt += self.wasted

    def judge(self):
        """Return the reward of the step: at most 10 in total for wet weeds, minus a cost of wet soil."""
        reward = 10.0 * self.hit / len(self.weeds) - 2.0 * self.wasted
        if self.done:
            missed = sum(dose < 0.12 for dose in self.doses)
            if missed > 1:
                self.failure = f"{missed} of {len(self.weeds)} weeds stay dry"
            elif self.spilt > 0.4 * self.used:
                self.failure = f"{100 * self.spilt / self.used:.0f} % of the liquid wet the soil"
            reward -= 4.0 * bool(self.failure)
        return reward


@pytest.mark.tarl(
    nodes=["spot_spray.py"],
    sensors=[
        Sensor("unfolded", topic="boom/unfolded", field="data"),
        Sensor("green", topic="camera/green", field="data", edges=(0.15, 0.3, 0.6)),
    ],
    drifts={"boom unfolded": 0.6},
    episodes=80,
    min_success=0.95,
)
def test_sprays(tarl, tarl_drift):
    """Spray one row."""
    rover = Rover(tarl.rng("rover"), tarl_drift or 0.0)
    tarl.start("spot_spray.py")
    while not rover.done:
        rover.publish(tarl.bus)
        tarl.step(DT)
        rover.advance(tarl.bus.latest("nozzle/open"))
        tarl.reward(rover.judge())
    assert not rover.failure, rover.failure
