"""A prosthetic hand follows two muscles. Under a sweaty liner, both signals are weaker."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")

DT = 0.05
SWEAT = 0.45  # share of the amplitudes that remains
CYCLE = 90  # number of steps from one grip to the next
CYCLES = 2


class Forearm:
    """A wearer who grips an object, holds it and lets go; `share` is what the liner leaves of the signals."""

    def __init__(self, rng, share):
        self.rng = rng
        self.share = share
        self.flex, self.extend = rng.uniform(0.62, 0.72), rng.uniform(0.55, 0.64)
        self.size = rng.uniform(0.030, 0.055)  # m
        self.aperture, self.force, self.now = 0.09, 0.0, 0
        self.wish, self.gained, self.failure = "rest", 0.0, ""
        self.grip = 8 + int(rng.integers(0, 6))
        self.let_go = self.grip + 44 + int(rng.integers(0, 4))
        self.level = [0.0, 0.0]

    @property
    def done(self):
        """Return whether both grips are over, or one has failed."""
        return bool(self.failure) or self.now >= CYCLES * CYCLE

    def publish(self, bus):
        """Publish the rectified signals of both muscles, and the hand."""
        moment = self.now % CYCLE
        self.wish = "rest"
        if self.grip <= moment < self.grip + 24:
            self.wish = "close"
        elif self.let_go <= moment < self.let_go + 22:
            self.wish = "open"
        flex = {"close": self.flex, "open": 0.20 * self.flex}.get(self.wish, 0.03)
        extend = {"open": self.extend, "close": 0.20 * self.extend}.get(self.wish, 0.03)
        for index, (topic, strength) in enumerate((("emg/flexor", flex), ("emg/extensor", extend))):
            self.level[index] += 0.5 * (strength - self.level[index])
            noise = 1.0 + 0.15 * self.rng.normal()
            bus.publish(topic, Float64(data=self.share * self.level[index] * noise))
        bus.publish("hand/force", Float64(data=self.force + self.rng.normal(0.0, 0.05)))
        bus.publish("hand/aperture", Float64(data=self.aperture + self.rng.normal(0.0, 0.0003)))
        if self.now % 40 == 0:
            bus.publish("hand/battery", Float64(data=7.6 + self.rng.normal(0.0, 0.05)))

    def advance(self, command):
        """Move the fingers for one step; the wearer is content where the hand does what was wished."""
        self.now += 1
        self.aperture = min(0.09, self.aperture + DT * (command.data if command else 0.0))
        squeezed = max(0.0, self.size - self.aperture)
        self.force = 2500.0 * squeezed
        moment = self.now % CYCLE
        holding = self.force > 3.0
        self.gained = -0.01
        if self.grip + 6 < moment < self.let_go:
            self.gained = 0.05 if holding else -0.05
        elif moment > self.let_go + 6:
            self.gained = 0.05 if self.aperture > self.size + 0.005 else -0.05
        if self.force > 25.0:
            self.failure = "object crushed"
        elif moment == self.grip + 34 and not holding:
            self.failure = "object not gripped"
        elif moment == self.let_go + 30 and self.aperture < self.size + 0.02:
            self.failure = "object not let go"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["emg_hand.py"],
    sensors=[
        Sensor("flexor", topic="emg/flexor", field="data", low=0.0, high=0.8, bins=4),
        Sensor("extensor", topic="emg/extensor", field="data", low=0.0, high=0.8, bins=4),
        Sensor("force", topic="hand/force", field="data", low=0.0, high=12.0, bins=3, unit="N"),
    ],
    drifts={"sweaty liner": SWEAT},
    episodes=200,
    min_success=0.97,
)
def test_grips(tarl, tarl_drift):
    """Grip an object and let go, twice."""
    arm = Forearm(tarl.rng("forearm"), tarl_drift or 1.0)
    tarl.start("emg_hand.py")
    while not arm.done:
        arm.publish(tarl.bus)
        tarl.step(DT)
        arm.advance(tarl.bus.latest("hand/speed"))
        tarl.reward(arm.gained)
    assert not arm.failure, arm.failure
