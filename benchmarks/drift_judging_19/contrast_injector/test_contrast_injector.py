"""An injector gives contrast agent. Children get a thinner cannula, in which the same flow needs more pressure."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")

DT = 0.02
WIDE, THIN = 290.0, 600.0  # kPa for each ml/s of contrast agent
BURST = 2300.0  # kPa


class Patient:
    """A patient with a cannula; in one of eight, it slips and is blocked during the injection."""

    def __init__(self, rng, resistance):
        self.rng = rng
        self.resistance = resistance * rng.normal(1.0, 0.035)
        blocked = rng.random() < 0.125
        self.blocked_at = float(rng.uniform(2.0, 9.0)) if blocked else 99.0  # ml
        self.kpa, self.pushed, self.piston, self.contrast = 0.0, 0.0, 0.0, 0.0
        self.time, self.stuck, self.gained, self.failure, self.over = 0.0, 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the injection is over."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the start, the pressure and the piston."""
        bus.publish("injector/start", Bool(data=self.time > 0.2))
        bus.publish("line/kpa", Float32(data=max(0.0, self.kpa + self.rng.normal(0.0, 12.0))))
        bus.publish("piston/position", Float32(data=self.piston))

    def advance(self, piston, saline, state):
        """Push for one step; a blocked line is stiff, 900 kPa for each ml."""
        flow = 0.55 * (piston.data if piston else 0.0)
        self.piston += DT * flow / 0.55
        self.pushed += DT * flow
        thick = 0.45 if saline and saline.data else 1.0
        self.time += DT
        self.gained = -0.001
        if self.pushed > self.blocked_at:
            self.stuck += DT
            self.kpa = max(0.0, self.kpa + 900.0 * DT * flow)
        else:
            self.kpa += 0.2 * (self.resistance * thick * flow - self.kpa)
            if thick == 1.0:
                self.contrast += DT * max(0.0, flow)
        word = state.data if state else ""
        if self.kpa > BURST:
            self.failure = "line bursts"
        elif word == "blocked":
            if not self.stuck:
                self.failure = f"injection stops at {self.pushed:.1f} ml, and the line is free"
            elif self.kpa < 1500.0 or self.stuck > 3.0:
                self.over = True
                self.gained += 2.0
        elif word == "done":
            self.over = True
            late = max(0.0, self.time - 7.6)
            if abs(self.contrast - 8.0) > 0.5:
                self.failure = f"{self.contrast:.1f} ml of contrast agent"
            elif late > 0.6:
                self.failure = "bolus is spread out, the scan misses it"
            else:
                self.gained += 5.0 - 4.0 * late
        elif self.time > 20.0 or word == "open":
            self.failure = "no injection"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["contrast_injector.py"],
    sensors=[
        Sensor("pressure", topic="line/kpa", field="data", low=0.0, high=2000.0, bins=5, unit="kPa"),
        Sensor("piston", topic="piston/position", field="data", low=0.0, high=24.0, bins=4, unit="mm"),
    ],
    drifts={"thin cannula": THIN},
    episodes=200,
    min_success=0.97,
)
def test_injects(tarl, tarl_drift):
    """Give one injection."""
    patient = Patient(tarl.rng("patient"), tarl_drift or WIDE)
    tarl.start("contrast_injector.py")
    while not patient.done:
        patient.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        patient.advance(bus.latest("piston/speed"), bus.latest("valve/saline"), bus.latest("injector/state"))
        tarl.reward(patient.gained)
    assert not patient.failure, patient.failure
