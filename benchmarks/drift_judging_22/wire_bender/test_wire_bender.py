"""A robot bends wire. A coil from another mill is harder, and the wire springs back further."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Float32MultiArray = message_type("std_msgs/msg/Float32MultiArray")

DT = 0.1
SOFT = {"spring": 1.05, "hardness": 145.0}
HARD = {"spring": 1.125, "hardness": 198.0}


class Bench:
    """A wire that springs back by `spring`."""

    def __init__(self, rng, spring, hardness):
        self.rng = rng
        self.spring, self.hardness = spring + rng.normal(0.0, 0.003), hardness
        self.angles = [float(rng.uniform(70.0, 130.0)) for _ in range(3)]
        self.pin, self.most, self.bent = 0.0, 0.0, 0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the basket is bent."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the pin, and once the coil and the job."""
        if round(self.time / DT) == 1:
            bus.publish("coil/hardness", Float32(data=self.hardness + self.rng.normal(0.0, 5.0)))
        if round(self.time / DT) == 3:
            bus.publish("bender/job", Float32MultiArray(data=self.angles))
        bus.publish("pin/angle", Float32(data=self.pin + self.rng.normal(0.0, 0.03)))

    def advance(self, target, phase):
        """Move the pin for one step; the wire keeps its angle when the pin lets go."""
        self.time += DT
        self.gained = 0.0
        wish = target.data if target else 0.0
        self.pin += max(-18.0, min(18.0, 0.8 * (wish - self.pin)))
        self.most = max(self.most, self.pin)
        if self.most > 20.0 and self.pin < 5.0 and self.bent < len(self.angles):
            off = abs((self.most - 1.5) / self.spring - self.angles[self.bent])
            self.bent += 1
            self.most = 0.0
            self.gained += 3.0 - 0.6 * max(0.0, off - 0.5)
            if off > 3.5:
                self.failure = "basket is crooked"
        if self.time > 14.0:
            self.failure = "bender is stuck"
        elif phase and phase.data == "done":
            self.over = True
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["wire_bender.py", "alloys.py"],
    sensors=[
        Sensor("hardness", topic="coil/hardness", field="data", low=100.0, high=260.0, bins=8),
        Sensor("pin", topic="pin/angle", field="data", low=0.0, high=180.0, bins=6),
    ],
    drifts={"hard": HARD},
    episodes=200,
    min_success=0.97,
)
def test_bends(tarl, tarl_drift):
    """Bend one basket."""
    bench = Bench(tarl.rng("bench"), **(tarl_drift or SOFT))
    tarl.start("wire_bender.py")
    while not bench.done:
        bench.publish(tarl.bus)
        tarl.step(DT)
        bench.advance(tarl.bus.latest("pin/target"), tarl.bus.latest("bender/phase"))
        tarl.reward(bench.gained)
    assert not bench.failure, bench.failure
