"""The pantograph of a test train presses on the wire. On the new fast line, the wind lifts it more."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
FluidPressure = message_type("sensor_msgs/FluidPressure")
TwistStamped = message_type("geometry_msgs/TwistStamped")

DT = 0.2
REGIONAL = 24.0  # m/s
LIFT = 0.022  # N per (m/s)²
BEST, WIDE = 92.0, 26.0  # N, best contact force and how far it may be off


class Train:
    """A train that runs between two stations with `cruise` in m/s."""

    def __init__(self, rng, cruise):
        self.rng = rng
        self.cruise = cruise + rng.uniform(-0.7, 0.7)
        self.lift = LIFT * rng.normal(1.0, 0.03)
        self.weight = rng.normal(55.0, 0.8)
        self.pressure, self.height, self.speed = 0.0, 0.0, 0.0  # Pa, m below the wire as negative
        self.height = -float(rng.uniform(0.5, 0.8))
        self.time, self.sway, self.hard, self.loose = 0.0, 0.0, 0, 0
        self.gained, self.failure = 0.0, ""

    @property
    def done(self):
        """Return whether the run is over, or the wire is damaged."""
        return bool(self.failure) or self.time > 46.0

    @property
    def push(self):
        """Return the force of the head upwards, in N."""
        return 0.0006 * self.pressure - self.weight + self.lift * self.speed**2

    def publish(self, bus):
        """Publish the bellows, the speed, the permit and whether the head touches the wire."""
        bus.publish(
            "bellows/pressure", FluidPressure(fluid_pressure=self.pressure + self.rng.normal(0.0, 600.0))
        )
        twist = TwistStamped()
        twist.twist.linear.x = self.speed + self.rng.normal(0.0, 0.1)
        bus.publish("train/velocity", twist)
        bus.publish("driver/permit", Bool(data=1.0 < self.time < 42.0))
        bus.publish("head/contact", Bool(data=self.height >= 0.0))

    def advance(self, valve, power):
        """Run for one step."""
        self.pressure = max(0.0, self.pressure + DT * 90000.0 * (valve.data if valve else 0.0))
        self.time += DT
        if self.time < 8.0 or self.time > 38.0:
            self.speed = max(0.0, self.speed - (DT * self.cruise / 5.0 if self.time > 38.0 else 0.0))
        else:
            self.speed = min(self.cruise, self.speed + DT * self.cruise / 7.0)
        self.sway += 0.4 * (self.rng.normal(0.0, 0.09 * self.speed**0.8) - self.sway)
        self.height = min(0.0, self.height + DT * (0.008 * self.push if self.push > -30.0 else -0.3))
        self.gained = 0.0
        if self.time < 16.0 or self.time > 40.0:
            return
        force = self.push + self.sway if self.height >= 0.0 else 0.0
        off = (force - BEST) / WIDE
        self.gained = 0.06 * max(-1.0, 1.0 - off**2) if power and power.data else -0.06
        self.hard += off > 1.0
        self.loose += off < -1.0
        if self.hard > 25:
            self.failure = f"wire is worn and lifted with {force:.0f} N"
        elif self.loose > 25:
            self.failure = f"arcs burn the strip at {force:.0f} N"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["pantograph.py"],
    sensors=[
        Sensor(
            "speed", topic="train/velocity", field="twist.linear.x", low=0.0, high=60.0, bins=6, unit="m/s"
        ),
        Sensor(
            "pressure",
            topic="bellows/pressure",
            field="fluid_pressure",
            low=0.0,
            high=250000.0,
            bins=5,
            unit="Pa",
        ),
    ],
    drifts={"fast line": Drift.range(46.0, 51.0)},
    episodes=200,
    min_success=0.97,
)
def test_presses_on_the_wire(tarl, tarl_drift):
    """Run from one station to the next."""
    train = Train(tarl.rng("train"), tarl_drift or REGIONAL)
    tarl.start("pantograph.py")
    while not train.done:
        train.publish(tarl.bus)
        tarl.step(DT)
        train.advance(tarl.bus.latest("bellows/valve"), tarl.bus.latest("pantograph/power"))
        tarl.reward(train.gained)
    assert not train.failure, train.failure
