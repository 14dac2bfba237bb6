"""Exposures of a night stay sharp while the tube cools. An aluminium tube shrinks more than a steel tube."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")
String = message_type("std_msgs/String")

DT = 120.0  # duration of an exposure (s)
EXPOSURES = 90
SHARP = 42.0  # steps
SLACK = 30.0  # backlash (steps)
OFFSETS = {"L": 0.0, "R": 34.0, "G": 21.0, "B": 47.0, "Ha": 88.0}


class Night:
    """A telescope whose focus moves by about `shrink` steps per kelvin."""

    def __init__(self, rng, shrink):
        self.rng = rng
        self.tube = "steel" if shrink < 35.0 else "aluminium"
        self.shrink = shrink * rng.uniform(0.97, 1.03)
        self.dusk = self.temperature = rng.uniform(12.0, 18.0)
        self.cooling = rng.uniform(6.5, 9.0)  # fall of the temperature until dawn (K)
        self.base = int(rng.uniform(9000.0, 9800.0))
        self.wheel = [str(name) for name in rng.permutation(list(OFFSETS))]
        self.filter = "L"
        self.draw_tube = float(self.base)
        self.taken, self.blurred = 0, 0

    @property
    def done(self):
        """Return whether it is dawn."""
        return self.taken >= EXPOSURES

    def publish(self, bus):
        """Publish the tube, the autofocus result at dusk, the filter and the temperature."""
        self.filter = self.wheel[self.taken * len(self.wheel) // EXPOSURES]
        bus.publish("telescope/tube", String(data=self.tube))
        bus.publish("wheel/filter", String(data=self.filter))
        bus.publish("tube/temperature", Float32(data=self.temperature + self.rng.normal(0.0, 0.1)))
        bus.publish("autofocus/best", Int32(data=self.base))

    def move(self, msg):
        """Turn the focuser; its gear has slack."""
        self.draw_tube = (
            max(self.draw_tube, msg.data)
            if msg.data > self.draw_tube
            else min(self.draw_tube, msg.data + SLACK)
        )

    def advance(self):
        """Expose while the air cools, at first fast, and slower towards dawn."""
        share = self.taken / EXPOSURES
        self.taken += 1
        self.temperature = self.dusk - self.cooling * share * (1.6 - 0.6 * share)

    def judge(self):
        """Return the reward of an exposure: 0.11 in focus, less out of focus."""
        best = self.base + self.shrink * (self.dusk - self.temperature) + OFFSETS[self.filter]
        off = abs(self.draw_tube - best)
        self.blurred += off > SHARP
        return 10.0 / EXPOSURES * (1.0 - 0.5 * (off / SHARP) ** 2 if off <= SHARP else -0.3)


@pytest.mark.tarl(
    nodes=["focuser.py"],
    sensors=[
        Sensor("tube", topic="telescope/tube", field="data", categories=("steel", "aluminium")),
        Sensor("temperature", topic="tube/temperature", field="data", low=2, high=18, bins=8, unit="°C"),
        Sensor("filter", topic="wheel/filter", field="data", categories=("L", "R", "G", "B", "Ha")),
    ],
    drifts={"aluminium tube": 50.0},
    episodes=100,
    min_success=0.95,
)
def test_stays_in_focus(tarl, tarl_drift):
    """Observe one night."""
    night = Night(tarl.rng("night"), tarl_drift or 26.0)
    tarl.bus.subscribe("focuser/move_to", night.move)
    tarl.start("focuser.py")
    while not night.done:
        night.publish(tarl.bus)
        tarl.step(DT)
        night.advance()
        tarl.reward(night.judge())
    assert night.blurred <= 0.1 * EXPOSURES, f"{night.blurred} of {EXPOSURES} exposures are blurred"
