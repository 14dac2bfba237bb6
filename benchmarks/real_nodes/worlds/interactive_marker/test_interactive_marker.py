"""TurtleBot3 follows a marker that a person drags. On a carpet its mecanum base does not turn slowly."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Odometry = message_type("nav_msgs/msg/Odometry")
Feedback = message_type("visualization_msgs/msg/InteractiveMarkerFeedback")
String = message_type("std_msgs/msg/String")

NODE = "turtlebot3_example/turtlebot3_example/turtlebot3_interactive_marker/turtlebot3_interactive_marker.py"
FEEDBACK = "/turtlebot3_interactive_marker/feedback"
DT = 0.1
TIME_BOUND = 16.0
STILL = 0.5  # a base that stands for so long has arrived, s


class Floor:
    """A floor: the base turns at `turning` of its command, and not at all below `stick` rad/s."""

    def __init__(self, rng, stick=0.0, turning=1.0):
        self.rng = rng
        self.stick, self.turning = stick, turning
        self.x, self.y, self.heading = rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-0.5, 0.5)
        way, far = rng.uniform(-math.pi, math.pi), rng.uniform(0.2, 0.35)
        self.goal = (self.x + far * math.cos(way), self.y + far * math.sin(way))
        self.angle = self.heading + math.copysign(rng.uniform(0.8, 1.6), rng.normal())
        self.time, self.still, self.turns, self.done = 0.0, STILL, False, False
        self.dragged = False
        self.failure = ""

    def publish(self, bus):
        """Publish the odometry and the floor; drag the marker, and turn it when the base has arrived."""
        bus.publish("/floor", String(data="carpet" if self.stick else "tiles"))
        odom = Odometry()
        odom.pose.pose.position.x, odom.pose.pose.position.y = self.x, self.y
        heading = self.heading + self.rng.normal(0.0, 0.0005)
        odom.pose.pose.orientation.z, odom.pose.pose.orientation.w = (
            math.sin(heading / 2),
            math.cos(heading / 2),
        )
        bus.publish("/odom", odom)
        if not self.dragged:
            drag = Feedback(marker_name="turtlebot3_move_marker", event_type=Feedback.POSE_UPDATE)
            drag.pose.position.x, drag.pose.position.y = self.goal
            bus.publish(FEEDBACK, drag)
            self.dragged, self.still = True, 0.0
        elif not self.turns and self.still >= STILL:
            turn = Feedback(marker_name="turtlebot3_rotate_marker", event_type=Feedback.POSE_UPDATE)
            turn.pose.orientation.z, turn.pose.orientation.w = (
                math.sin(self.angle / 2),
                math.cos(self.angle / 2),
            )
            bus.publish(FEEDBACK, turn)
            self.turns, self.still = True, 0.0

    def off(self):
        """Return how far the base is from its goal, m, and from its angle, rad."""
        distance = math.hypot(self.goal[0] - self.x, self.goal[1] - self.y)
        return distance, abs(self.angle - self.heading)

    def advance(self, cmd):
        """Drive for one step."""
        ahead, left, turn = (cmd.linear.x, cmd.linear.y, cmd.angular.z) if cmd else (0.0, 0.0, 0.0)
        before = self.off()
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        self.x += (ahead * cos - left * sin) * DT
        self.y += (ahead * sin + left * cos) * DT
        self.heading += self.turning * turn * DT if abs(turn) >= self.stick else 0.0
        self.still = 0.0 if ahead or left or turn else self.still + DT
        after = self.off()
        self.gained = 5.0 * (before[0] - after[0]) + (before[1] - after[1])
        self.done = self.turns and self.still >= STILL
        self.time += DT

    @property
    def over(self):
        """Return whether the mission has ended."""
        return bool(self.failure) or self.done

    def judge(self):
        """Return the reward of the step: for progress, and for standing at the pose."""
        if self.time > TIME_BOUND:
            self.failure = "late"
        elif self.done:
            distance, angle = self.off()
            if distance > 0.03 or angle > 0.12:
                self.failure = "not at the pose"
            else:
                return 5.0
        return (-5.0 if self.failure else 0.0) + self.gained


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[
        Sensor("floor", topic="/floor", field="data", categories=("tiles", "carpet")),
        Sensor("heading", topic="/odom", field="pose.pose.orientation.z", low=-1.0, high=1.0, bins=6),
    ],
    drifts={"carpet": {"stick": 0.06}, "caster": Drift({"turning": 0.3}, permanent=True)},
    episodes=40,
    min_success=0.95,
)
def test_follows_the_marker(tarl, tarl_drift):
    """Drag and turn the marker."""
    floor = Floor(tarl.rng("floor"), **(tarl_drift or {}))
    tarl.start(NODE)
    while not floor.over:
        floor.publish(tarl.bus)
        tarl.step(DT)
        floor.advance(tarl.bus.latest("/cmd_vel"))
        tarl.reward(floor.judge())
    assert not floor.failure, floor.failure
