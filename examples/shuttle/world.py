"""A straight track seen from above: a robot, two goals and, in some missions, a patch of soft ground.

Lengths in m, times in s, masses in kg, wheel velocities in rad/s.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pymunk

from pytest_tarl.ros import message_type

if TYPE_CHECKING:
    import numpy as np

    from pytest_tarl.ros import Bus

Odometry = message_type("nav_msgs/Odometry")
Bool = message_type("std_msgs/Bool")
UInt8 = message_type("std_msgs/UInt8")

G1, G2 = 1.0, 11.0
PATCH = (5.0, 7.0)
PATCH_SHARE = 0.6  # share of the missions that cross the patch
WHEEL_RADIUS = 0.08
TOP_SPEED = 55.0  # limit of the wheels in rad/s
TRACTION = 80.0  # N of push per m/s between wheel and ground
ROLLING = 0.015  # rolling resistance, N per kg
ODOMETRY_NOISE = 0.01
TIME_BOUND = 13.5  # time from goal to goal ...
TURNROUND = 2.0  # ... and time for turning round at a goal
PRECISION = 0.2  # a delivery needs the robot this close to the goal ...
HANDOVER = 10  # ... for this many steps
SUBSTEPS = 5


class World:
    """One mission: visit `goals` in turn, starting at G1.

    On the patch, the robot reaches the share `mud` of the commanded speed. With 1, the patch is there and the terrain
    sensor sees it, but the patch has no effect.
    """

    dt = 0.1

    def __init__(self, rng: np.random.Generator, mud: float = 1.0, goals: tuple[float, ...] = (G2,)) -> None:
        self.rng = rng
        self.goals = goals
        self.leg = 0
        self.failure = ""
        self.drag = TRACTION * (1 / mud - 1)
        self.patch = rng.random() < PATCH_SHARE
        self.space = pymunk.Space()
        self.body = pymunk.Body(mass=rng.uniform(40.0, 50.0), moment=10.0)
        self.body.position = rng.uniform(G1 - 0.1, G1 + 0.1), 0.0
        friction = pymunk.PivotJoint(self.space.static_body, self.body, self.body.position)
        friction.max_bias, friction.max_force = 0.0, ROLLING * self.body.mass
        self.space.add(self.body, friction)
        self.left = TIME_BOUND
        self.standing = 0
        self.way = self.remaining = self._to_goal()

    @property
    def delivered(self) -> bool:
        """Return whether the robot reached every goal in time and precisely."""
        return self.leg == len(self.goals)

    @property
    def over(self) -> bool:
        """Return whether the mission is over."""
        return self.delivered or bool(self.failure)

    @property
    def on_patch(self) -> bool:
        """Return whether the robot stands on the patch."""
        return self.patch and PATCH[0] <= self.body.position.x <= PATCH[1]

    def publish(self, bus: Bus) -> None:
        """Publish the readings of the sensors."""
        bus.publish("/leg", UInt8(data=self.leg + 1))
        bus.publish("/terrain", Bool(data=self.on_patch))
        odometry = Odometry()
        odometry.pose.pose.position.x = self.body.position.x + self.rng.normal(0.0, ODOMETRY_NOISE)
        bus.publish("/odom", odometry)

    def advance(self, bus: Bus) -> None:
        """Move for one step: the motor follows the commanded speed with a lag, and mud slows the robot down."""
        command = bus.latest("/wheel_velocity")
        wheels = max(-TOP_SPEED, min(TOP_SPEED, command.data)) if command else 0.0
        for _ in range(SUBSTEPS):
            speed = self.body.velocity.x
            push = TRACTION * (WHEEL_RADIUS * wheels - speed)
            self.body.force = push - self.drag * speed * self.on_patch, 0.0
            self.space.step(self.dt / SUBSTEPS)
        self.left -= self.dt

    def monitor(self) -> float:
        """Return the reward of the last step. Reaching a goal in time and precisely earns 10, half of it on the way.

        Time costs 1 per time bound. Missing a goal costs 10 and ends the mission.
        """
        before, self.remaining = self.remaining, self._to_goal()
        reward = 5.0 * (abs(before) - abs(self.remaining)) / abs(self.way) - self.dt / TIME_BOUND
        self.standing = self.standing + 1 if abs(self.remaining) <= PRECISION else 0
        if self.standing == HANDOVER:
            reward += 5.0
            self._arrive()
        elif self._missed():
            reward -= 10.0
        return reward

    def _missed(self) -> bool:
        if self.remaining * self.way < 0 and abs(self.remaining) > PRECISION:
            self.failure = "ran past the goal"
        elif self.left < 0.0:
            self.failure = "late"
        return bool(self.failure)

    def _arrive(self) -> None:
        self.leg += 1
        if not self.delivered:
            self.left = TURNROUND + TIME_BOUND
            self.standing = 0
            self.way = self.remaining = self._to_goal()

    def _to_goal(self) -> float:
        """Return the distance to the next goal; negative if the robot has passed the goal."""
        return self.goals[self.leg] - self.body.position.x
