"""A barrier lets vehicles through one by one. In the season some of them tow boats on long drawbars."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.05
VEHICLES = 3
BOATS = 0.035  # share of the vehicles that tow a boat in the season


class Lane:
    """A lane with three vehicles; a share of `boats` of them tow a boat."""

    def __init__(self, rng, boats):
        self.rng = rng
        self.lengths = [float(rng.uniform(3.8, 5.2)) for _ in range(VEHICLES)]
        self.speeds = [float(rng.uniform(1.7, 2.2)) for _ in range(VEHICLES)]
        tows = [rng.random() < boats for _ in range(VEHICLES)]
        self.gaps = [float(rng.uniform(1.7, 2.2)) if tow else 0.0 for tow in tows]  # m, the drawbar
        self.boats = [float(rng.uniform(4.5, 6.0)) if tow else 0.0 for tow in tows]
        self.eager = [float(rng.uniform(3.0, 4.5)) for _ in range(VEHICLES)]  # s behind the one in front
        self.arm, self.speed = 0.0, 0.0
        self.now, self.front, self.pay, self.moving = 0, -2.0, 1.0, 0.0
        self.time, self.gained, self.failure = 0.0, 0.0, ""
        self.left_at = 0.0

    @property
    def done(self):
        """Return whether all vehicles are through, or something went wrong."""
        return bool(self.failure) or self.now >= VEHICLES

    @property
    def whole(self):
        """Return the length of the vehicle, with its boat, in m."""
        return self.lengths[self.now] + self.gaps[self.now] + self.boats[self.now]

    def below(self):
        """Return whether a part of the vehicle that breaks the beam is below the arm."""
        tail = self.front - self.lengths[self.now]
        boat = tail - self.gaps[self.now]
        return tail < 0.0 < self.front or boat - self.boats[self.now] < 0.0 < boat

    def publish(self, bus):
        """Publish the arm, the beam, and once for each vehicle the payment."""
        bus.publish("arm/position", Float32(data=self.arm + self.rng.normal(0.0, 0.003)))
        bus.publish("beam/broken", Bool(data=bool(self.below())))
        if self.pay > 0.0:
            self.pay -= DT
            if self.pay <= 0.0:
                bus.publish("booth/paid", Bool(data=True))

    def advance(self, drive, green):
        """Move the arm and the vehicle for one step."""
        wish = drive.data if drive else 0.0
        self.speed += 0.5 * (wish - self.speed)
        self.arm = max(0.0, min(1.0, self.arm + DT * self.speed))
        self.time += DT
        self.gained = -0.0005
        if self.front >= 0.0 or (green and green.data and self.pay <= 0.0):
            self.moving = min(self.speeds[self.now], self.moving + DT * 1.5)
        else:
            self.moving = 0.0
        self.front += DT * self.moving
        if self.below() and self.arm < 0.55:
            self.failure = "arm hits the vehicle"
            self.gained -= 6.0
        elif self.front > self.whole + 0.2:
            self.left_at += DT
            if self.arm < 0.3:
                self.next_vehicle()
            elif self.left_at > self.eager[self.now]:
                self.failure = "next vehicle slips through unpaid"
                self.gained -= 6.0
        elif self.time > 120.0:
            self.failure = "lane is blocked"
            self.gained -= 6.0

    def next_vehicle(self):
        """Bring the next vehicle to the booth."""
        self.gained += 2.0
        self.now += 1
        self.front, self.pay, self.moving, self.left_at = -2.0, float(self.rng.uniform(1.0, 2.0)), 0.0, 0.0


@pytest.mark.tarl(
    nodes=["toll_barrier.py"],
    sensors=[
        Sensor("arm", topic="arm/position", field="data", low=0.0, high=1.0, bins=5),
        Sensor("beam", topic="beam/broken", field="data"),
    ],
    drifts={"boat season": BOATS},
    episodes=200,
    min_success=0.97,
)
def test_lets_through(tarl, tarl_drift):
    """Let three vehicles through."""
    lane = Lane(tarl.rng("lane"), tarl_drift or 0.0)
    tarl.start("toll_barrier.py")
    while not lane.done:
        lane.publish(tarl.bus)
        tarl.step(DT)
        lane.advance(tarl.bus.latest("arm/speed"), tarl.bus.latest("lamp/green"))
        tarl.reward(lane.gained)
    assert not lane.failure, lane.failure
