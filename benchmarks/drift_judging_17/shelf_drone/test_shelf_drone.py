"""A drone reads labels at three heights. Chipped propellers and old packs lift less, each day a different share."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Range = message_type("sensor_msgs/Range")
Float64 = message_type("std_msgs/Float64")
Int16 = message_type("std_msgs/Int16")

DT = 0.05
LEVEL = 260  # number of steps at each height
READS = 100  # number of the last of these steps, in which labels are read
OLD = (0.72, 0.92)


class Shelf:
    """A drone in front of a shelf; `lift` is the range of the share of thrust that is left."""

    def __init__(self, rng, lift):
        self.rng = rng
        self.lift = rng.uniform(*lift)
        self.levels = [float(rng.uniform(low, low + 0.5)) for low in (1.6, 2.9, 1.0)]
        self.height, self.speed, self.thrust, self.gust = 0.25, 0.0, 0.5, 0.0
        self.seen = [self.height] * 2
        self.battery = float(rng.uniform(60.0, 95.0))
        self.now, self.read, self.gained, self.failure = 0, 0, 0.0, ""

    @property
    def done(self):
        """Return whether all labels are past, or the drone has crashed."""
        return bool(self.failure) or self.now >= 3 * LEVEL

    @property
    def level(self):
        """Return the height of the labels."""
        return self.levels[min(2, self.now // LEVEL)]

    def publish(self, bus):
        """Publish the height, 0.1 s old, the wish, and the battery."""
        bus.publish("lidar/height", Range(range=self.seen[0] + self.rng.normal(0.0, 0.006)))
        if self.now % 10 == 0:
            bus.publish("mission/height", Float64(data=self.level))
        if self.now % 40 == 0:
            bus.publish("battery/percent", Int16(data=round(self.battery)))

    def advance(self, throttle):
        """Fly for one step."""
        self.seen = [*self.seen[1:], self.height]
        self.thrust += 0.35 * ((throttle.data if throttle else 0.5) - self.thrust)
        self.gust += 0.1 * (self.rng.normal(0.0, 0.25) - self.gust)
        lift = 9.81 * (self.lift * self.thrust / 0.52 - 1.0)
        self.speed += DT * (lift - 0.5 * self.speed + self.gust)
        self.height += DT * self.speed
        if self.height < 0.05:
            self.height, self.speed = 0.05, max(0.0, self.speed)
        self.now += 1
        self.battery -= 0.01
        off = abs(self.height - self.levels[(self.now - 1) // LEVEL])
        self.gained = -0.002 * min(2.0, off)
        if (self.now - 1) % LEVEL >= LEVEL - READS:
            self.read += off < 0.16
            self.gained += 0.04 if off < 0.16 else -0.02
        if self.height > 5.0:
            self.failure = "drone hits the lamps"
            self.gained -= 12.0


@pytest.mark.tarl(
    nodes=["shelf_drone.py"],
    sensors=[
        Sensor("height", topic="lidar/height", field="range", low=0.0, high=4.0, bins=5, unit="m"),
        Sensor("wish", topic="mission/height", field="data", low=0.8, high=3.6, bins=3, unit="m"),
    ],
    drifts={"weak lift": OLD},
    episodes=200,
    min_success=0.97,
)
def test_reads(tarl, tarl_drift):
    """Read the labels at three heights."""
    shelf = Shelf(tarl.rng("shelf"), tarl_drift or (0.985, 1.015))
    tarl.start("shelf_drone.py")
    while not shelf.done:
        shelf.publish(tarl.bus)
        tarl.step(DT)
        shelf.advance(tarl.bus.latest("throttle"))
        tarl.reward(shelf.gained)
    assert not shelf.failure, shelf.failure
    assert shelf.read >= 250, f"{shelf.read} of 300 pictures can be read"
