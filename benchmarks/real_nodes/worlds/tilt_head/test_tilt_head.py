"""Fetch's tilt_head.py looks a metre beyond the end of the local plan. A new planner makes shorter plans."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Path = message_type("nav_msgs/Path")
PoseStamped = message_type("geometry_msgs/PoseStamped")
TFMessage = message_type("tf2_msgs/TFMessage")
TransformStamped = message_type("geometry_msgs/TransformStamped")
GoalStatusArray = message_type("actionlib_msgs/GoalStatusArray")
GoalStatus = message_type("actionlib_msgs/GoalStatus")

NODE = "fetch_navigation/scripts/tilt_head.py"
DT = 0.25
SPEED = 0.4
LENGTH = 10.0
SEEN = 0.35  # m: half of what the camera sees of the floor
BRAKING = 1.7  # m: distance at which an obstacle must be known


class Corridor:
    """Boxes on the floor of a straight corridor; the base stops for those that the head has seen in time."""

    def __init__(self, rng, horizon=1.2):
        self.rng = rng
        self.horizon = horizon
        self.x, self.time = 0.0, 0.0
        self.looked = None
        first = rng.uniform(3.4, 4.0)
        self.boxes = [first, first + rng.uniform(1.6, 2.2), first + rng.uniform(3.6, 4.6)]
        self.known = set()
        self.gained = 0.0
        self.failure = ""

    @property
    def over(self):
        """Return whether the mission has ended."""
        return bool(self.failure) or self.x > LENGTH

    def publish(self, bus):
        """Publish the pose of the base, the state of its goal, and the local plan."""
        moved = TransformStamped()
        moved.header.frame_id, moved.child_frame_id = "odom", "base_link"
        moved.transform.translation.x = self.x
        moved.transform.rotation.w = 1.0
        bus.publish("/tf", TFMessage(transforms=[moved]))
        bus.publish("/move_base/status", GoalStatusArray(status_list=[GoalStatus(status=GoalStatus.ACTIVE)]))
        end = PoseStamped()
        end.header.frame_id = "odom"
        end.pose.position.x = self.x + self.horizon + self.rng.normal(0.0, 0.02)
        end.pose.orientation.w = 1.0
        bus.publish("/move_base/TrajectoryPlannerROS/local_plan", Path(poses=[end]))

    def advance(self, looks):
        """Drive for one step; a new look shows the boxes around the point."""
        before = self.x
        self.x += SPEED * DT
        if looks is not None and looks is not self.looked:
            self.looked = looks
            if looks.z < 0.5:
                self.known |= {box for box in self.boxes if abs(box - self.x - looks.x) < SEEN}
        for box in self.boxes:
            if box not in self.known and 0.0 < box - self.x < BRAKING:
                self.failure = "a box came too late"
        self.gained = self.x - before
        self.time += DT

    def judge(self):
        """Return the reward of the step: for the way."""
        return -5.0 if self.failure else self.gained


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[
        Sensor(
            "plan",
            topic="/move_base/TrajectoryPlannerROS/local_plan",
            field="poses[-1].pose.position.x",
            low=0.0,
            high=12.0,
            bins=4,
            unit="m",
        ),
    ],
    drifts={"new planner": Drift({"horizon": 0.4}, permanent=True)},
    episodes=30,
    min_success=0.95,
)
def test_sees_the_boxes(tarl, tarl_drift):
    """Drive along the corridor."""
    corridor = Corridor(tarl.rng("corridor"), **(tarl_drift or {}))
    tarl.start("head.py")
    tarl.start(NODE)
    while not corridor.over:
        corridor.publish(tarl.bus)
        tarl.step(DT)
        corridor.advance(tarl.bus.latest("/looks"))
        tarl.reward(corridor.judge())
    assert not corridor.failure, corridor.failure
