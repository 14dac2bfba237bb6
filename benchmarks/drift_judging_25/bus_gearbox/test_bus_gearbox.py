"""A bus drives its line. On a line into the hills it loses speed in each shift, and its gearbox hunts.

Each stop that it passes earns, each shift costs, and a clutch that is too hot, or a late bus, ends the tour.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
VALLEY = {"slope": 0.0}
HILLS = {"slope": 0.135}
RATIOS = {1: 24.0, 2: 13.2, 3: 7.8, 4: 5.0}  # engine over wheel
RADIUS = 0.42  # m


class Line:
    """A line with some mean `slope`."""

    def __init__(self, rng, slope):
        self.rng = rng
        self.slope = slope * rng.normal(1.0, 0.02) + rng.normal(0.0, 0.001)
        self.mass = 7200.0 * rng.normal(1.0, 0.02)
        self.speed, self.way, self.gear, self.shifts = 1.5, 0.0, 1, 0
        self.open = False
        self.clutch = 80.0  # degrees C
        self.stops = 0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the tour is over."""
        return bool(self.failure) or self.stops >= 4

    def rpm(self):
        """Return the speed of the engine, or of its idle."""
        return max(700.0, self.speed / RADIUS * RATIOS[self.gear] * 9.549)

    def pedal(self):
        """Return the pedal of a driver who wants 12 m/s."""
        return max(0.0, min(1.0, 0.6 * (12.0 - self.speed)))

    def publish(self, bus):
        """Publish engine, body, driver and clutch."""
        bus.publish("engine/rpm", Float32(data=self.rpm() + self.rng.normal(0.0, 15.0)))
        bus.publish("driver/pedal", Float32(data=self.pedal()))
        if round(self.time / DT) % 10 == 0:
            bus.publish("body/incline", Float32(data=self.slope + self.rng.normal(0.0, 0.004)))
            bus.publish("driver/brake", Bool(data=False))
            bus.publish("clutch/temperature", Float32(data=self.clutch))

    def torque(self):
        """Return the torque of the engine in Nm."""
        rpm = self.rpm()
        full = min(520.0, 520.0 - 0.25 * (rpm - 1700.0))
        return self.pedal() * max(0.0, full)

    def advance(self, gear, is_open):
        """Drive for one step."""
        self.time += DT
        self.gained = -0.001
        if gear is not None and gear.data != self.gear:
            self.gear = gear.data
            self.shifts += 1
            self.gained -= 0.02
            self.clutch += 10.0 + 150.0 * self.slope
        self.clutch += DT * 0.02 * (80.0 - self.clutch)
        force = 0.0
        if is_open is not None and not is_open.data:
            force = 0.9 * self.torque() * RATIOS[self.gear] / RADIUS
        drag = 0.009 * self.mass * 9.81 + 3.4 * self.speed**2
        self.speed += DT * (force - drag - self.mass * 9.81 * self.slope) / self.mass
        self.speed = max(0.0, self.speed)
        self.way += DT * self.speed
        if self.way > 110.0 * (self.stops + 1):
            self.stops += 1
            self.gained += 2.0
        if self.clutch > 190.0:
            self.failure = "clutch burns"
        elif self.speed < 0.3:
            self.failure = "bus stands"
        elif self.time > 95.0:
            self.failure = "bus is late"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["bus_gearbox.py"],
    sensors=[
        Sensor("rpm", topic="engine/rpm", field="data", low=600.0, high=3000.0, bins=8, unit="rpm"),
        Sensor("incline", topic="body/incline", field="data", low=-0.1, high=0.2, bins=6),
    ],
    drifts={"hills": HILLS},
    episodes=200,
    min_success=0.97,
)
def test_drives(tarl, tarl_drift):
    """Pass four stops: 2 for each, a small cost per second and per shift, -4 for a failure."""
    line = Line(tarl.rng("line"), **(tarl_drift or VALLEY))
    tarl.start("bus_gearbox.py")
    while not line.done:
        line.publish(tarl.bus)
        tarl.step(DT)
        line.advance(tarl.bus.latest("gearbox/gear"), tarl.bus.latest("gearbox/clutch_open"))
        tarl.reward(line.gained)
    assert not line.failure, line.failure
