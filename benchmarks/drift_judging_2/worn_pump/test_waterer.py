"""Every pot gets its dose. The worn pump permanently delivers less, and there is no flow meter."""

from pathlib import Path

import pytest
import yaml

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float64 = message_type("std_msgs/msg/Float64")
Float64MultiArray = message_type("std_msgs/msg/Float64MultiArray")

DT = 0.1
POTS = 3
NEW_PUMP = 22.0  # ml/s
WRONG = 0.2  # tolerated relative error of a dose
TIME_BOUND = 45.0


class Greenhouse:
    """A row of pots; `wear` is the pump's flow as a share of a new pump's."""

    def __init__(self, rng, wear):
        self.rng = rng
        self.flow = NEW_PUMP * wear * rng.uniform(0.97, 1.03)
        self.pots = [0.5 + 0.6 * i + rng.uniform(-0.1, 0.1) for i in range(POTS)]
        self.doses = [rng.uniform(40.0, 70.0) for _ in range(POTS)]
        self.given = [0.0] * POTS
        self.x, self.speed, self.hose = 0.0, 0.0, 0.0
        self.judged = 0
        self.time = 0.0
        self.done = False
        self.failure = ""

    def publish(self, bus):
        """Publish the job and the rail's encoder."""
        if self.time == 0.0:
            bus.publish("rail/position", Float64(data=0.0))
            bus.publish("job/pots", Float64MultiArray(data=self.pots))
            bus.publish("job/doses", Float64MultiArray(data=self.doses))
        bus.publish("rail/position", Float64(data=self.x + self.rng.normal(0.0, 0.002)))

    def advance(self, bus):
        """Run cart and pump for one step; the hose has to fill first."""
        speed, pump = bus.latest("rail/speed"), bus.latest("pump")
        self.speed += ((speed.data if speed else 0.0) - self.speed) * 0.8
        self.x += self.speed * DT
        pumping = bool(pump and pump.data)
        self.hose = min(0.3, self.hose + DT) if pumping else 0.0
        if pumping and self.hose >= 0.3:
            for i, pot in enumerate(self.pots):
                if abs(self.x - pot) < 0.1:
                    self.given[i] += self.flow * DT
        done = bus.latest("job/done")
        self.done = bool(done and done.data)
        self.time += DT

    def judge(self):
        """Return the reward of the step, for each pot that the cart has just left."""
        reward = 0.0
        while self.judged < POTS and (self.done or self.x > self.pots[self.judged] + 0.15):
            wrong = abs(self.given[self.judged] / self.doses[self.judged] - 1.0)
            if wrong > WRONG:
                self.failure = f"pot {self.judged} got {self.given[self.judged]:.0f} ml"
            reward += 3.5 - 2.0 * wrong if wrong <= WRONG else -1.0
            self.judged += 1
        if self.time > TIME_BOUND and not self.done:
            self.failure, self.done = "late", True
            reward -= 5.0
        return reward - 0.002


@pytest.mark.tarl(
    nodes=["waterer.py"],
    sensors=[
        Sensor("position", topic="rail/position", field="data", low=0, high=2, bins=6, unit="m"),
        Sensor("first_dose", topic="job/doses", field="data.0", low=40, high=70, bins=3, unit="ml"),
    ],
    drifts={"worn pump": Drift(0.7, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_waters_every_pot(tarl, tarl_drift):
    """Water one row."""
    house = Greenhouse(tarl.rng("greenhouse"), tarl_drift or 1.0)
    config = yaml.safe_load(Path(__file__).with_name("waterer.yaml").read_text())
    tarl.start("waterer.py", parameters=config["waterer"]["ros__parameters"])
    while not house.done:
        house.publish(tarl.bus)
        tarl.step(DT)
        house.advance(tarl.bus)
        tarl.reward(house.judge())
    assert not house.failure, house.failure
