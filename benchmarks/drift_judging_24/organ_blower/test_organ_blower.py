"""A fan blows an organ. In dry winters its chests crack, each time by another amount, and lose wind."""

from collections import deque

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")

DT = 0.1
SUMMER = {"cracks": 0.0}
WINTER = {"cracks": 1.0}


class Organ:
    """An organ whose chests have `cracks`."""

    def __init__(self, rng, cracks):
        self.rng = rng
        self.loss = cracks * float(rng.uniform(11.0, 24.0)) + rng.normal(0.0, 0.6)  # mm
        self.per_stop = 2.0 * rng.normal(1.0, 0.05)
        self.fan, self.pressure = 0.0, 0.0
        self.pipe = deque([0.0] * 2, maxlen=2)
        self.stops, self.next = 2, 8.0
        self.wait = 0.0
        self.time, self.gained, self.failure, self.off = 0.0, 0.0, "", 0.0

    @property
    def done(self):
        """Return whether the piece is over."""
        return bool(self.failure) or self.time >= 40.0

    def publish(self, bus):
        """Publish the pressure and the console."""
        if round(self.time / DT) % 10 == 0:
            bus.publish("console/key", Bool(data=True))
            bus.publish("console/stops", Int32(data=self.stops))
        bus.publish("chest/pressure", Float32(data=self.pipe[0] + self.rng.normal(0.0, 0.4)))

    def advance(self, rpm):
        """Play for one step."""
        self.time += DT
        self.gained = 0.0
        if self.time >= self.next:
            self.next += float(self.rng.uniform(5.0, 8.0))
            self.stops = int(self.rng.integers(0, 6))
        self.fan += 0.25 * ((rpm.data if rpm else 0.0) - self.fan)
        blown = 80.0 * (self.fan / 1000.0) ** 2 - self.loss - self.per_stop * self.stops
        self.pressure += 0.2 * (max(0.0, blown) - self.pressure)
        self.pipe.append(self.pressure)
        error = abs(self.pressure - 80.0)
        if self.time > 10.0:
            self.gained = 0.03 - 0.005 * max(0.0, error - 2.5)
            self.off += DT * (error > 4.5) - 0.02 * self.off * (error <= 4.5)
            if self.off > 5.0:
                self.failure = "organ is out of tune"
            elif self.pressure > 110.0:
                self.failure = "reservoir blows off"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["organ_blower.py"],
    sensors=[
        Sensor("pressure", topic="chest/pressure", field="data", low=0.0, high=110.0, bins=11, unit="mm"),
        Sensor("stops", topic="console/stops", field="data", low=0.0, high=6.0, bins=6),
    ],
    drifts={"winter": WINTER},
    episodes=200,
    min_success=0.97,
)
def test_blows(tarl, tarl_drift):
    """Play one piece."""
    organ = Organ(tarl.rng("organ"), **(tarl_drift or SUMMER))
    tarl.start("organ_blower.py")
    while not organ.done:
        organ.publish(tarl.bus)
        tarl.step(DT)
        organ.advance(tarl.bus.latest("fan/rpm"))
        tarl.reward(organ.gained)
    assert not organ.failure, organ.failure
