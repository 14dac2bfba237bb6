"""A wind tunnel holds air speeds for a calibration. In summer it works at a station in the mountains, in thin air."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
String = message_type("std_msgs/String")

DT = 0.1
VALLEY = {"hpa": 1002.0, "density": 1.19}
MOUNTAIN = {"hpa": 715.0, "density": 0.87}


class Tunnel:
    """A tunnel at a place with air of `density`, in kg/m³."""

    def __init__(self, rng, hpa, density):
        self.rng = rng
        weather = rng.normal(1.0, 0.006)
        self.hpa = hpa * weather
        self.density = density * weather * rng.normal(1.0, 0.003)
        low, high = rng.uniform(4.0, 7.0), rng.uniform(10.0, 14.0)
        self.goals = [round(float(low), 1), round(float(high), 1)]
        self.speed, self.gain = 0.0, rng.normal(25.0, 0.8)  # m/s of the whole drive
        self.time, self.step, self.held, self.bad = 0.0, 0, 0, 0
        self.gained, self.failure = 0.0, ""

    @property
    def done(self):
        """Return whether all speeds were held, or the calibration is lost."""
        return bool(self.failure) or self.step >= len(self.goals)

    def publish(self, bus):
        """Publish the job, the pressure of the Pitot tube and the barometer."""
        if round(self.time / DT) % 20 == 0:
            bus.publish("job/speeds", String(data=" ".join(str(goal) for goal in self.goals)))
            bus.publish("room/hpa", Float32(data=self.hpa + self.rng.normal(0.0, 0.5)))
        pascal = 0.5 * self.density * self.speed**2 * (1.0 + self.rng.normal(0.0, 0.006))
        bus.publish("pitot/pascal", Float32(data=pascal + self.rng.normal(0.0, 0.05)))

    def advance(self, fan, hold):
        """Blow for one step; while the node holds a speed, the anemometer is read."""
        wish = self.gain * (fan.data if fan else 0.0)
        self.speed += 0.12 * (wish - self.speed)
        self.time += DT
        self.gained = -0.002
        goal = self.goals[self.step]
        if hold and hold.data:
            error = self.speed / goal - 1.0
            self.held += 1
            self.bad += abs(error) > 0.035
            self.gained += 0.08 * max(-1.0, 1.0 - (error / 0.035) ** 2)
        elif self.held >= 15:
            self.step += 1
            self.held = 0
        if self.bad > 8:
            self.failure = f"air at {self.speed:.2f} m/s instead of {goal} m/s"
        elif self.speed > 19.5:
            self.failure = "anemometer breaks"
        elif self.time > 60.0:
            self.failure = "calibration takes too long"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["wind_tunnel.py", "tunnel_settings.py"],
    sensors=[
        Sensor("air", topic="room/hpa", field="data", low=600.0, high=1060.0, bins=4, unit="hPa"),
        Sensor("speed", topic="tunnel/speed", field="data", low=0.0, high=16.0, bins=6, unit="m/s"),
    ],
    drifts={"mountain station": MOUNTAIN},
    episodes=200,
    min_success=0.97,
)
def test_calibrates(tarl, tarl_drift):
    """Hold two air speeds."""
    tunnel = Tunnel(tarl.rng("tunnel"), **(tarl_drift or VALLEY))
    tarl.start("wind_tunnel.py")
    while not tunnel.done:
        tunnel.publish(tarl.bus)
        tarl.step(DT)
        tunnel.advance(tarl.bus.latest("fan/drive"), tarl.bus.latest("tunnel/hold"))
        tarl.reward(tunnel.gained)
    assert not tunnel.failure, tunnel.failure
