"""A refuse lorry lifts bins. Wet bins are slippery, and one in a few dozen slips out of the clamp."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
GRAVITY = 9.81
BINS = 3
TIPS_AFTER = 10  # steps
GAP = 4  # steps
CRACKS_AT = 2.1  # multiple of the force that just holds the bin on dry pads
DRY = 0.62
TIME_BOUND = 70.0


class Kerb:
    """Bins of different masses whose surfaces have different friction, and an arm with two pads."""

    def __init__(self, rng, rain):
        self.rng = rng
        self.rain = rain * rng.uniform(0.85, 1.15)
        self.masses = rng.uniform(12.0, 70.0, BINS)
        wet = min(1.0, self.rain / 6.0)
        self.frictions = DRY * (1.0 - 0.128 * wet) * rng.uniform(1.0 - 0.09, 1.0 + 0.09, BINS)
        self.at, self.height, self.tipping, self.gap = 0, 0.0, 0, GAP
        self.tipped, self.emptied = False, False
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all bins are emptied, or the episode has failed."""
        return self.at == BINS or bool(self.failure)

    def publish(self, bus):
        """Publish the bin, its mass, the arm's height and the rain gauge."""
        here = self.at < BINS and self.gap == 0
        bus.publish("weather/rain", Float32(data=max(0.0, self.rain + self.rng.normal(0.0, 0.05))))
        bus.publish("bin/present", Bool(data=here))
        bus.publish(
            "bin/scale", Float32(data=self.masses[min(self.at, BINS - 1)] + self.rng.normal(0.0, 0.05))
        )
        bus.publish("arm/height", Float32(data=self.height))

    def advance(self, force, speed, tip):
        """Squeeze, lift and tip for one step."""
        self.time += DT
        self.emptied = False
        if self.gap:
            self.gap -= 1
            return
        force = force.data if force else 0.0
        weight = self.masses[self.at] * GRAVITY
        self.height = max(0.0, self.height + (speed.data if speed else 0.0) * DT)
        if self.height > 0.0 and 2.0 * self.frictions[self.at] * force < weight:
            self.failure = f"a bin of {self.masses[self.at]:.0f} kg slipped"
        elif force > CRACKS_AT * max(350.0, weight / (2.0 * DRY)):
            self.failure = "a bin is cracked"
        if tip and tip.data and self.height > 2.2:
            self.tipping += 1
            self.tipped = self.tipping >= TIPS_AFTER
        if self.tipped and self.height <= 0.0 and force < 1.0:
            self.emptied = True
            self.at, self.tipping, self.tipped, self.gap = self.at + 1, 0, False, GAP

    def judge(self):
        """Return the reward of the step: each bin is rewarded; a lost bin and time cost."""
        if self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        reward = -0.001 + (3.0 if self.emptied else 0.0)
        return reward - 8.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["bin_lifter.py", "gripping.py"],
    sensors=[
        Sensor("rain", topic="weather/rain", field="data", low=0, high=8, bins=4, unit="mm/h"),
        Sensor("mass", topic="bin/scale", field="data", low=10, high=70, bins=4, unit="kg"),
        Sensor("height", topic="arm/height", field="data", low=0.01, high=2.5, bins=3, unit="m"),
    ],
    drifts={"rain": Drift(7.0)},
    episodes=100,
    min_success=0.95,
)
def test_empties(tarl, tarl_drift):
    """Empty three bins."""
    kerb = Kerb(tarl.rng("kerb"), tarl_drift or 0.0)
    tarl.start("bin_lifter.py")
    while not kerb.done:
        kerb.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        kerb.advance(latest("clamp/force"), latest("arm/speed"), latest("arm/tip"))
        tarl.reward(kerb.judge())
    assert not kerb.failure, kerb.failure
