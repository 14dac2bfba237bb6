"""Four parcels leave the belt at the pusher."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")

DT = 0.05
PUSHER = 1.0  # distance from the gate (m)
REACH = 0.14
NEEDED = 0.035  # impulse needed per kg: share of full force times seconds


class Belt:
    """A belt with a gate at 0 and a pusher; `speed` in m/s."""

    def __init__(self, rng, speed):
        self.rng = rng
        self.speed = speed * rng.uniform(0.98, 1.02)
        self.weights = [float(rng.uniform(1.0, 6.0)) for _ in range(4)]
        self.places = [-0.1]
        for _ in self.weights[1:]:
            self.places.append(self.places[-1] - rng.uniform(0.7, 1.0))
        self.pushed = [0.0] * 4
        self.seen = 0
        self.force = 0.0
        self.sorted = [False] * 4
        self.missed = [False] * 4

    @property
    def over(self):
        """Return whether every parcel is off the belt."""
        return all(done or lost for done, lost in zip(self.sorted, self.missed, strict=True))

    def publish(self, bus):
        """Publish the measurements of the belt's encoder and of the gate."""
        bus.publish("/belt", Float32(data=self.speed + self.rng.normal(0.0, 0.01)))
        if self.seen < 4 and self.places[self.seen] >= 0.0:
            bus.publish("/gate", Float32(data=self.weights[self.seen] + self.rng.normal(0.0, 0.05)))
            self.seen += 1

    def advance(self, command):
        """Let the belt run for one step; the pusher moves the parcel in front of it."""
        force = self.force = max(0.0, min(1.0, command.data)) if command else 0.0
        for i, place in enumerate(self.places):
            if not self.sorted[i] and abs(place - PUSHER) <= REACH:
                self.pushed[i] += force * DT
            self.places[i] += self.speed * DT

    def judge(self):
        """Return the reward of the step: 2.5 for a parcel, -2.5 for a lost one, minus the cost of force."""
        reward = -0.02 * self.force
        for i, weight in enumerate(self.weights):
            if self.sorted[i] or self.missed[i]:
                continue
            if self.pushed[i] >= NEEDED * min(weight, 5.0):
                self.sorted[i] = True
                reward += 2.5
            elif self.places[i] > PUSHER + REACH:
                self.missed[i] = True
                reward -= 2.5
        return reward


@pytest.mark.tarl(
    nodes=["diverter.py"],
    sensors=[
        Sensor("belt", topic="/belt", field="data", low=0.2, high=1.2, bins=10, unit="m/s"),
    ],
    drifts={"faster belt": 0.8},
    episodes=100,
    min_success=0.95,
)
def test_sorts(tarl, tarl_drift):
    """Lose no parcel."""
    belt = Belt(tarl.rng("belt"), tarl_drift or 0.5)
    tarl.start("diverter.py")
    while not belt.over:
        belt.publish(tarl.bus)
        tarl.step(DT)
        belt.advance(tarl.bus.latest("/pusher"))
        tarl.reward(belt.judge())
    assert all(belt.sorted), f"lost {belt.missed.count(True)} parcels"
