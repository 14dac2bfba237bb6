"""A harvester follows its track. In frost its oil is thick, the wheels turn slowly, and it weaves into ditches.

Each step earns, less beside the track, and a harvester in the ditch is a loss.
"""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Pose = message_type("geometry_msgs/Pose")
Pose2D = message_type("geometry_msgs/Pose2D")
PoseArray = message_type("geometry_msgs/PoseArray")

DT = 0.2
WARM = {"lag": 0.3}
FROSTY = {"lag": 3.5}  # s
DITCH = 1.4  # m beside the track


class Field:
    """A field with a slightly bent track, and a harvester whose wheels turn with some `lag`."""

    def __init__(self, rng, lag):
        self.rng = rng
        self.lag = lag * rng.normal(1.0, 0.04)
        bend = float(rng.uniform(-0.25, 0.25))
        self.track = [(-4.0, 0.0), (10.0, 0.0)]
        for number in range(1, 6):
            x, y = self.track[-1]
            self.track.append(
                (x + 7.0 * math.cos(bend * number / 5.0), y + 7.0 * math.sin(bend * number / 5.0))
            )
        self.x, self.y = 0.0, float(rng.uniform(-0.5, 0.5))
        self.heading = float(rng.uniform(-0.08, 0.08))
        self.speed, self.wheels = 0.0, 0.0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the track is over."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the pose, and at first the track."""
        noise = self.rng.normal(0.0, 0.02, 2)
        theta = self.heading + self.rng.normal(0.0, 0.004)
        bus.publish("gps/pose", Pose2D(x=self.x + noise[0], y=self.y + noise[1], theta=theta))
        if self.time < 2 * DT:
            track = PoseArray(poses=[Pose() for _ in self.track])
            for pose, (x, y) in zip(track.poses, self.track, strict=True):
                pose.position.x, pose.position.y = x, y
            bus.publish("field/track", track)
            bus.publish("hopper/full", Bool(data=False))

    def beside(self):
        """Return how far in m the harvester is beside the track."""
        found = []
        for (ax, ay), (bx, by) in zip(self.track, self.track[1:], strict=False):
            length = math.hypot(bx - ax, by - ay)
            along = max(0.0, min(1.0, ((self.x - ax) * (bx - ax) + (self.y - ay) * (by - ay)) / length**2))
            found.append(math.hypot(self.x - ax - along * (bx - ax), self.y - ay - along * (by - ay)))
        return min(found)

    def advance(self, command, angle, done):
        """Drive for one step."""
        self.time += DT
        self.speed += 0.2 * ((command.linear.x if command else 0.0) - self.speed)
        rate = ((angle.data if angle else 0.0) - self.wheels) / self.lag
        self.wheels += DT * max(-0.9, min(0.9, rate))
        self.heading += DT * self.speed * math.tan(self.wheels) / 2.1
        self.x += DT * self.speed * math.cos(self.heading)
        self.y += DT * self.speed * math.sin(self.heading)
        off = self.beside()
        self.gained = 0.08 - 0.05 * max(0.0, off - 0.2)
        if done and done.data:
            self.over = True
        elif off > DITCH:
            self.failure = "harvester is in the ditch"
        elif self.time > 60.0:
            self.failure = "harvester stands"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["peat_harvester.py"],
    sensors=[
        Sensor("x", topic="gps/pose", field="x", low=0.0, high=46.0, bins=8, unit="m"),
        Sensor("heading", topic="gps/pose", field="theta", low=-1.0, high=1.0, bins=6, unit="rad"),
    ],
    drifts={"frosty": FROSTY},
    episodes=200,
    min_success=0.97,
)
def test_harvests(tarl, tarl_drift):
    """Follow one track: up to 0.08 for each step, -4 for a ditch."""
    field = Field(tarl.rng("field"), **(tarl_drift or WARM))
    tarl.start("peat_harvester.py", launch="harvester.launch")
    bus = tarl.bus
    while not field.done:
        field.publish(bus)
        tarl.step(DT)
        field.advance(bus.latest("drive/cmd"), bus.latest("steering/angle"), bus.latest("harvester/done"))
        tarl.reward(field.gained)
    assert not field.failure, field.failure
