"""A winding line on a bright floor, seen from above, and a small robot that should follow it.

Lengths in m, times in s, angles in rad, light in lux; the robot weighs 1 kg.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pymunk

from pytest_tarl.ros import message_type

if TYPE_CHECKING:
    import numpy as np

    from pytest_tarl.ros import Bus

Float32MultiArray = message_type("std_msgs/msg/Float32MultiArray")
Illuminance = message_type("sensor_msgs/msg/Illuminance")

BENDS = ((0.7, 0.0), (0.6, 1 / 0.35), (0.3, 0.0), (0.9, -1 / 0.3), (0.3, 0.0), (0.5, 1 / 0.3), (0.2, 0.0))
LENGTH = sum(length for length, _ in BENDS)
DAYLIGHT = (600.0, 800.0)
FULL_LIGHT = 700.0  # light in which the sensors read FLOOR on the bare floor
LAMP = 0.6  # a lamp lights the course up to this distance along it
FLOOR, LINE = 0.9, 0.1
LINE_WIDTH = 0.03  # width at which the sensors see the line
SENSORS = ((0.07, 0.02), (0.07, -0.02))  # left and right, measured from the middle of the axle
READING_NOISE = 0.01
LOST = 0.1  # at this distance from the line, the robot has lost it
TIME_BOUND = 10.0
DRIVE_LAG, SLIDE_LAG, TURN_LAG = 0.15, 0.03, 0.05
SUBSTEPS = 4


class World:
    """One run along the course. Beyond the lamp, the light is `dusk` times the daylight."""

    dt = 0.05

    def __init__(self, rng: np.random.Generator, dusk: float = 1.0) -> None:
        self.rng = rng
        self.daylight = rng.uniform(*DAYLIGHT)
        self.dusk = dusk
        self.time = 0.0
        self.failure = ""
        self.space = pymunk.Space()
        self.starts = _lay(self.space)
        self.body = pymunk.Body(mass=1.0, moment=0.01)
        self.body.position = 0.0, rng.uniform(-0.01, 0.01)
        self.body.angle = rng.uniform(-0.1, 0.1)
        self.space.add(self.body)
        self.along, self.off = self._locate()

    @property
    def finished(self) -> bool:
        """Return whether the robot is at the end of the line."""
        return self.along > LENGTH - 0.05

    @property
    def over(self) -> bool:
        """Return whether the run is over."""
        return self.finished or bool(self.failure)

    @property
    def light(self) -> float:
        """Return the light at the position of the robot."""
        return self.daylight * (1.0 if self.along < LAMP else self.dusk)

    def publish(self, bus: Bus) -> None:
        """Publish the readings of the sensors."""
        bus.publish("/light", Illuminance(illuminance=self.light))
        bus.publish("/reflectance", Float32MultiArray(data=[self._reading(place) for place in SENSORS]))

    def advance(self, bus: Bus) -> None:
        """Drive for one step: the wheels pull the robot towards the commanded speed and turn rate."""
        command = bus.latest("/cmd_vel")
        speed, turn = (command.linear.x, command.angular.z) if command else (0.0, 0.0)
        body = self.body
        for _ in range(SUBSTEPS):
            heading = body.rotation_vector
            drive = (speed - body.velocity.dot(heading)) / DRIVE_LAG
            slide = -body.velocity.dot(heading.perpendicular()) / SLIDE_LAG
            body.force = heading * drive + heading.perpendicular() * slide
            body.torque = body.moment * (turn - body.angular_velocity) / TURN_LAG
            self.space.step(self.dt / SUBSTEPS)
        self.time += self.dt

    def monitor(self) -> dict[str, float]:
        """Return the parts of the reward for the last step: progress, time, distance from the line, and the end."""
        before = self.along
        self.along, self.off = self._locate()
        if self.off > LOST:
            self.failure = "lost the line"
        elif self.time > TIME_BOUND:
            self.failure = "too slow"
        return {
            "progress": 5.0 * (self.along - before) / LENGTH,
            "time": -self.dt / TIME_BOUND,
            "centred": -0.02 * (self.off / 0.05) ** 2,
            "end": -10.0 if self.failure else 5.0 if self.finished else 0.0,
        }

    def _reading(self, place: tuple[float, float]) -> float:
        spot = self._nearest(self.body.local_to_world(place))
        darkness = math.exp(-((spot.distance / LINE_WIDTH) ** 2))
        brightness = self.light / FULL_LIGHT
        return brightness * (FLOOR - (FLOOR - LINE) * darkness) + self.rng.normal(0.0, READING_NOISE)

    def _locate(self) -> tuple[float, float]:
        """Return how far along the line the robot is, and how far from it."""
        spot = self._nearest(self.body.position)
        piece = spot.shape
        assert isinstance(piece, pymunk.Segment)
        return self.starts[piece] + piece.a.get_distance(spot.point), spot.distance

    def _nearest(self, place: pymunk.Vec2d) -> pymunk.PointQueryInfo:
        """Return the point of the line that is nearest to a place."""
        spot = self.space.point_query_nearest(place, math.inf, pymunk.ShapeFilter())
        assert spot is not None
        return spot


def _lay(space: pymunk.Space) -> dict[pymunk.Segment, float]:
    """Lay the line as short straight pieces; return how far along it each of them starts."""
    starts: dict[pymunk.Segment, float] = {}
    along, heading, end = 0.0, 0.0, pymunk.Vec2d(0.0, 0.0)
    for length, curvature in BENDS:
        pieces = round(length / 0.05)
        for _ in range(pieces):
            turn = curvature * length / pieces
            begin, end = end, end + pymunk.Vec2d(length / pieces, 0.0).rotated(heading + turn / 2)
            piece = pymunk.Segment(space.static_body, begin, end, 0.0)
            space.add(piece)
            starts[piece] = along
            heading, along = heading + turn, along + length / pieces
    return starts
