"""A robot scans shelves. With boxes on its tray, the pneumatic tyres give way, and a metre has more ticks."""

from pathlib import Path

import pytest
import yaml

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Int32 = message_type("std_msgs/msg/Int32")

DT = 0.1
SHELVES = (3.6, 7.2, 10.8)
EMPTY = 18430.0
BOXES = {"load": 130.0, "ticks": 19080.0}  # kg, ticks per metre; tyres 3.4 % smaller


class Aisle:
    """An aisle with three shelves; the robot carries `load` kg and has `ticks` in a metre."""

    def __init__(self, rng, load, ticks):
        self.rng = rng
        self.load = load * rng.uniform(0.93, 1.07)
        self.ticks = ticks * rng.normal(1.0, 0.0015)
        self.place, self.speed, self.time = 0.0, 0.0, 0.0
        self.offset = int(rng.integers(0, 50000))
        self.scans, self.stopped, self.gained, self.failure = [], False, 0.0, ""

    @property
    def done(self):
        """Return whether three shelves are scanned, or something went wrong."""
        return bool(self.failure) or (len(self.scans) == 3 and not self.stopped)

    def publish(self, bus):
        """Publish the encoder and the load."""
        bus.publish("wheel/ticks", Int32(data=self.offset + int(self.ticks * self.place)))
        bus.publish("tray/load", Float32(data=self.load + self.rng.normal(0.0, 0.8)))

    def advance(self, cmd, trigger):
        """Drive for one step; a scan reads the shelf within 0.16 m."""
        wish = cmd.linear.x if cmd else 0.0
        lag = 0.75 if self.load < 60.0 else 0.55
        self.speed += lag * (wish - self.speed)
        self.place += DT * self.speed
        self.time += DT
        self.gained = -0.001
        scanning = bool(trigger and trigger.data)
        if scanning and not self.stopped and len(self.scans) < 3:
            off = self.place - SHELVES[len(self.scans)]
            self.scans.append(off)
            good = abs(off) < 0.16
            self.gained += 2.0 - 0.5 * min(2.0, abs(off) / 0.16) if good else -1.0
            if not good:
                self.failure = f"scan {100 * off:.0f} cm beside the shelf"
        self.stopped = scanning
        if self.time > 90.0:
            self.failure = "robot takes too long"
        if self.failure:
            self.gained -= 3.0


@pytest.mark.tarl(
    nodes=["aisle_scout.py"],
    sensors=[
        Sensor("load", topic="tray/load", field="data", low=0.0, high=150.0, bins=5, unit="kg"),
        Sensor("speed", topic="cmd_vel", field="linear.x", low=0.0, high=0.8, bins=4, unit="m/s"),
    ],
    drifts={"boxes": BOXES},
    episodes=200,
    min_success=0.97,
)
def test_scans(tarl, tarl_drift):
    """Scan three shelves."""
    aisle = Aisle(tarl.rng("aisle"), **(tarl_drift or {"load": 12.0, "ticks": EMPTY}))
    config = yaml.safe_load(Path(__file__).with_name("config.yaml").read_text())
    tarl.start("aisle_scout.py", parameters=config["aisle_scout"]["ros__parameters"])
    while not aisle.done:
        aisle.publish(tarl.bus)
        tarl.step(DT)
        aisle.advance(tarl.bus.latest("cmd_vel"), tarl.bus.latest("scanner/trigger"))
        tarl.reward(aisle.gained)
    assert not aisle.failure, aisle.failure
