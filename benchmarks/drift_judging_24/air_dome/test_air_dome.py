"""An air dome stands over tennis courts. In a storm, gusts press a dimple into its windward side."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
FluidPressure = message_type("sensor_msgs/msg/FluidPressure")

DT = 2.0
BREEZE = {"wind": 5.0}
STORM = {"wind": Drift.range(16.5, 19.5)}  # m/s


class Dome:
    """A dome in some `wind`, in m/s, that comes up in the first minutes."""

    def __init__(self, rng, wind):
        self.rng = rng
        self.strength = wind
        self.blower = 760.0 * rng.normal(1.0, 0.03)  # Pa at full duty with the gate closed
        self.pressure = 235.0 + rng.normal(0.0, 8.0)
        self.gust, self.wind, self.creep = 0.0, 4.0, 0.0
        opens = float(rng.uniform(220.0, 300.0))
        self.gate = (opens, opens + 40.0)
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the time is over."""
        return bool(self.failure) or self.time >= 600.0

    def publish(self, bus):
        """Publish the pressure, the wind at the mast and the gate."""
        bus.publish("dome/pressure", FluidPressure(fluid_pressure=self.pressure + self.rng.normal(0.0, 3.0)))
        bus.publish("mast/wind", Float32(data=max(0.0, self.wind + self.rng.normal(0.0, 0.4))))
        bus.publish("gate/open", Bool(data=self.gate[0] <= self.time < self.gate[1]))

    def advance(self, duty):
        """Hold the roof for one step."""
        self.time += DT
        duty = duty.data if duty else 0.0
        come = min(1.0, max(0.0, self.time - 40.0) / 120.0)
        self.gust += -0.2 * self.gust + self.rng.normal(0.0, 0.045 * self.strength)
        self.wind = max(0.0, 4.0 + (self.strength - 4.0) * come + come * self.gust)
        full = self.blower * (0.85 if self.gate[0] <= self.time < self.gate[1] else 1.0)
        self.pressure += 0.12 * DT * (full * duty - self.pressure)
        load = 0.92 * self.wind**2  # Pa on the windward side
        strain = self.pressure - 0.5 * load
        self.creep = max(0.0, self.creep + 0.001 * (strain - 390.0))
        self.gained = 0.03 - 0.002 * duty - 0.00004 * max(0.0, strain - 400.0)
        if load > 1.05 * self.pressure:
            self.gained -= 0.15
        if load > 1.25 * self.pressure:
            self.failure = "gust dents the roof"
        elif self.creep > 10.0:
            self.failure = "seam tears"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["air_dome.py"],
    sensors=[
        Sensor(
            "pressure", topic="dome/pressure", field="fluid_pressure", low=0.0, high=700.0, bins=7, unit="Pa"
        ),
        Sensor("wind", topic="mast/wind", field="data", low=0.0, high=25.0, bins=5, unit="m/s"),
    ],
    drifts={"storm": STORM},
    episodes=200,
    min_success=0.97,
)
def test_stands(tarl, tarl_drift):
    """Stand for ten minutes."""
    dome = Dome(tarl.rng("dome"), **(tarl_drift or BREEZE))
    tarl.start("air_dome.py")
    while not dome.done:
        dome.publish(tarl.bus)
        tarl.step(DT)
        dome.advance(tarl.bus.latest("blower/duty"))
        tarl.reward(dome.gained)
    assert not dome.failure, dome.failure
