"""A stand turns engines for an inspector. A heavier engine has four times the inertia of the usual one.

Each pose in time earns, less for swinging past it; hoses that tear, or an inspector who waits too long, end the work.
"""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
JointState = message_type("sensor_msgs/msg/JointState")

DT = 0.1
PISTON = {"mass": 160.0, "inertia": 40.0}
TURBINE = {"mass": 420.0, "inertia": 160.0}  # kg, kg m2


class Hangar:
    """A stand with an engine of some `mass` and `inertia`."""

    def __init__(self, rng, mass, inertia):
        self.rng = rng
        self.mass = mass + rng.normal(0.0, 4.0)
        self.inertia = inertia * rng.normal(1.0, 0.03)
        self.heavy_side = float(rng.uniform(-1.0, 1.0))  # Nm
        self.friction = 5.0 * rng.normal(1.0, 0.1)  # Nm s/rad
        self.angle, self.speed = float(rng.uniform(-0.1, 0.1)), 0.0
        self.poses, at = [], self.angle
        for _ in range(4):
            at += float(rng.uniform(0.8, 1.2)) * (
                -1.0 if at > 0.4 or (at > -0.4 and rng.random() < 0.5) else 1.0
            )
            self.poses.append(at)
        self.count, self.asked, self.from_angle = 0, None, self.angle
        self.reached = False
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the inspection is over."""
        return bool(self.failure) or self.count >= len(self.poses)

    def publish(self, bus):
        """Publish the joint, the load every second, and the next pose."""
        step = round(self.time / DT)
        if step % 10 == 0:
            bus.publish("stand/load", Float32(data=self.mass + self.rng.normal(0.0, 3.0)))
            bus.publish("stand/enable", Bool(data=True))
        noise = self.rng.normal(0.0, 0.002, 2)
        bus.publish(
            "stand/joint",
            JointState(
                position=[float(self.angle + noise[0])], velocity=[float(self.speed + 2.0 * noise[1])]
            ),
        )
        if self.asked is None and step >= 5:
            self.asked, self.from_angle = self.time, self.angle
            bus.publish("inspector/pose", Float32(data=self.poses[self.count]))

    def advance(self, torque):
        """Turn for one step."""
        self.time += DT
        self.gained = -0.003
        wanted = torque.data if torque else 0.0
        for _ in range(4):
            moment = wanted - self.friction * self.speed + self.heavy_side * math.sin(self.angle)
            self.speed += 0.25 * DT * moment / self.inertia
            self.angle += 0.25 * DT * self.speed
        if self.asked is None:
            return
        pose = self.poses[self.count]
        past = (self.angle - pose) * (1.0 if pose > self.from_angle else -1.0)
        self.gained -= 0.5 * max(0.0, past - 0.035)
        if past > 0.12:
            self.failure = "hoses tear"
        elif self.time - self.asked > 4.5:
            self.failure = "inspector waits too long"
        elif self.reached and abs(self.angle - pose) < 0.06:
            self.gained += 2.0
            self.count += 1
            self.asked = None
        self.reached = False
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["engine_stand.py"],
    sensors=[
        Sensor("load", topic="stand/load", field="data", low=0.0, high=600.0, bins=6, unit="kg"),
        Sensor("angle", topic="stand/joint", field="position[0]", low=-2.4, high=2.4, bins=8, unit="rad"),
    ],
    drifts={"turbine": TURBINE},
    episodes=200,
    min_success=0.97,
)
def test_inspects(tarl, tarl_drift):
    """Turn one engine to four poses: 2 for each, a small cost per second and for overshoot, -4 for a failure."""
    hangar = Hangar(tarl.rng("hangar"), **(tarl_drift or PISTON))
    tarl.start("engine_stand.py")
    tarl.bus.subscribe("stand/reached", lambda message: setattr(hangar, "reached", message.data))
    while not hangar.done:
        hangar.publish(tarl.bus)
        tarl.step(DT)
        hangar.advance(tarl.bus.latest("stand/torque"))
        tarl.reward(hangar.gained)
    assert not hangar.failure, hangar.failure
