"""Pallets are wrapped in film. Recycled film tears earlier, and more layers have to hold the load with less tension."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
String = message_type("std_msgs/String")

DT = 0.1
FULL_BRAKE = 500.0  # N
HOLDS = 900.0  # total force of all layers that is needed to hold the load (N)
FILM = 15.5  # maximum number of turns of film per pallet
TIME_BOUND = 120.0


class Turntable:
    """A load that is held by layers of film, and a film that tears at a certain force."""

    def __init__(self, rng, tears_at):
        self.rng = rng
        self.film = "virgin" if tears_at > 160.0 else "recycled"
        self.tears_at = tears_at * rng.uniform(0.97, 1.03)
        self.sticky = rng.uniform(0.92, 1.08)
        self.turns, self.pull, self.height = 0.0, 0.0, 0.0
        self.holding = 0.0
        self.gained = 0.0
        self.wrapped = False
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the film is cut or the episode has failed."""
        return self.wrapped or bool(self.failure)

    def publish(self, bus):
        """Publish the turns, the tension, the carriage and the label of the roll."""
        bus.publish("film/roll", String(data=self.film))
        bus.publish("pallet/present", Bool(data=True))
        bus.publish("table/turns", Float32(data=self.turns))
        bus.publish("film/tension", Float32(data=self.pull + self.rng.normal(0.0, 2.0)))
        bus.publish("carriage/height", Float32(data=self.height))

    def advance(self, table, brake, carriage, cut):
        """Turn, stretch and lift for one step."""
        self.time += DT
        turned = max(0.0, table.data if table else 0.0) * DT
        wanted = self.sticky * FULL_BRAKE * (brake.data if brake else 0.0) if turned else 0.0
        self.pull += 0.35 * (wanted - self.pull)
        self.turns += turned
        self.height = max(0.0, min(1.7, self.height + (carriage.data if carriage else 0.0) * DT))
        self.gained = self.pull * turned
        self.holding += self.gained
        self.wrapped = bool(cut and cut.data)

    def judge(self):
        """Return the reward of the step: the holding force is rewarded up to the needed force, and time costs."""
        useful = min(self.gained, max(0.0, HOLDS - self.holding + self.gained))
        reward = 7.0 * useful / HOLDS - 0.0005
        if self.pull > self.tears_at:
            self.failure = f"the film tore at {self.pull:.0f} N"
        elif self.turns > FILM:
            self.failure = "too much film"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        elif self.wrapped and self.holding < HOLDS:
            self.failure = f"{self.holding:.0f} N do not hold the load"
        elif self.wrapped:
            reward += 3.0
        return reward - 3.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["pallet_wrapper.py"],
    sensors=[
        Sensor("film", topic="film/roll", field="data", categories=("virgin", "recycled")),
        Sensor("turns", topic="table/turns", field="data", low=0, high=14, bins=7),
        Sensor("tension", topic="film/tension", field="data", low=0, high=200, bins=5, unit="N"),
    ],
    drifts={"recycled film": Drift(118.0)},
    episodes=100,
    min_success=0.95,
)
def test_wraps(tarl, tarl_drift):
    """Wrap one pallet."""
    table = Turntable(tarl.rng("table"), tarl_drift or 210.0)
    tarl.start("pallet_wrapper.py")
    while not table.done:
        table.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        table.advance(
            latest("table/speed"), latest("film/brake"), latest("carriage/speed"), latest("film/cut")
        )
        tarl.reward(table.judge())
    assert not table.failure, table.failure
