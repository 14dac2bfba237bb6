"""A battery pack is kept warm by a relay. The lead of its sensor now lies beside the cable of a motor."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Temperature = message_type("sensor_msgs/msg/Temperature")
BatteryState = message_type("sensor_msgs/msg/BatteryState")

DT = 2.0
STEPS = 600  # 20 minutes
QUIET = 0.01  # noise (K)
NOISY = 0.3


class Pack:
    """A pack in the cold, a heating mat behind a relay; `noise` is that of the sensor, in K."""

    def __init__(self, rng, noise):
        self.rng = rng
        self.noise = noise
        self.outside = float(rng.uniform(-12.0, -4.0))
        self.pack = float(rng.uniform(13.0, 14.5))
        self.mat = self.felt = self.pack
        self.volts = float(rng.uniform(44.0, 46.0))
        self.on, self.switched, self.off = False, 0, 0
        self.now, self.gained, self.failure = 0, 0.0, ""

    @property
    def done(self):
        """Return whether the time is over, or the relay has welded."""
        return bool(self.failure) or self.now >= STEPS

    def publish(self, bus):
        """Publish the voltage and the temperature."""
        if self.now % 5 == 0:
            bus.publish("battery", BatteryState(voltage=self.volts - 0.6 * self.on))
        seen = self.felt + self.rng.normal(0.0, self.noise)
        bus.publish("pack/temperature", Temperature(temperature=seen))

    def advance(self, relay, fan):
        """Heat and cool for one step."""
        on = bool(relay and relay.data)
        change = on != self.on
        self.switched += change
        self.on = on
        stirred = 1.0 + (0.5 * fan.data if fan else 0.0)
        self.mat += DT * (0.30 * on - 0.02 * stirred * (self.mat - self.pack))
        self.pack += DT * (0.004 * stirred * (self.mat - self.pack) - 0.0013 * (self.pack - self.outside))
        self.felt += DT / 20.0 * (self.pack - self.felt)  # the sensor sits in a pocket
        self.now += 1
        warm = abs(self.pack - 15.0) < 3.5
        self.off += not warm
        self.gained = (0.02 if warm else -0.02) - 0.03 * change
        if self.switched > 90:
            self.failure = "relay has welded"
            self.gained -= 6.0
        elif self.off > 60:
            self.failure = f"pack at {self.pack:.0f} degrees"
            self.gained -= 6.0


@pytest.mark.tarl(
    nodes=["pack_warmer.py"],
    sensors=[
        Sensor("pack", topic="pack/temperature", field="temperature", low=11.0, high=19.0, bins=6, unit="°C"),
        Sensor("battery", topic="battery", field="voltage", low=42.0, high=47.0, bins=2, unit="V"),
    ],
    drifts={"noisy lead": NOISY},
    episodes=200,
    min_success=0.97,
)
def test_warms(tarl, tarl_drift):
    """Keep the pack warm and spare the relay."""
    pack = Pack(tarl.rng("pack"), tarl_drift or QUIET)
    tarl.start("pack_warmer.py")
    while not pack.done:
        pack.publish(tarl.bus)
        tarl.step(DT)
        pack.advance(tarl.bus.latest("mat/relay"), tarl.bus.latest("fan/duty"))
        tarl.reward(pack.gained)
    assert not pack.failure, pack.failure
