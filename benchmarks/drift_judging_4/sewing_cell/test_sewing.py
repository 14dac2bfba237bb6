"""Stitches have their length and lock in the middle of the cloth. Denim slips more and needs more tension."""

from pathlib import Path

import pytest
import yaml

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Float64MultiArray = message_type("std_msgs/msg/Float64MultiArray")
String = message_type("std_msgs/msg/String")

DT = 0.05
LENGTH_WINDOW = 0.13  # tolerated error, as a share of the stitch
LOCK_WINDOW = 0.2  # tolerated error, as a share of the tension that the cloth needs
TIME_BOUND = 14.0
CLOTHS = {"cotton": (0.04, 1.0), "denim": (0.27, 1.55)}  # slip, and tension relative to cotton


class Table:
    """A machine with a cloth."""

    def __init__(self, rng, cloth):
        self.rng = rng
        self.cloth = cloth
        slip, pull = CLOTHS[cloth]
        self.slip = slip + rng.uniform(-0.015, 0.015)
        self.pull = pull * rng.uniform(0.95, 1.05)
        self.stitch = rng.uniform(2.0, 3.0)
        self.length = rng.uniform(160.0, 220.0)
        self.corners = [self.length * rng.uniform(0.3, 0.4), self.length * rng.uniform(0.6, 0.7)]
        self.sewn, self.moved, self.due = 0.0, 0.0, 0.0
        self.good = self.bad = 0.0
        self.finished = False
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the seam is judged, or the episode has failed."""
        return self.finished or bool(self.failure)

    def publish(self, bus):
        """Publish the seam, the label of the cloth and the sewn length."""
        bus.publish("pattern/seam", Float64MultiArray(data=[self.stitch, self.length, *self.corners]))
        bus.publish("pattern/cloth", String(data=self.cloth))
        bus.publish("machine/sewn", Float32(data=self.sewn))

    def advance(self, feed, tension, speed, done):
        """Sew the stitches of this step."""
        self.moved = 0.0
        self.good = self.bad = 0.0
        self.time += DT
        self.finished = bool(done and done.data)
        if not (feed and tension and speed) or self.finished:
            return
        self.due += max(0.0, min(20.0, speed.data)) * DT
        while self.due >= 1.0:
            self.due -= 1.0
            made = max(0.0, feed.data) * (1.0 - self.slip) * (1.0 + self.rng.normal(0.0, 0.02))
            needed = self.pull * (28.0 + 9.0 * self.stitch) * (1.0 + self.rng.normal(0.0, 0.03))
            long = abs(made / self.stitch - 1.0) < LENGTH_WINDOW
            locked = abs(tension.data / needed - 1.0) < LOCK_WINDOW
            self.sewn += made
            self.moved += made
            self.good += made * (long + locked) / 2.0
            self.bad += made * (not (long and locked))

    def judge(self, faulty):
        """Return the reward of the step: half for stitches of the right length, half for locked stitches."""
        if self.time > TIME_BOUND:
            self.failure = "late"
        elif self.finished and faulty > 0.1 * self.length:
            self.failure = f"{faulty:.0f} mm of the seam are faulty"
        if self.failure:
            return -4.0
        return 10.0 * self.good / self.length - 0.002


@pytest.mark.tarl(
    nodes=["sewing_cell.py"],
    sensors=[
        Sensor("cloth", topic="pattern/cloth", field="data", categories=("cotton", "denim")),
        Sensor("stitch", topic="pattern/seam", field="data.0", low=2, high=3, bins=3, unit="mm"),
        Sensor("sewn", topic="machine/sewn", field="data", low=0, high=220, bins=4, unit="mm"),
    ],
    drifts={"denim": "denim"},
    episodes=100,
    min_success=0.95,
)
def test_sews(tarl, tarl_drift):
    """Sew one seam."""
    table = Table(tarl.rng("table"), tarl_drift or "cotton")
    config = yaml.safe_load(Path(__file__).with_name("cell.yaml").read_text())
    tarl.start("sewing_cell.py", parameters=config["/sewing_cell"]["ros__parameters"])
    faulty = 0.0
    while not table.done:
        table.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        names = ("machine/feed", "machine/tension", "machine/speed", "cell/done")
        table.advance(*(latest(name) for name in names))
        faulty += table.bad
        tarl.reward(table.judge(faulty))
    assert not table.failure, table.failure
