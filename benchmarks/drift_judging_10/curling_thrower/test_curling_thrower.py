"""A machine throws one curling stone.

On humid days, frost on the ice slows the stone; only the place where it stops is judged.
"""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
String = message_type("std_msgs/String")

DT = 0.05
RAMP = 6.5  # m
TIME_BOUND = 45.0
CALLED = {"guard": -3.0, "draw": 0.0, "back": 1.2}
NEAR_ENOUGH = 2.2  # m


class Sheet:
    """A ramp, a carriage with a stone, and a sheet of ice."""

    def __init__(self, rng, frost):
        self.rng = rng
        self.friction = (0.0155 if frost else 0.0120) * rng.uniform(0.985, 1.015)
        self.dew_point = rng.uniform(1.0, 4.0) if frost else rng.uniform(-9.0, -4.0)
        self.house = rng.uniform(24.0, 28.0)
        self.call = ("guard", "draw", "back")[rng.integers(3)]
        self.carriage, self.speed = 0.0, 0.0
        self.stone = None  # place, speed
        self.time = 0.0
        self.failure = ""
        self.rests = False

    @property
    def done(self):
        """Return whether the stone rests or the throw failed."""
        return self.rests or bool(self.failure)

    def publish(self, bus):
        """Publish the carriage, the call and the air."""
        bus.publish("carriage/speed", Float32(data=self.speed + self.rng.normal(0.0, 0.004)))
        bus.publish("carriage/place", Float32(data=self.carriage))
        bus.publish("house/distance", Float32(data=self.house + self.rng.normal(0.0, 0.01)))
        bus.publish("skip/call", String(data=self.call))
        bus.publish("air/dew_point", Float32(data=self.dew_point + self.rng.normal(0.0, 0.1)))

    def advance(self, cmd, let_go):
        """Move carriage and stone for one step."""
        self.time += DT
        self.speed += 0.6 * ((cmd.linear.x if cmd else 0.0) - self.speed)
        self.carriage += self.speed * DT
        if self.stone is None:
            if let_go:
                self.stone = self.carriage, self.speed + self.rng.normal(0.0, 0.006)
            elif self.carriage > RAMP:
                self.failure = "the carriage hit the end of the ramp"
        else:
            place, speed = self.stone
            slower = speed - self.friction * 9.81 * DT
            self.stone = place + 0.5 * (speed + max(0.0, slower)) * DT, max(0.0, slower)
            self.rests = slower <= 0.0

    def judge(self):
        """Return the reward: nothing until the stone rests."""
        if self.rests:
            miss = abs(self.stone[0] - RAMP - self.house - CALLED[self.call])
            if miss > NEAR_ENOUGH:
                self.failure = f"the stone stopped {miss:.1f} m from the called place"
                return -5.0
            return 10.0 * (1.0 - 0.3 * (miss / NEAR_ENOUGH) ** 2)
        if self.time > TIME_BOUND and not self.failure:
            self.failure = "late"
        return -5.0 if self.failure else 0.0


@pytest.mark.tarl(
    nodes=["curling_thrower.py"],
    sensors=[
        Sensor("dew_point", topic="air/dew_point", field="data", low=-10.0, high=5.0, bins=5, unit="°C"),
        Sensor("speed", topic="carriage/speed", field="data", low=0.0, high=3.0, bins=6, unit="m/s"),
    ],
    drifts={"frost": Drift(True)},
    episodes=100,
    min_success=0.95,
)
def test_stops_at_the_called_place(tarl, tarl_drift):
    """Throw one stone."""
    sheet = Sheet(tarl.rng("sheet"), bool(tarl_drift))
    tarl.start("curling_thrower.py")
    while not sheet.done:
        sheet.publish(tarl.bus)
        tarl.step(DT)
        sheet.advance(tarl.bus.latest("carriage/cmd"), tarl.bus.latest("gripper/open"))
        tarl.reward(sheet.judge())
    assert not sheet.failure, sheet.failure
