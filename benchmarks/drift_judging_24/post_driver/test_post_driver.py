"""A tractor drives fence posts. In dry clay they go down slowly, but they do go down."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Empty = message_type("std_msgs/Empty")
Float32 = message_type("std_msgs/Float32")
Vector3 = message_type("geometry_msgs/Vector3")

DT = 0.8
LOAM = {"per_blow": 34.0}
CLAY = {"per_blow": 9.5}  # mm per kJ


class Fence:
    """Ground in which a blow of 1 kJ drives a post by `per_blow`, in mm."""

    def __init__(self, rng, per_blow):
        self.rng = rng
        self.per_blow = per_blow * rng.normal(1.0, 0.05)
        self.posts = 0
        self.next = 1.6
        self.new_post()
        self.strikes, self.corrections, self.results = [], [], []
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    def new_post(self):
        """Set up the next post."""
        self.depth, self.on_rock = 0.0, 0
        self.tilt = self.rng.normal(0.0, 0.03, 2)
        self.rock = float(self.rng.uniform(0.25, 0.55)) if self.rng.random() < 0.35 else None

    @property
    def done(self):
        """Return whether the fence is done."""
        return bool(self.failure) or self.posts >= 4

    def publish(self, bus):
        """Publish the mast, the hammer, and that the tractor is in place."""
        bus.publish("hammer/depth", Float32(data=self.depth + self.rng.normal(0.0, 0.0004)))
        bus.publish("mast/tilt", Vector3(x=float(self.tilt[0]), y=float(self.tilt[1]), z=0.0))
        if self.next is not None and self.time >= self.next:
            self.next = None
            bus.publish("tractor/in_place", Empty())

    def advance(self):
        """Hammer for one step."""
        self.time += DT
        self.gained = -0.0005
        for x, y in self.corrections:
            self.tilt = (self.tilt[0] + x, self.tilt[1] + y)
        for energy in self.strikes:
            if self.rock is not None and self.depth >= self.rock:
                self.depth += 0.0003
                self.on_rock += energy > 0.5
            else:
                step = energy * self.per_blow * (1.0 - 0.45 * self.depth) * self.rng.normal(1.0, 0.12)
                self.depth += 0.001 * max(0.0, step)
        for result in self.results:
            self.posts += 1
            self.next = self.time + 2.4
            if result == "driven":
                self.gained += 2.0
            elif self.rock is not None and self.on_rock:
                self.gained += 1.5
            else:
                self.failure = "post is loose"
            self.new_post()
        for calls in (self.corrections, self.strikes, self.results):
            calls.clear()
        if self.on_rock > 7:
            self.failure = "post splits on rock"
        elif self.time > 900.0:
            self.failure = "fence takes too long"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["post_driver.py", "refusal.py"],
    sensors=[
        Sensor("depth", topic="hammer/depth", field="data", low=0.0, high=0.8, bins=8, unit="m"),
    ],
    drifts={"clay": CLAY},
    episodes=200,
    min_success=0.97,
)
def test_drives(tarl, tarl_drift):
    """Drive four posts."""
    fence = Fence(tarl.rng("fence"), **(tarl_drift or LOAM))
    tarl.start("post_driver.py")
    tarl.bus.subscribe("hammer/strike", lambda message: fence.strikes.append(message.data))
    tarl.bus.subscribe("mast/correction", lambda message: fence.corrections.append((message.x, message.y)))
    tarl.bus.subscribe("driver/result", lambda message: fence.results.append(message.data))
    while not fence.done:
        fence.publish(tarl.bus)
        tarl.step(DT)
        fence.advance()
        tarl.reward(fence.gained)
    assert not fence.failure, fence.failure
