"""A belt follows a walker whose pace changes. With its drive in eco mode, the belt responds late and oscillates."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
END = 0.75  # distance from the middle to either end (m)
PACES = 5
PACE_TIME = 8.0
QUICK = 0.3  # time constant of the drive (s)


class Walk:
    """A walk at varying pace on a belt whose drive has a time constant of `lag` seconds."""

    def __init__(self, rng, lag):
        self.rng = rng
        self.eco = lag > 2 * QUICK
        self.lag = lag * rng.uniform(0.95, 1.05)
        self.paces = [float(1.0 + (-1) ** k * rng.uniform(0.15, 0.28)) for k in range(PACES)]
        self.pace = self.belt = 1.0
        self.place = rng.uniform(-0.05, 0.05)
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the walk is over."""
        return self.time >= PACES * PACE_TIME - 1e-6 or bool(self.failure)

    def publish(self, bus):
        """Publish the position of the walker and the mode of the drive."""
        bus.publish("walker/place", Float32(data=self.place + self.rng.normal(0.0, 0.004)))
        bus.publish("handrail/stop", Bool(data=False))
        bus.publish("drive/eco", Bool(data=self.eco))

    def advance(self, speed):
        """Walk for one step; return the reward."""
        wanted = self.paces[min(PACES - 1, int(self.time / PACE_TIME + 1e-6))]
        self.pace += (wanted - self.pace) * DT / 0.6
        self.belt += ((speed.data if speed else 1.0) - self.belt) * DT / self.lag
        self.place += (self.pace - self.belt) * DT
        self.time += DT
        if abs(self.place) > END:
            self.failure = f"off the belt after {self.time:.0f} s"
            return -4.0
        return 10.0 * DT / (PACES * PACE_TIME) * (1.0 - (self.place / END) ** 2)


@pytest.mark.tarl(
    nodes=["follower.py", "pid.py"],
    sensors=[
        Sensor("eco", topic="drive/eco", field="data", low=0, high=1, bins=2),
        Sensor("place", topic="walker/place", field="data", low=-0.75, high=0.75, bins=3),
    ],
    drifts={"eco drive": 2.4},
    episodes=100,
    min_success=0.95,
)
def test_follows(tarl, tarl_drift):
    """Walk for 40 s."""
    walk = Walk(tarl.rng("walk"), tarl_drift or QUICK)
    tarl.start("follower.py")
    while not walk.done:
        walk.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(walk.advance(tarl.bus.latest("belt/speed")))
    assert not walk.failure, walk.failure
