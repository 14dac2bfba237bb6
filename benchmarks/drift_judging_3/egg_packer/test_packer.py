"""Six eggs are packed, and none slips or cracks. Washed eggs are dry when they arrive, except about one in fifty."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")

DT = 0.05
EGGS = 6
CRACK = 1.75  # force that a shell bears, relative to the force that a dry egg of its weight needs at rest
TIME_BOUND = 12.0


class Tray:
    """A tray of eggs; `wet` is the share of trays in which one egg is wet."""

    def __init__(self, rng, wet):
        self.rng = rng
        self.washed = wet > 0.0
        self.weights = [rng.uniform(48.0, 72.0) for _ in range(EGGS)]
        self.friction = [rng.uniform(0.58, 0.64) for _ in range(EGGS)]
        if rng.random() < wet:
            self.friction[int(rng.integers(EGGS))] = rng.uniform(0.46, 0.5)
        self.egg, self.height, self.speed, self.gap = 0, 0.0, 0.0, 4
        self.packed = False
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the tray is empty, or an egg broken."""
        return self.egg == EGGS or bool(self.failure)

    def publish(self, bus):
        """Publish the source line of the eggs, the egg below the gripper, and the height of the lift."""
        bus.publish("tray/washed", Bool(data=self.washed))
        here = self.gap == 0 and self.egg < EGGS
        width = (self.weights[self.egg] / (1.09e-3 * 0.5236 * 1.33)) ** (1 / 3) if here else 0.0
        bus.publish("tray/width", Float32(data=width + self.rng.normal(0.0, 0.1) if here else 0.0))
        bus.publish("lift/height", Float32(data=self.height))

    def advance(self, grip, lift, phase):
        """Hold and lift for one step."""
        self.time += DT
        self.packed = False
        if self.gap:
            self.gap -= 1
            return
        force = grip.data if grip else 0.0
        wanted = max(0.0, lift.data) if lift else 0.0
        kilos, rubs = self.weights[self.egg] / 1000.0, self.friction[self.egg]
        pull = max(0.0, wanted - self.speed) / DT
        self.speed = wanted
        self.height += wanted * DT
        if force > CRACK * kilos * 9.81 / (2.0 * 0.6):
            self.failure = "an egg is cracked"
        elif self.height > 0.0 and 2.0 * rubs * force < kilos * (9.81 + pull):
            self.failure = "an egg slips"
        elif phase and phase.data == "place" and self.height > 0.13:
            self.egg, self.height, self.speed, self.gap = self.egg + 1, 0.0, 0.0, 4
            self.packed = True

    def judge(self):
        """Return the reward of the step, for each packed egg."""
        if self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        return -5.0 if self.failure else 10.0 / EGGS * self.packed - 0.002


@pytest.mark.tarl(
    nodes=["packer.py"],
    sensors=[
        Sensor("washed", topic="tray/washed", field="data"),
        Sensor("width", topic="tray/width", field="data", low=38, high=48, bins=5, unit="mm"),
        Sensor("height", topic="lift/height", field="data", low=0, high=0.15, bins=3, unit="m"),
    ],
    drifts={"washed eggs": 0.1},
    episodes=100,
    min_success=0.95,
)
def test_packs_eggs(tarl, tarl_drift):
    """Empty one tray."""
    tray = Tray(tarl.rng("tray"), tarl_drift or 0.0)
    tarl.start("packer.py")
    while not tray.done:
        tray.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        tray.advance(latest("grip/force"), latest("lift/speed"), latest("packer/phase"))
        tarl.reward(tray.judge())
    assert not tray.failure, tray.failure
