"""A hydroponic tank keeps its pH. Well water holds more carbonate than rain water and needs more acid."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")

DT = 2.0
STEPS = 750  # 25 minutes
RAIN = 30.0  # acid per unit of pH (ml)
SETTLED = 450


class Tank:
    """A tank of nutrient solution; `buffer` is how much acid a unit of pH takes, in ml."""

    def __init__(self, rng, buffer):
        self.rng = rng
        self.buffer = buffer * rng.uniform(0.97, 1.03)
        self.rise = 0.0007 * rng.uniform(0.9, 1.1)  # rise of the pH per second, caused by roots and air
        self.rise *= (buffer / RAIN) ** 0.5
        self.ph, self.ec = rng.uniform(6.8, 7.1), 0.75 + 0.0125 * buffer
        self.mixed, self.now, self.off, self.gained = 0.0, 0, 0, 0.0

    def publish(self, bus):
        """Publish the pH and the conductivity."""
        bus.publish("tank/ph", Float32(data=self.ph + self.rng.normal(0.0, 0.015)))
        bus.publish("tank/ec", Float32(data=self.ec + self.rng.normal(0.0, 0.03)))

    def advance(self, command):
        """Stir for one step; acid mixes within half a minute."""
        self.mixed += DT * (command.data if command else 0.0)
        share = 1.0 - 0.86
        self.ph += DT * self.rise - share * self.mixed / self.buffer
        self.mixed *= 1.0 - share
        self.now += 1
        self.gained = 0.0
        if self.now > SETTLED:
            error = abs(self.ph - 5.9)
            self.off += error > 0.22
            self.gained = 0.04 * (1.0 - min(2.0, 4.0 * max(0.0, error - 0.12)))


@pytest.mark.tarl(
    nodes=["ph_balancer.py"],
    sensors=[
        Sensor("ph", topic="tank/ph", field="data", low=5.0, high=7.4, bins=6),
        Sensor("ec", topic="tank/ec", field="data", low=0.6, high=3.0, bins=4, unit="mS/cm"),
    ],
    drifts={"well water": Drift.range(95.0, 115.0)},
    episodes=200,
    min_success=0.97,
)
def test_balances(tarl, tarl_drift):
    """Bring fresh solution to its pH and keep it there."""
    tank = Tank(tarl.rng("tank"), RAIN if tarl_drift is None else tarl_drift)
    tarl.start("ph_balancer.py")
    for _ in range(STEPS):
        tank.publish(tarl.bus)
        tarl.step(DT)
        tank.advance(tarl.bus.latest("acid_pump/flow"))
        tarl.reward(tank.gained)
    assert tank.off <= 20, f"pH away from 5.9 for {DT * tank.off:.0f} s"
