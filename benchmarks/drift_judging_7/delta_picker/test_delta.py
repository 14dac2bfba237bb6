"""Biscuits are picked near their middle. With a rubber sleeve on the encoder wheel, a tick stands for more belt."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float64 = message_type("std_msgs/msg/Float64")
Int32 = message_type("std_msgs/msg/Int32")

DT = 0.1
DISTANCE = 400.0
PARTS = 10
LEAD = 0.05
REACH = 14.0  # distance from the middle at which the suction cup still seals (mm)


class Conveyor:
    """A belt with biscuits, a camera, and a gripper further along."""

    def __init__(self, rng, per_tick):
        self.rng = rng
        self.per_tick = per_tick * (1.0 + rng.uniform(-0.005, 0.005))
        self.sleeve = per_tick > 0.9
        self.speed = rng.uniform(160.0, 240.0)  # mm/s
        self.place = 0.0
        spots, at = [], 60.0
        for _ in range(PARTS):
            spots.append(at)
            at += rng.uniform(110.0, 190.0)
        self.unseen, self.coming = list(spots), list(spots)
        self.failed = 0
        self.picked = 0

    @property
    def done(self):
        """Return whether all parts have been picked or passed."""
        return not self.coming

    def publish(self, bus):
        """Publish ticks, encoder wheel and newly seen parts."""
        bus.publish("belt/sleeve", Bool(data=self.sleeve))
        bus.publish("belt/ticks", Int32(data=int(self.place / self.per_tick)))
        while self.unseen and self.unseen[0] <= self.place:
            spot = self.unseen.pop(0)
            bus.publish("camera/part", Float64(data=spot - self.place + self.rng.normal(0.0, 1.0)))

    def advance(self, grip):
        """Move the belt, and close the gripper within this step if commanded."""
        reward = 0.0
        if grip is not None and self.coming:
            below = self.place - DISTANCE + self.speed * (grip + LEAD)
            near = min(self.coming, key=lambda spot: abs(spot - below))
            off = abs(near - below)
            if off < REACH:
                self.picked += 1
                self.coming.remove(near)
                reward += 1.0 - 0.3 * off / REACH
            else:
                reward -= 0.3
        self.place += self.speed * DT
        while self.coming and self.coming[0] + DISTANCE + 60.0 < self.place:
            self.coming.pop(0)
            self.failed += 1
            reward -= 0.2
        return reward


@pytest.mark.tarl(
    nodes=["delta_picker.py", "belt.py"],
    sensors=[
        Sensor("sleeve", topic="belt/sleeve", field="data"),
        Sensor("part", topic="camera/part", field="data", low=-25, high=5, bins=3, unit="mm"),
    ],
    drifts={"sleeve": 0.952},
    episodes=100,
    min_success=0.95,
)
def test_picks(tarl, tarl_drift):
    """Pick ten biscuits."""
    world = Conveyor(tarl.rng("belt"), tarl_drift or 0.82)
    tarl.start("delta_picker.py", parameters={"camera_to_robot": DISTANCE})
    last = None
    while not world.done:
        world.publish(tarl.bus)
        tarl.step(DT)
        grip = tarl.bus.latest("delta/grip_in")
        tarl.reward(world.advance(grip.data if grip is not None and grip is not last else None))
        last = grip
    assert world.failed <= 1, f"{world.failed} biscuits were missed"
