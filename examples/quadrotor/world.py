"""A quadrotor in a vertical plane: it takes off, passes two waypoints and lands.

Lengths in m, times in s, masses in kg, forces in N, angles in rad. The quadrotor weighs 1 kg as it was built.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import pymunk

from pytest_tarl.ros import message_type

if TYPE_CHECKING:
    import numpy as np

    from pytest_tarl.ros import Bus

Imu = message_type("sensor_msgs/msg/Imu")
PoseStamped = message_type("geometry_msgs/msg/PoseStamped")
TwistStamped = message_type("geometry_msgs/msg/TwistStamped")

GRAVITY = 9.81
ARM = 0.2  # lever arm of each rotor in m
DRAG = 0.25  # per m/s
MOMENT = 0.03
ROTOR_LAG = 0.03
ROUTE = ((0.0, 2.0), (3.0, 3.0), (6.0, 2.0), (6.0, 0.0))
CEILING, FLOOR = 3.8, 1.5  # limits of the altitude between take-off and landing
NEAR = 0.35
GUST = (3.6, 5.0)  # positions at which the gust blows
TIME_BOUND = 20.0
TAKE_OFF = 4.0  # time by which the take-off is over
SOFT = 0.6  # limit on the speed of a landing in m/s
NOISE = 0.01
SUBSTEPS = 4


class World:
    """One mission. `payload` is a load in kg, `gust` the force of the head wind between the waypoints."""

    dt = 0.04

    def __init__(self, rng: np.random.Generator, payload: float = 0.0, gust: float = 0.0) -> None:
        self.rng = rng
        self.gust = gust * rng.uniform(0.85, 1.15)
        self.time = 0.0
        self.leg = 0
        self.landed = False
        self.failure = ""
        self.space = pymunk.Space()
        self.space.gravity = 0.0, -GRAVITY
        self.body = pymunk.Body(1.0 + payload, MOMENT)
        self.body.position = rng.uniform(-0.05, 0.05), 0.0
        self.space.add(self.body)
        self.thrusts = [0.0, 0.0]
        self.wind = 0.0
        self.remaining = self._to_go()

    @property
    def over(self) -> bool:
        """Return whether the mission is over."""
        return self.landed or bool(self.failure)

    def publish(self, bus: Bus) -> None:
        """Publish the readings of the sensors: position, velocity, and those of the inertial unit."""
        body, noise = self.body, self.rng.normal(0.0, NOISE, 4)
        pose, speed, imu = PoseStamped(), TwistStamped(), Imu()
        pose.pose.position.x, pose.pose.position.z = body.position.x + noise[0], body.position.y + noise[1]
        speed.twist.linear.x, speed.twist.linear.z = body.velocity.x + noise[2], body.velocity.y + noise[3]
        imu.orientation.y, imu.orientation.w = math.sin(-body.angle / 2), math.cos(body.angle / 2)
        imu.angular_velocity.y = -body.angular_velocity
        bus.publish("/pose", pose)
        bus.publish("/velocity", speed)
        bus.publish("/imu", imu)

    def advance(self, bus: Bus) -> None:
        """Move for one step with the commanded thrusts, against gravity, drag and wind."""
        command = bus.latest("/rotors")
        wanted = command.data if command else (0.0, 0.0)
        body = self.body
        inside = GUST[0] <= body.position.x <= GUST[1]
        self.wind += 0.2 * (self.rng.normal(1.0, 0.15) * self.gust * inside - self.wind)
        for _ in range(SUBSTEPS):
            step = self.dt / SUBSTEPS
            for rotor, (place, pull) in enumerate(zip((-ARM, ARM), wanted, strict=True)):
                self.thrusts[rotor] += (pull - self.thrusts[rotor]) * step / ROTOR_LAG
                body.apply_force_at_local_point((0.0, self.thrusts[rotor]), (place, 0.0))
            body.apply_force_at_world_point((-DRAG * body.velocity.x - self.wind, 0.0), body.position)
            self._stand()
            self.space.step(step)
        self.time += self.dt

    def monitor(self) -> dict[str, float]:
        """Return the parts of the reward for the last step: progress, altitude, time, and the landing."""
        before, self.remaining = self.remaining, self._to_go()
        x, z = self.body.position
        flying = self.time > TAKE_OFF and self.leg < len(ROUTE) - 1
        return {
            "progress": before - self.remaining,
            "altitude": -0.02 * (flying and not FLOOR <= z <= CEILING),
            "time": -self.dt / TIME_BOUND,
            "landing": self._landing(x, z),
        }

    def _landing(self, x: float, z: float) -> float:
        if self.leg < len(ROUTE) - 1:
            if self.time > TIME_BOUND:
                self.failure = "too slow"
            elif abs(self.body.angle) > 1.2:
                self.failure = "turned over"
            return -10.0 if self.failure else 0.0
        if z > 0.02 and self.time <= TIME_BOUND:
            return 0.0
        speed = self.body.velocity.length
        if z > 0.02:
            self.failure = "too slow"
        elif speed > SOFT:
            self.failure = f"landed hard, at {speed:.1f} m/s"
        elif abs(x - ROUTE[-1][0]) > 1.0:
            self.failure = "landed beside the pad"
        self.landed = not self.failure
        return 5.0 if self.landed else -10.0

    def _to_go(self) -> float:
        """Return the length of the remaining route; a waypoint counts as passed once the quadrotor is near it."""
        here = self.body.position
        if self.leg < len(ROUTE) - 1 and here.get_distance(ROUTE[self.leg]) < NEAR:
            self.leg += 1
        ahead = (tuple(here), *ROUTE[self.leg :])
        return sum(math.dist(a, b) for a, b in pairwise(ahead))

    def _stand(self) -> None:
        """Hold the quadrotor on the ground until it lifts off."""
        body = self.body
        if body.position.y <= 0.0 and body.velocity.y < 0.0:
            body.velocity = body.velocity.x * 0.5, 0.0
            body.position = body.position.x, 0.0
            body.angle, body.angular_velocity = 0.0, 0.0
