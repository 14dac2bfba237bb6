"""A printer cures resin layer by layer. In an unheated workshop the resin is cold and needs more light."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Int32 = message_type("std_msgs/msg/Int32")

DT = 0.1
BOTTOM = 3
NEED = 2.4  # s of light for a layer at 25 degrees
WARM = {"vat": 25.0, "factor": 1.0}
COLD = {"vat": 16.5, "factor": 1.5}


class Vat:
    """A vat of resin at `vat` degrees; a layer needs `factor` times the light."""

    def __init__(self, rng, vat, factor):
        self.rng = rng
        self.vat = vat + rng.uniform(-1.2, 1.2)
        self.need = NEED * factor * rng.normal(1.0, 0.012)
        self.layers = int(rng.integers(9, 12))
        self.dose, self.layer, self.force = 0.0, 0, 0.0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether all layers are printed, or the print has failed."""
        return bool(self.failure) or self.layer >= self.layers

    def publish(self, bus):
        """Publish the job, the temperature and the force at the plate."""
        bus.publish("job/layers", Int32(data=self.layers))
        bus.publish("plate/force", Float32(data=abs(self.force + self.rng.normal(0.0, 0.4))))
        if round(self.time / DT) % 10 == 0:
            bus.publish("vat/temperature", Float32(data=self.vat + self.rng.normal(0.0, 0.15)))

    def advance(self, lamp, axis, layer):
        """Cure and move for one step; a layer is judged when it is peeled off."""
        self.dose += DT * bool(lamp and lamp.data)
        speed = axis.data if axis else 0.0
        self.force += 0.4 * (12.0 * max(0.0, speed) - self.force)
        self.time += DT
        self.gained = -0.001
        if layer and layer.data > self.layer:
            ratio = self.dose / self.need
            bottom = self.layer < BOTTOM
            low, high = (1.7, 4.5) if bottom else (0.87, 1.14)
            good = low < ratio < high
            if not bottom:
                self.gained += max(-1.0, 1.0 - ((ratio - 1.0) / 0.2) ** 2)
            if not good:
                word = "weak and comes off" if ratio < low else "too strong, details are closed"
                self.failure = f"layer {self.layer} is {word}"
                self.gained -= 5.0
            self.dose, self.layer = 0.0, layer.data
        if self.time > 200.0:
            self.failure = "print takes too long"
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["resin_printer.py"],
    sensors=[
        Sensor("vat", topic="vat/temperature", field="data", low=10.0, high=30.0, bins=5, unit="°C"),
        Sensor("force", topic="plate/force", field="data", low=0.0, high=30.0, bins=3, unit="N"),
    ],
    drifts={"cold workshop": COLD},
    episodes=200,
    min_success=0.97,
)
def test_prints(tarl, tarl_drift):
    """Print one small part."""
    vat = Vat(tarl.rng("vat"), **(tarl_drift or WARM))
    tarl.start("resin_printer.py")
    while not vat.done:
        vat.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        vat.advance(bus.latest("lamp/on"), bus.latest("axis/speed"), bus.latest("printer/layer"))
        tarl.reward(vat.gained)
    assert not vat.failure, vat.failure
