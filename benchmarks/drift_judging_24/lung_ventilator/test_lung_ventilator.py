"""A ventilator supports the breaths of a patient. A mask that leaks lets air flow without any breath."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")

DT = 0.05
TIGHT = {"leak": 0.1}
LOOSE = {"leak": 1.15}  # litres per minute and cmH2O


class Patient:
    """A patient with a mask that leaks `leak` litres per minute and cmH2O."""

    def __init__(self, rng, leak):
        self.rng = rng
        self.leak = leak * rng.normal(1.0, 0.06)
        self.compliance = 0.05 * rng.normal(1.0, 0.1)  # litres per cmH2O
        self.resistance = 9.0 * rng.normal(1.0, 0.08)  # cmH2O and s per litre
        self.volume = 5.0 * self.compliance
        self.pressure, self.flow = 5.0, 0.0
        self.efforts = []
        start = 1.5
        while start < 23.0:
            self.efforts.append((start, float(rng.uniform(5.0, 8.0)), float(rng.uniform(0.75, 0.95))))
            start += float(rng.uniform(2.5, 3.3))
        self.supported, self.wild, self.inspiring = set(), 0, False
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the observation is over."""
        return bool(self.failure) or self.time >= 24.0

    def publish(self, bus):
        """Publish flow and pressure of the circuit."""
        measured = 60.0 * self.flow + self.leak * self.pressure
        bus.publish("circuit/flow", Float32(data=measured + self.rng.normal(0.0, 0.25)))
        bus.publish("circuit/pressure", Float32(data=self.pressure + self.rng.normal(0.0, 0.1)))

    def begun(self):
        """Count a breath of the ventilator."""
        for number, (start, _, lasts) in enumerate(self.efforts):
            if start <= self.time < start + lasts and number not in self.supported:
                self.supported.add(number)
                self.gained += 1.0 - 1.0 * max(0.0, self.time - start - 0.2)
                return
        self.wild += 1
        self.gained -= 0.5

    def advance(self, target, phase):
        """Breathe for one step."""
        self.time += DT
        self.gained = 0.0
        self.pressure += 0.6 * ((target.data if target else 5.0) - self.pressure)
        muscle = 0.0
        for start, effort, lasts in self.efforts:
            if start <= self.time < start + lasts:
                muscle = effort * math.sin(math.pi * (self.time - start) / lasts)
        for _ in range(2):
            recoil = self.volume / self.compliance
            self.flow = (self.pressure + muscle - recoil) / self.resistance
            self.volume += 0.5 * DT * self.flow
        inspiring = phase is not None and phase.data == "inspiration"
        if inspiring and not self.inspiring:
            self.begun()
        self.inspiring = inspiring
        missed = sum(start + lasts < self.time for start, _, lasts in self.efforts) - len(self.supported)
        if self.wild > 3:
            self.failure = "ventilator triggers itself"
        elif missed > 2:
            self.failure = "patient fights the ventilator"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["lung_ventilator.py"],
    sensors=[
        Sensor("flow", topic="circuit/flow", field="data", low=-60.0, high=90.0, bins=10, unit="l/min"),
        Sensor("pressure", topic="circuit/pressure", field="data", low=0.0, high=25.0, bins=5, unit="cmH2O"),
    ],
    drifts={"loose": LOOSE},
    episodes=200,
    min_success=0.97,
)
def test_supports(tarl, tarl_drift):
    """Support a patient for 24 s."""
    patient = Patient(tarl.rng("patient"), **(tarl_drift or TIGHT))
    tarl.start("lung_ventilator.py")
    while not patient.done:
        patient.publish(tarl.bus)
        tarl.step(DT)
        patient.advance(tarl.bus.latest("blower/pressure"), tarl.bus.latest("ventilator/phase"))
        tarl.reward(patient.gained)
    assert not patient.failure, patient.failure
