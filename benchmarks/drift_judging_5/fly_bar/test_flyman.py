"""A fly bar is lowered to the marks of two scenes. The drum is permanently replaced by one with more rope per turn."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/Float64")
String = message_type("std_msgs/String")

DT = 0.1
LAG = 0.15  # lag of the motor (s)
MARKS = {"forest": 5.6, "castle": 4.4, "moon": 2.5, "storm": 3.5}
NEAR = 0.14  # tolerated distance from a mark; a larger one is visible from the stalls (m)
FLOOR = 6.9
TIME_BOUND = 40.0


class Tower:
    """A stage tower whose drum gives `rope` metres per turn."""

    def __init__(self, rng, rope):
        self.rng = rng
        self.rope = rope * rng.uniform(0.995, 1.005)
        self.droop = rng.uniform(0.96, 1.0)  # share of speed left under load
        self.scenes = [str(name) for name in rng.permutation(list(MARKS))[:2]]
        self.turns, self.speed = 0.0, 0.0
        self.played = 0
        self.time = 0.0
        self.failure = ""

    @property
    def depth(self):
        """Return how far the bar hangs below the grid, in metres."""
        return self.turns * self.rope

    @property
    def done(self):
        """Return whether both scenes have been played, or the episode has failed."""
        return self.played == 2 or bool(self.failure)

    def publish(self, bus):
        """Publish the cue and the encoder."""
        bus.publish("prompter/cue", String(data=self.scenes[self.played]))
        bus.publish("bar/turns", Float64(data=self.turns))

    def advance(self, motor, there):
        """Turn the drum for one step; return the reward."""
        wanted = max(-1.5, min(1.5, motor.data)) * self.droop if motor else 0.0
        self.speed += (wanted - self.speed) * DT / (LAG + DT)
        self.turns += self.speed * DT
        self.time += DT
        scene = self.scenes[self.played]
        if self.depth > FLOOR:
            self.failure = "the backdrop folds on the floor"
        elif self.time > TIME_BOUND:
            self.failure = "the scene waits"
        elif there and there.data == scene and abs(self.speed) < 0.05:
            off = abs(self.depth - MARKS[scene])
            if off > NEAR:
                self.failure = f"{scene} hangs {off:.2f} m off its mark"
            else:
                self.played += 1
                return 5.0 - 4.0 * off
        return -3.0 if self.failure else -0.003


@pytest.mark.tarl(
    nodes=["flyman.py", "drum.py"],
    sensors=[
        Sensor("turns", topic="bar/turns", field="data", low=0, high=8, bins=4),
        Sensor("cue", topic="prompter/cue", field="data", categories=tuple(MARKS)),
    ],
    drifts={"other drum": Drift(0.92, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_plays(tarl, tarl_drift):
    """Hang two backdrops."""
    tower = Tower(tarl.rng("tower"), tarl_drift or 0.80)
    tarl.start("flyman.py")
    while not tower.done:
        tower.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(tower.advance(tarl.bus.latest("bar/motor"), tarl.bus.latest("bar/there")))
    assert not tower.failure, tower.failure
