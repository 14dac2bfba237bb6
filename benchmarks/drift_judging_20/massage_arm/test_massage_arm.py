"""An arm massages a back through an elastic head. The head got a softer spring, and it stays in."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
JointState = message_type("sensor_msgs/msg/JointState")

DT = 0.05
OLD_SPRING, SOFT_SPRING = 4200.0, 2400.0  # N/m
POINTS = 3


class Back:
    """A back that breathes, below a head with a spring of `stiffness` in N/m."""

    def __init__(self, rng, stiffness):
        self.rng = rng
        self.stiffness = stiffness * rng.normal(1.0, 0.01)
        self.goal = float(round(rng.uniform(20.0, 34.0)))
        self.skins = rng.uniform(0.03, 0.045, POINTS)
        self.tissues = rng.uniform(2500.0, 5500.0, POINTS)
        self.breath, self.start = rng.uniform(0.0007, 0.0014), rng.uniform(0.0, 6.0)
        self.travel, self.speed, self.time = 0.0, 0.0, 0.0
        self.point, self.pressed, self.forces = 0, False, []
        self.gained, self.failure = 0.0, ""

    @property
    def done(self):
        """Return whether all points are pressed, or the patient complains."""
        return bool(self.failure) or self.point >= POINTS

    @property
    def force(self):
        """Return the force on the skin: the tissue and the spring in series."""
        skin = self.skins[min(self.point, POINTS - 1)]
        skin += self.breath * math.sin(1.6 * self.time + self.start)
        tissue = self.tissues[min(self.point, POINTS - 1)]
        return max(0.0, self.travel - skin) * tissue * self.stiffness / (tissue + self.stiffness)

    def publish(self, bus):
        """Publish the carriage, the deflection of the spring and the therapist's force."""
        joint = JointState(name=["carriage"], position=[self.travel], velocity=[self.speed])
        bus.publish("carriage/joint", joint)
        bent = (self.force + 0.8) / self.stiffness
        bus.publish("head/deflection", Float64(data=bent + self.rng.normal(0.0, 0.00004)))
        if round(self.time / DT) % 20 == 0:
            bus.publish("session/force", Float64(data=self.goal))

    def advance(self, velocity, phase):
        """Move for one step, and feel."""
        self.speed += 0.5 * ((velocity.twist.linear.z if velocity else 0.0) - self.speed)
        self.travel = max(-0.01, self.travel + DT * self.speed)
        self.time += DT
        self.gained = -0.002
        force, now = self.force, phase.data if phase else "idle"
        if now == "press" and force > 0.5:
            self.forces.append(force)
        elif now == "lift" and self.forces:
            self.pressed = True
        if self.pressed and force == 0.0:
            self.judge()
        if force > 55.0:
            self.failure = f"{force:.0f} N hurt"
        elif self.time > 40.0:
            self.failure = "session takes too long"
        if self.failure:
            self.gained -= 4.0

    def judge(self):
        """Judge a point by the force in the last second and a half."""
        felt = sum(self.forces[-30:]) / len(self.forces[-30:])
        off = felt / self.goal - 1.0
        if off < -0.25:
            self.failure = f"patient hardly feels {felt:.1f} instead of {self.goal:.0f} N"
        elif off > 0.25:
            self.failure = f"{felt:.1f} instead of {self.goal:.0f} N leave a bruise"
        else:
            self.gained += 2.0 * (1.0 - (off / 0.25) ** 2)
        self.point += 1
        self.pressed, self.forces = False, []


@pytest.mark.tarl(
    nodes=["massage_arm.py", "elastic.py"],
    sensors=[
        Sensor("deflection", topic="head/deflection", field="data", low=0.0, high=0.016, bins=6, unit="m"),
        Sensor("goal", topic="session/force", field="data", low=18.0, high=36.0, bins=4, unit="N"),
    ],
    drifts={"soft spring": Drift(SOFT_SPRING, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_massages(tarl, tarl_drift):
    """Press three points of a back."""
    back = Back(tarl.rng("back"), tarl_drift or OLD_SPRING)
    tarl.start("massage_arm.py")
    while not back.done:
        back.publish(tarl.bus)
        tarl.step(DT)
        back.advance(tarl.bus.latest("carriage/velocity"), tarl.bus.latest("session/phase"))
        tarl.reward(back.gained)
    assert not back.failure, back.failure
