"""Fetch's battery_warning.py sends a mail when the battery is low. An aged battery empties quickly at the end.

The robot patrols until somebody has read the mail and calls it home. The two message types of this folder have the
fields that the node uses; `sound_play` is a speaker that takes no time.
"""

import sys
from types import ModuleType, SimpleNamespace

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

NODE = "jsk_fetch_robot/jsk_fetch_startup/scripts/battery_warning.py"
DT = 60.0
BEND = 0.6  # charge below which an aged battery empties faster
TIME_BOUND = 300.0  # min


class Shift:
    """A patrol on one battery, which below the bend empties faster by the factor `age`."""

    def __init__(self, rng, age):
        self.rng = rng
        self.age = age
        self.charge = rng.uniform(0.9, 1.0)
        self.use = rng.uniform(0.006, 0.009)  # a minute
        self.way = rng.uniform(14.0, 20.0)  # minutes from the mail until the robot is at its dock
        self.mailed = False
        self.minutes = 0.0
        self.failure = ""

    @property
    def home(self):
        """Return whether the robot is at its dock."""
        return self.mailed and self.way <= 0.0

    def publish(self, bus):
        """Publish the state of the battery."""
        level = max(0.0, min(1.0, self.charge + self.rng.normal(0.0, 0.002)))
        bus.publish(
            "/battery_state",
            message_type("power_msgs/BatteryState")(name="main", charge_level=level, is_charging=False),
        )

    def advance(self, mail, shutdown):
        """Patrol, or drive home, for a minute."""
        self.mailed = self.mailed or mail is not None
        self.charge -= self.use * (self.age if self.charge < BEND else 1.0)
        self.way -= self.mailed
        self.minutes += 1.0
        if self.home:
            return
        if shutdown is not None:
            self.failure = "shut down on the way to the dock"
        elif self.charge <= 0.1:
            self.failure = "battery empty on the way to the dock"
        elif self.minutes > TIME_BOUND:
            self.failure = "late"

    def judge(self):
        """Return the reward of the minute: patrolling, as a share of the charge, and coming home."""
        if self.failure:
            return -10.0
        return (0.0 if self.mailed else 2.0 * self.use) + (9.0 if self.home else 0.0)


def speaker():
    """Return the package `sound_play`, whose speaker takes no time."""
    client = SimpleNamespace(
        wait_for_server=lambda **_: True, wait_for_result=lambda: True, get_result=lambda: None
    )
    package, module = ModuleType("sound_play"), ModuleType("sound_play.libsoundplay")
    module.SoundClient = lambda **_: SimpleNamespace(actionclient=client, say=lambda *_, **__: None)
    package.libsoundplay = module
    return {"sound_play": package, "sound_play.libsoundplay": module}


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[Sensor("charge", topic="/battery_state", field="charge_level", low=0, high=1, bins=10)],
    drifts={"aged": Drift(1.7, permanent=True)},
    episodes=60,
    min_success=0.95,
)
def test_comes_home(tarl, tarl_drift, monkeypatch):
    """Patrol until the mail is sent, and come home in time."""
    for name, module in speaker().items():
        monkeypatch.setitem(sys.modules, name, module)
    shift = Shift(tarl.rng("shift"), tarl_drift or 1.0)
    tarl.start(NODE)
    while not (shift.home or shift.failure):
        shift.publish(tarl.bus)
        tarl.step(DT)
        shift.advance(tarl.bus.latest("/email"), tarl.bus.latest("/shutdown"))
        tarl.reward(shift.judge())
    assert not shift.failure, shift.failure
