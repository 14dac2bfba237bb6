"""JSK's node holds the frame of a laser scan at a constant height. New shelves hang higher than the scan."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

TFMessage = message_type("tf2_msgs/TFMessage")
TransformStamped = message_type("geometry_msgs/TransformStamped")
Float64 = message_type("std_msgs/Float64")

PACKAGE = "jsk_robot_common/jsk_robot_startup"
NODE = f"{PACKAGE}/scripts/ConstantHeightFramePublisher.py"
LAUNCH = f"{PACKAGE}/launch/pointcloud_to_laserscan.launch"
FRAME = "pointcloud_to_scan_base"
DT = 0.2
SPEED = 0.8
SHELVES = 5
BAND = 0.5  # a scan covers so much above and below its frame, m


class Aisle:
    """An aisle with shelves whose lowest boards hang at `low` to `high` m."""

    def __init__(self, rng, low=0.65, high=1.35):
        self.rng = rng
        self.boards = [
            (2.0 + 2.5 * i + rng.uniform(0.0, 1.0), rng.uniform(low, high)) for i in range(SHELVES)
        ]
        self.x, self.time = 0.0, 0.0
        self.level = 0.9
        self.failure = ""

    def publish(self, bus):
        """Publish where the body is above the ground; it bobs while it walks."""
        self.level = 0.9 + 0.03 * math.sin(6.0 * self.time) + self.rng.normal(0.0, 0.002)
        body = TransformStamped()
        body.header.frame_id, body.child_frame_id = "odom", "BODY"
        body.transform.translation.x, body.transform.translation.z = self.x, self.level
        body.transform.rotation.w = 1.0
        bus.publish("/tf", TFMessage(transforms=[body]))
        bus.publish("/level", Float64(data=self.level))

    def advance(self, message):
        """Walk for one step; stop in front of a board that the scan shows, and walk around it."""
        frames = message.transforms if message else []
        frame = next((one.transform.translation.z for one in frames if one.child_frame_id == FRAME), None)
        before, self.x = self.x, self.x + SPEED * DT
        self.gained = self.x - before
        self.time += DT
        for place, height in self.boards:
            if before < place <= self.x and (frame is None or abs(height - self.level - frame) > BAND):
                self.failure = "hit a board"

    @property
    def over(self):
        """Return whether the mission has ended."""
        return bool(self.failure) or self.x > 3.0 + 2.5 * SHELVES

    def judge(self):
        """Return the reward of the step: for progress."""
        return (-5.0 if self.failure else 0.0) + 0.6 * self.gained


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[Sensor("level", topic="/level", field="data", low=0.8, high=1.0, bins=4, unit="m")],
    drifts={"shelves": Drift({"low": 1.3, "high": 1.9}, permanent=True)},
    episodes=40,
    min_success=0.95,
)
def test_sees_the_boards(tarl, tarl_drift):
    """Walk along the aisle."""
    aisle = Aisle(tarl.rng("aisle"), **(tarl_drift or {}))
    tarl.launch(LAUNCH, only=["pointcloud_to_laserscan_constant_height_frame"])
    while not aisle.over:
        aisle.publish(tarl.bus)
        tarl.step(DT)
        aisle.advance(tarl.bus.latest("/tf"))
        tarl.reward(aisle.judge())
    assert not aisle.failure, aisle.failure
