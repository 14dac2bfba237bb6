"""A trolley takes pictures along a rail. In some missions, its wheel slips for a metre on wet leaves at the portal."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")

DT = 0.1
LEAVES = 0.1  # share of the missions with leaves


class Tunnel:
    """A rail with a tag every 6 m; `leaves` is the share of the missions in which the wheel slips."""

    def __init__(self, rng, leaves):
        self.rng = rng
        self.scale = 1180.0 * rng.normal(1.0, 0.005)
        slips = rng.random() < leaves
        self.slip = float(rng.uniform(0.9, 1.5) if slips else rng.uniform(0.0, 0.15))
        self.leaf = float(rng.uniform(2.0, 9.0))
        self.targets = [float(rng.uniform(low, low + 3.0)) for low in (15.0, 22.0, 30.0)]
        self.place, self.ticks, self.speed = 0.0, 0.0, 0.0
        self.photos, self.shooting = [], False
        self.tags, self.ghosts = [1, 2, 3, 4, 5, 6], set(rng.choice(range(2, 6), 1).tolist())
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether all pictures are taken, or something went wrong."""
        return bool(self.failure) or (len(self.photos) == 3 and not self.shooting)

    def publish(self, bus):
        """Publish the targets, the ticks, and tags that are passed; sometimes one of the next track."""
        if self.time == 0.0:
            for target in self.targets:
                bus.publish("mission/add_target", Float32(data=target))
        bus.publish("wheel/ticks", Int32(data=int(self.ticks)))
        if self.tags and self.place > 6.0 * self.tags[0] + self.rng.normal(0.0, 0.03):
            bus.publish("reader/tag", Int32(data=self.tags.pop(0)))
        for tag in sorted(self.ghosts):
            if self.place > 6.0 * tag + 1.5:
                bus.publish("reader/tag", Int32(data=tag + (1 if tag % 2 else -1)))
                self.ghosts.discard(tag)

    def advance(self, command, shoot):
        """Roll for one step; on leaves, the wheel turns more than the trolley moves."""
        self.speed += 0.5 * ((command.data if command else 0.0) - self.speed)
        self.place += DT * self.speed
        lost = self.slip * DT * self.speed if self.leaf < self.place < self.leaf + 1.0 else 0.0
        self.ticks += self.scale * (DT * self.speed + lost)
        self.time += DT
        self.gained = -0.002
        shooting = bool(shoot and shoot.data)
        if shooting and not self.shooting and len(self.photos) < 3:
            off = abs(self.place - self.targets[len(self.photos)])
            self.photos.append(off)
            self.gained += 2.0 - min(1.0, off) if off < 0.45 else -1.0
            if off > 0.45:
                self.failure = f"picture {100 * off:.0f} cm beside the joint"
        self.shooting = shooting
        if self.time > 120.0:
            self.failure = "trolley takes too long"
        if self.failure:
            self.gained -= 10.0


@pytest.mark.tarl(
    nodes=["rail_trolley.py"],
    sensors=[
        Sensor("tag", topic="reader/tag", field="data", low=0.0, high=7.0, bins=4),
        Sensor("speed", topic="trolley/speed", field="data", low=-0.4, high=1.4, bins=4, unit="m/s"),
    ],
    drifts={"wet leaves": LEAVES},
    episodes=300,
    min_success=0.97,
)
def test_inspects(tarl, tarl_drift):
    """Take pictures of three joints of the rail."""
    tunnel = Tunnel(tarl.rng("tunnel"), tarl_drift or 0.0)
    tarl.start("rail_trolley.py")
    while not tunnel.done:
        tunnel.publish(tarl.bus)
        tarl.step(DT)
        tunnel.advance(tarl.bus.latest("trolley/speed"), tarl.bus.latest("camera/shoot"))
        tarl.reward(tunnel.gained)
    assert not tunnel.failure, tunnel.failure
