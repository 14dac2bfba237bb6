"""A tractor sprays weeds. A branch has pushed its camera down."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Point = message_type("geometry_msgs/Point")
TwistStamped = message_type("geometry_msgs/TwistStamped")

DT = 0.05
HEIGHT, BOOM = 0.95, 0.40  # m
VALVE = 0.08  # time until a valve opens (s)
MOUNTED, PUSHED = 0.62, 0.72  # rad


class Row:
    """A row with weeds; `pitch` is how far the camera looks down, in rad."""

    def __init__(self, rng, pitch):
        self.rng = rng
        self.pitch = pitch + rng.normal(0.0, 0.004)
        self.speed = rng.uniform(0.9, 1.3)
        gaps = rng.uniform(0.6, 1.1, 8)
        self.weeds = [
            {
                "x": 3.0 + float(gaps[: k + 1].sum()),
                "lane": int(rng.integers(3)),
                "seen": False,
                "wet": 0.0,
                "big": rng.uniform(0.9, 1.7),
            }
            for k in range(8)
        ]
        self.place, self.valves = 0.0, [0, 0]
        self.gained, self.hit = 0.0, 0

    @property
    def done(self):
        """Return whether the boom has passed the last weed."""
        return self.place > self.weeds[-1]["x"] + 0.6

    def publish(self, bus):
        """Publish the speed and each weed once, when it is near enough for its size."""
        moved = TwistStamped()
        moved.twist.linear.x = self.speed + self.rng.normal(0.0, 0.02)
        bus.publish("gps/velocity", moved)
        bus.publish("boom/pressure", Float32(data=2.5 + self.rng.normal(0.0, 0.05)))
        for weed in self.weeds:
            ahead = weed["x"] - self.place - BOOM
            if not weed["seen"] and ahead < weed["big"]:
                weed["seen"] = True
                ray = math.hypot(ahead, HEIGHT)
                left = 0.25 * (weed["lane"] - 1) + self.rng.normal(0.0, 0.015)
                row = 240.0 + 420.0 * math.tan(math.atan2(HEIGHT, ahead) - self.pitch)
                u, v = 320.0 - 420.0 * left / ray, row + self.rng.normal(0.0, 1.5)
                bus.publish("weeds", Point(x=u, y=v, z=float(self.rng.uniform(0.6, 1.0))))

    def advance(self, command):
        """Drive on; the valves follow with a delay."""
        self.valves.append(command.data if command else 0)
        mask = self.valves[-1 - round(VALVE / DT)]
        self.place += self.speed * DT
        self.gained = -0.04 * bin(mask).count("1")
        for weed in self.weeds:
            if mask >> weed["lane"] & 1 and abs(weed["x"] - self.place) < 0.10:
                before = weed["wet"]
                weed["wet"] = min(1.0, before + 0.6)
                self.gained += 1.5 * (weed["wet"] - before)
                self.hit += before < 0.5 <= weed["wet"]


@pytest.mark.tarl(
    nodes=["weed_sprayer.py"],
    sensors=[
        Sensor("row", topic="weeds", field="y", low=140.0, high=340.0, bins=4, unit="px"),
        Sensor("column", topic="weeds", field="x", low=200.0, high=440.0, bins=3, unit="px"),
        Sensor("speed", topic="gps/velocity", field="twist.linear.x", low=0.8, high=1.4, bins=3, unit="m/s"),
    ],
    drifts={"pushed camera": Drift(PUSHED, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_sprays(tarl, tarl_drift):
    """Spray one row."""
    row = Row(tarl.rng("row"), tarl_drift or MOUNTED)
    tarl.start("weed_sprayer.py")
    while not row.done:
        row.publish(tarl.bus)
        tarl.step(DT)
        row.advance(tarl.bus.latest("boom/valves"))
        tarl.reward(row.gained)
    assert row.hit >= 7, f"{row.hit} of 8 weeds sprayed"
