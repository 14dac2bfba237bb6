"""A scrubber cleans a hall and fetches fresh packs. The packs are old, and no longer hold what they did."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

BatteryState = message_type("sensor_msgs/BatteryState")
Point = message_type("geometry_msgs/Point")

DT = 2.0
CELL = 1.0  # length of lane per cell (m)
LANES, LENGTH = 8, 24
TIME_BOUND = 800.0
YOUNG, OLD = 3.0, 1.95  # Ah


class Hall:
    """A hall of eight lanes, a dock in its corner, and packs of `capacity` Ah."""

    def __init__(self, rng, capacity):
        self.rng = rng
        self.capacity = capacity
        self.pack = capacity * rng.uniform(0.98, 1.04)
        self.dirt = rng.uniform(0.95, 1.05)
        self.x, self.y = 0.6, 0.3
        self.used, self.swap = 0.0, 0.0
        self.fresh = False
        self.current = 3.0
        self.clean = set()
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the hall is clean and the scrubber at its dock, or it will not be."""
        return bool(self.failure) or (len(self.clean) >= 0.95 * LANES * LENGTH and self.at_dock)

    @property
    def at_dock(self):
        """Return whether the dock can reach the pack."""
        return math.hypot(self.x, self.y) < 0.6

    def publish(self, bus):
        """Publish the position and the battery."""
        bus.publish(
            "odom", Point(x=self.x + self.rng.normal(0.0, 0.02), y=self.y + self.rng.normal(0.0, 0.02))
        )
        state = BatteryState()
        state.current = -self.current + self.rng.normal(0.0, 0.3)
        state.voltage = 19.6 - 0.4 * self.used / self.capacity + self.rng.normal(0.0, 0.1)
        state.power_supply_status = 4 if self.fresh else 2
        bus.publish("battery", state)

    def advance(self, velocity, brush):
        """Drive, scrub and use charge for one step."""
        vx, vy = (velocity.x, velocity.y) if velocity else (0.0, 0.0)
        scrubs = bool(brush and brush.data)
        self.x += (vx + self.rng.normal(0.0, 0.005)) * DT
        self.y += (vy + self.rng.normal(0.0, 0.005)) * DT
        moving = math.hypot(vx, vy)
        self.current = 2.0 + (11.0 * moving / 0.8 if not scrubs else 33.0 * self.dirt)
        self.used += self.current * DT / 3600.0
        self.time += DT
        self.gained = -0.0006 * DT
        self._change_pack(moving)
        if scrubs:
            self._scrub()
        if self.used > self.pack:
            self.failure = f"the pack is empty {math.hypot(self.x, self.y):.0f} m from the dock"

    def _change_pack(self, moving):
        self.swap = self.swap + DT if self.at_dock and moving < 0.01 else 0.0
        self.fresh = self.swap > 30.0
        if self.fresh:
            self.used, self.swap = 0.0, 0.0
            self.pack = self.capacity * self.rng.uniform(0.98, 1.04)

    def _scrub(self):
        lane = int(self.y / 1.5)
        for back in (0.0, 0.5):  # one step covers one cell
            place = (lane, int((self.x - 1.0 - back) / CELL))
            if 0 <= place[0] < LANES and 0 <= place[1] < LENGTH and place not in self.clean:
                self.clean.add(place)
                self.gained += 10.0 / (LANES * LENGTH)

    def judge(self):
        """Return the reward of the step: floor that becomes clean."""
        if self.time > TIME_BOUND:
            self.failure = "the market opens before the floor is clean"
        return self.gained - (6.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["floor_scrubber.py"],
    sensors=[
        Sensor("along", topic="odom", field="x", low=0.0, high=26.0, bins=4, unit="m"),
        Sensor("across", topic="odom", field="y", low=0.0, high=12.0, bins=4, unit="m"),
        Sensor("state", topic="scrubber/state", field="data", categories=["SCRUB", "HOME", "SWAP", "RETURN"]),
    ],
    drifts={"old packs": Drift(OLD, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_cleans(tarl, tarl_drift):
    """Clean the hall once."""
    hall = Hall(tarl.rng("hall"), tarl_drift or YOUNG)
    tarl.start("floor_scrubber.py")
    while not hall.done:
        hall.publish(tarl.bus)
        tarl.step(DT)
        hall.advance(tarl.bus.latest("base/velocity"), tarl.bus.latest("brush"))
        tarl.reward(hall.judge())
    assert not hall.failure, hall.failure
