"""A gantry waters the plants of a bed. A repair left it with a smaller pulley on its long axis."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Int32MultiArray = message_type("std_msgs/msg/Int32MultiArray")
PointStamped = message_type("geometry_msgs/msg/PointStamped")

DT = 0.1
PLANTS = 3
FLOW = 0.040  # l/s
REACH = 55.0  # distance from the stem at which the water still reaches the roots (mm)
TIME_BOUND = 60.0
USUAL, SPARE = 20, 16  # teeth


class Bed:
    """A raised bed and a gantry whose x pulley has `teeth` teeth; lengths are in mm."""

    def __init__(self, rng, teeth):
        self.rng = rng
        self.per_step = (teeth * 2.0 / 3200.0 * rng.uniform(0.998, 1.002), 20 * 2.0 / 3200.0)
        self.plants = [(rng.uniform(450.0, 2200.0), rng.uniform(150.0, 1250.0)) for _ in range(PLANTS)]
        self.doses = [rng.uniform(0.08, 0.13) for _ in range(PLANTS)]
        self.lag = rng.uniform(0.10, 0.16)
        self.steps = [0.0, 0.0]
        self.current, self.got, self.poured = 0, 0.0, 0.0
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all plants were watered, or one was not."""
        return bool(self.failure) or self.current >= PLANTS

    def publish(self, bus):
        """Publish the next plant, the steps of the motors and a sensor in the soil."""
        plant = PointStamped()
        plant.point.x, plant.point.y = (0.001 * one for one in self.plants[self.current])
        plant.point.z = self.doses[self.current]
        bus.publish("bed/plant", plant)
        bus.publish("motors/steps", Int32MultiArray(data=[round(one) for one in self.steps]))
        bus.publish("soil/moisture", Float32(data=0.3 + self.rng.normal(0.0, 0.02)))

    def advance(self, goal, valve):
        """Move the motors for one step and let water flow."""
        if goal is not None:
            for axis, wanted in enumerate(goal.data):
                self.steps[axis] += (wanted - self.steps[axis]) * (1.0 - math.exp(-DT / self.lag))
        self.time += DT
        self.gained = -0.002
        open_now = valve is not None and valve.data
        if open_now:
            self._water()
        elif self.poured > 0.5 * self.doses[self.current]:
            self._next()

    def _water(self):
        x, y = (count * scale for count, scale in zip(self.steps, self.per_step, strict=True))
        plant = self.plants[self.current]
        off = math.hypot(x + self.rng.normal(0.0, 2.0) - plant[0], y + self.rng.normal(0.0, 2.0) - plant[1])
        water = FLOW * DT
        self.poured += water
        if off < REACH:
            self.got += water
            self.gained += 3.4 * water / self.doses[self.current] * (1.0 - 0.3 * (off / REACH) ** 2)
        else:
            self.gained -= 0.2 * water / self.doses[self.current]

    def _next(self):
        if self.got < 0.8 * self.doses[self.current]:
            self.failure = f"plant {self.current + 1} stays dry"
        self.current += 1
        self.got, self.poured = 0.0, 0.0

    def judge(self):
        """Return the reward of the step: water at the roots."""
        if self.time > TIME_BOUND:
            self.failure = "the tour takes too long"
        return self.gained - (3.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["farm_gantry.py", "axis.py"],
    sensors=[
        Sensor("x", topic="bed/plant", field="point.x", low=0.0, high=2.4, bins=5, unit="m"),
        Sensor("y", topic="bed/plant", field="point.y", low=0.0, high=1.4, bins=4, unit="m"),
        Sensor(
            "state", topic="gantry/state", field="data", categories=["idle", "moving", "settling", "watering"]
        ),
    ],
    drifts={"spare pulley": Drift(SPARE, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_waters(tarl, tarl_drift):
    """Water one bed."""
    bed = Bed(tarl.rng("bed"), tarl_drift or USUAL)
    tarl.start("farm_gantry.py")
    while not bed.done:
        bed.publish(tarl.bus)
        tarl.step(DT)
        bed.advance(tarl.bus.latest("motors/goal"), tarl.bus.latest("valve"))
        tarl.reward(bed.judge())
    assert not bed.failure, bed.failure
