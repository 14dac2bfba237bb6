"""A drone sows clover from a constant height. Beans weigh more, and it sags."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Range = message_type("sensor_msgs/msg/Range")
Vector3 = message_type("geometry_msgs/msg/Vector3")

DT = 0.1
HEIGHT, BAND = 3.0, 0.5  # m
ROW = 54.0  # m
THRUST = 140.0  # N
TIME_BOUND = 40.0


class Field:
    """A drone of 6 kg with `load` kg of seeds above a field."""

    def __init__(self, rng, load):
        self.rng = rng
        self.load = load
        self.battery = rng.uniform(0.98, 1.02)
        self.bump = rng.uniform(0.0, 6.0)
        self.x, self.z, self.v, self.climb = 0.0, 0.2, 0.0, 0.0
        self.thrust, self.gust = 0.0, 0.0
        self.sows = False
        self.outside = 0.0
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the row is sown, or was given up."""
        return bool(self.failure) or self.x >= ROW

    def height(self):
        """Return the height above the ground, which is not quite flat."""
        return self.z - 0.05 * math.sin(0.25 * self.x + self.bump)

    def publish(self, bus):
        """Publish altimeter, velocity and the load cell of the hopper."""
        seen = Range(min_range=0.1, max_range=12.0)
        seen.range = max(0.1, self.height() + self.rng.normal(0.0, 0.02))
        bus.publish("altimeter", seen)
        bus.publish("fcu/velocity", Vector3(x=self.v, z=self.climb + self.rng.normal(0.0, 0.03)))
        bus.publish("hopper/weight", Float32(data=max(0.0, self.load + self.rng.normal(0.0, 0.03))))

    def advance(self, throttle, forward, gate):
        """Fly and sow for one step."""
        wanted = throttle.data * THRUST * self.battery if throttle else 0.0
        self.thrust += (wanted - self.thrust) * (1.0 - math.exp(-DT / 0.08))
        self.gust = 0.95 * self.gust + self.rng.normal(0.0, 0.15)
        mass = 6.0 + self.load
        self.climb += ((self.thrust + self.gust) / mass - 9.81 - 0.3 * self.climb) * DT
        self.z += self.climb * DT
        if self.z < 0.2:
            self.z, self.climb = 0.2, max(0.0, self.climb)
        self.v += ((forward.data if forward else 0.0) - self.v) * (1.0 - math.exp(-DT / 0.4))
        before = self.x
        self.x += self.v * DT
        self.sows = bool(gate and gate.data)
        self.load -= 0.02 * DT if self.sows else 0.0
        error = self.height() - HEIGHT
        self.outside = self.outside + DT if self.sows and abs(error) > BAND else 0.0
        self.time += DT
        self.gained = -0.003
        if self.sows:
            self.gained += 10.0 * (self.x - before) / ROW * (1.0 - min(1.5, (error / BAND) ** 2))

    def judge(self):
        """Return the reward of the step: the ground sown, weighted by how close the drone is to the right height."""
        if self.outside > 2.0:
            self.failure = f"seeds fall from {self.height():.1f} m"
        elif self.time > TIME_BOUND:
            self.failure = "the battery is empty before the row is done"
        return self.gained - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["seed_drone.py"],
    sensors=[
        Sensor("load", topic="hopper/weight", field="data", low=0.0, high=6.0, bins=6, unit="kg"),
        Sensor("height", topic="altimeter", field="range", low=0.0, high=4.0, bins=5, unit="m"),
        Sensor("state", topic="mission/state", field="data", categories=["TAKEOFF", "SOW", "HOVER"]),
    ],
    drifts={"beans": Drift.range(3.4, 5.2)},
    episodes=200,
    min_success=0.97,
)
def test_sows(tarl, tarl_drift):
    """Sow one row."""
    rng = tarl.rng("field")
    clover = rng.uniform(0.7, 1.3)
    field = Field(rng, clover if tarl_drift is None else tarl_drift)
    tarl.start("seed_drone.py")
    while not field.done:
        field.publish(tarl.bus)
        tarl.step(DT)
        field.advance(*(tarl.bus.latest(one) for one in ("fcu/throttle", "fcu/forward", "hopper/gate")))
        tarl.reward(field.judge())
    assert not field.failure, field.failure
