"""The level stays near its set point. No repair is possible for a leak that exceeds the flow of the pump."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")

DT = 0.5
DURATION = 50.0


class Tank:
    """A tank of 1 m²; `leak` in m/s at 1.5 m of water."""

    def __init__(self, rng, leak):
        self.rng = rng
        self.leak = leak
        self.use = rng.uniform(0.010, 0.014)
        self.level = rng.uniform(1.4, 1.55)
        self.time = 0.0
        self.failure = ""

    def publish(self, bus):
        """Publish the measurements of float and flow meter."""
        bus.publish("/outflow", Float32(data=self.use + self.rng.normal(0.0, 0.0005)))
        bus.publish("/level", Float32(data=self.level + self.rng.normal(0.0, 0.005)))

    def advance(self, command):
        """Pump for one step."""
        power = max(0.0, min(1.0, command.data)) if command else 0.0
        self.level += (0.05 * power - self.use - self.leak * self.level / 1.5) * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step."""
        off = abs(self.level - 1.5)
        if off > 0.5:
            self.failure = "ran dry" if self.level < 1.5 else "ran over"
            return -5.0
        return 0.1 - 0.2 * off**2


@pytest.mark.tarl(
    nodes=["filler.py"],
    sensors=[
        Sensor("level", topic="/level", field="data", low=0.8, high=1.8, bins=10, unit="m"),
        Sensor("outflow", topic="/outflow", field="data", low=0.0, high=0.03, bins=3, unit="m³/s"),
    ],
    drifts={"cracked wall": 0.075},
    episodes=100,
    min_success=0.95,
)
def test_keeps_the_level(tarl, tarl_drift):
    """Neither run dry nor overflow."""
    tank = Tank(tarl.rng("tank"), tarl_drift or 0.0)
    tarl.start("filler.py")
    while tank.time < DURATION and not tank.failure:
        tank.publish(tarl.bus)
        tarl.step(DT)
        tank.advance(tarl.bus.latest("/pump"))
        tarl.reward(tank.judge())
    assert not tank.failure, tank.failure
